//! World queries of the simulated person.

use super::World;
use crate::arrangement;
use crate::model_choice::ModelChoice;
use crate::random_stream::random_stream;
use crate::scene_object::ObjectState;
use nalgebra::Point3;

/// Free space that a person leaves around an object, metres. Chosen.
const GAP_M: f64 = 0.05;
/// Assumed footprint radius of an object that is not in the scene yet, metres. Chosen.
const UNSEEN_RADIUS_M: f64 = 0.11;
/// Random stream of free positions.
const STREAM_FREE_SPOT: u64 = 4;

impl World {
    /// Middle of an object's top and height of its underside, world frame, metres; `None` for an
    /// unknown, held or fallen object.
    pub(crate) fn object_to_grasp(&self, object: u16) -> Option<(Point3<f64>, f64)> {
        let object = self.find(object)?;
        let is_free = !object.is_held() && object.state != ObjectState::OnFloor;
        is_free.then(|| (object.top(), object.height_range_m().0))
    }

    /// Numbers of the objects that are at rest on the table.
    pub(crate) fn free_objects(&self) -> Vec<u16> {
        let at_rest = self.objects.iter();
        at_rest
            .filter(|object| object.state == ObjectState::Settled)
            .map(|object| object.id)
            .collect()
    }

    /// Height of an object of a model that is not in the scene yet, metres.
    pub(crate) fn height_of(&self, model: &ModelChoice) -> Option<f64> {
        let model = self.library.load_uncached(model).ok()?;
        Some(2.0 * model.half_sides_m.z)
    }

    /// Height of the table top, metres.
    pub(crate) fn table_height_m(&self) -> f64 {
        self.scene.table.height_m
    }

    /// Position of the camera, world frame, metres.
    pub(crate) fn camera_position(&self) -> Point3<f64> {
        self.world_from_camera().translation.vector.into()
    }

    /// Random free position for an existing object, or for a new one.
    pub(crate) fn free_position(&self, object: Option<u16>, draw: u64) -> Option<[f64; 2]> {
        let radius_m = object
            .and_then(|object| self.find(object))
            .map_or(UNSEEN_RADIUS_M, |object| object.model.footprint_radius_m());
        let others = self.objects.iter().filter(|other| Some(other.id) != object);
        let taken: Vec<_> = others
            .map(|other| {
                let at = other.world_from_object.translation;
                ([at.x, at.y], other.model.footprint_radius_m())
            })
            .collect();
        let mut random = random_stream(draw, STREAM_FREE_SPOT);
        let table = arrangement::boards(&self.scene).pop()?;
        table.free_position(&taken, radius_m, GAP_M, &mut random)
    }

    /// Random model of an object that could be brought.
    pub(crate) fn random_model(&self, draw: u64) -> Option<ModelChoice> {
        self.library.choose(1, draw).pop()
    }
}
