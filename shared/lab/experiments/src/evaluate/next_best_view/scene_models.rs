//! Models of a scene as a source of stored models.

use super::bin_scene::{BinObject, BinScene};
use mesh::TriangleMesh;
use scene_client::StoredModels;
use sensor_noise::DepthNoise;
use service::Failure;

/// Models of the objects of a scene, which a Kinect sees.
pub(super) struct SceneModels<'a>(pub(super) &'a BinScene);

impl BinScene {
    /// Objects that are the first ones of their models.
    pub(super) fn models(&self) -> impl Iterator<Item = &BinObject> {
        let objects = self.objects.iter().enumerate();
        let is_first = |(index, object): &(usize, &BinObject)| {
            !self.objects[..*index]
                .iter()
                .any(|other| other.name == object.name)
        };
        objects.filter(is_first).map(|(_, object)| object)
    }
}

impl StoredModels for SceneModels<'_> {
    fn depth_noise(&mut self) -> Option<DepthNoise> {
        Some(DepthNoise::KINECT_V1)
    }

    fn versions(&mut self) -> Result<Vec<(String, u64)>, Failure> {
        Ok(self
            .0
            .models()
            .map(|object| (object.name.clone(), 1))
            .collect())
    }

    fn mesh(&mut self, name: &str) -> Result<TriangleMesh, String> {
        let model = self.0.models().find(|object| object.name == name);
        let model = model.ok_or_else(|| format!("the scene has no model {name:?}"))?;
        Ok(TriangleMesh::clone(&model.mesh))
    }
}
