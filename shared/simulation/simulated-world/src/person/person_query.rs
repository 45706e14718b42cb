//! Queries of the simulated person about the world.

use crate::model_choice::ModelChoice;
use nalgebra::Point3;

/// World queries of the simulated person.
pub(crate) trait PersonQuery {
    /// Middle of an object's top and height of its underside, world frame, metres; `None` for an
    /// unknown, held or fallen object.
    fn object(&self, object: u16) -> Option<(Point3<f64>, f64)>;
    /// Numbers of the objects that are at rest on the table.
    fn free_objects(&self) -> Vec<u16>;
    /// Height of an object of a model that is not in the scene yet, metres.
    fn height_of(&self, model: &ModelChoice) -> Option<f64>;
    /// Height of the table top, metres.
    fn table_height_m(&self) -> f64;
    /// Position of the camera, world frame, metres.
    fn camera(&self) -> Point3<f64>;
    /// Random free position for an existing object, or for a new one.
    fn free_position(&self, object: Option<u16>, draw: u64) -> Option<[f64; 2]>;
    /// Random model of an object that could be brought.
    fn random_model(&self, draw: u64) -> Option<ModelChoice>;
}
