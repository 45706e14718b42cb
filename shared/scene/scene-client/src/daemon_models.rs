//! Stored models of a running daemon: those of its memory, with the depth noise of its camera.

use crate::depth_noise::camera_depth_noise;
use crate::stored_models::StoredModels;
use control_client::{MemoryClient, connect_if_running};
use control_protocol::{DocumentKind, DocumentName};
use mesh::{Triangle, TriangleMesh};
use object_model::ObjectModel;
use sensor_noise::DepthNoise;
use service::{CommonArguments, Failure};

/// Models in the memory of a daemon.
pub struct DaemonModels<'a> {
    common: &'a CommonArguments,
    memory: MemoryClient,
}

impl<'a> DaemonModels<'a> {
    /// Connects to the memory.
    ///
    /// # Errors
    /// If it does not run or does not answer.
    pub fn connect(common: &'a CommonArguments) -> Result<Self, Failure> {
        let client = connect_if_running(common)?;
        let client = client.ok_or_else(|| Failure::general("the memory does not run"))?;
        let memory = MemoryClient::of_daemon(common, client);
        Ok(Self { common, memory })
    }
}

impl StoredModels for DaemonModels<'_> {
    fn depth_noise(&mut self) -> Option<DepthNoise> {
        camera_depth_noise(self.common).ok()
    }

    fn versions(&mut self) -> Result<Vec<(String, u64)>, Failure> {
        let stored = self.memory.documents(DocumentKind::ObjectModel)?;
        let version =
            |report: control_protocol::DocumentReport| (report.document.name, report.sequence);
        Ok(stored.into_iter().map(version).collect())
    }

    fn mesh(&mut self, name: &str) -> Result<TriangleMesh, String> {
        let document = DocumentName {
            kind: DocumentKind::ObjectModel,
            name: name.to_owned(),
        };
        let stored = self.memory.document(&document);
        let stored = stored.map_err(|error| error.to_string())?;
        let model = ObjectModel::from_bytes(&stored.content).map_err(|error| error.to_string())?;
        let triangle = |vertices: &[u32; 3]| Triangle {
            vertices: *vertices,
            surface: 0,
        };
        Ok(TriangleMesh {
            triangles: model.mesh.triangles.iter().map(triangle).collect(),
            vertices: model.mesh.vertices,
            surfaces: Vec::new(),
        })
    }
}
