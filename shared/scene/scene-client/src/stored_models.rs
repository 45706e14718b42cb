//! Source of stored models: the memory of a daemon, a folder, or a simulation.

use mesh::TriangleMesh;
use sensor_noise::DepthNoise;
use service::Failure;

/// Models that objects of a snapshot may show, by the names of their categories.
pub trait StoredModels {
    /// Depth noise of the camera; `None` while it is not known.
    fn depth_noise(&mut self) -> Option<DepthNoise>;

    /// Names of all models with their versions. A model of another version is read anew.
    ///
    /// # Errors
    /// If the source does not answer.
    fn versions(&mut self) -> Result<Vec<(String, u64)>, Failure>;

    /// Surface of a model, metres; points alone where it has no triangles.
    ///
    /// # Errors
    /// The reason why it cannot be used.
    fn mesh(&mut self, name: &str) -> Result<TriangleMesh, String>;
}
