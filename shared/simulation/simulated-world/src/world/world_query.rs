//! World queries of the simulated person.

use super::World;
use crate::arrangement;
use crate::model_choice::ModelChoice;
use crate::person::PersonQuery;
use crate::random_stream::random_stream;
use crate::scene_object::ObjectState;
use nalgebra::Point3;

/// Free space that a person leaves around an object, metres. Chosen.
const GAP_M: f64 = 0.05;
/// Assumed footprint radius of an object that is not in the scene yet, metres. Chosen.
const UNSEEN_RADIUS_M: f64 = 0.11;
/// Random stream of free positions.
const STREAM_FREE_SPOT: u64 = 4;

pub(super) struct WorldQuery<'a>(&'a World);

impl<'a> WorldQuery<'a> {
    pub(super) fn new(world: &'a World) -> Self {
        Self(world)
    }
}

impl PersonQuery for WorldQuery<'_> {
    fn object(&self, object: u16) -> Option<(Point3<f64>, f64)> {
        let object = self.0.find(object)?;
        let is_free = !object.is_held() && object.state != ObjectState::OnFloor;
        is_free.then(|| (object.top(), object.height_range_m().0))
    }

    fn free_objects(&self) -> Vec<u16> {
        let at_rest = self.0.objects.iter();
        at_rest
            .filter(|object| object.state == ObjectState::Settled)
            .map(|object| object.id)
            .collect()
    }

    fn height_of(&self, model: &ModelChoice) -> Option<f64> {
        let model = self.0.library().load_uncached(model).ok()?;
        Some(2.0 * model.half_sides_m.z)
    }

    fn table_height_m(&self) -> f64 {
        self.0.scene.table.height_m
    }

    fn camera(&self) -> Point3<f64> {
        self.0.world_from_camera().translation.vector.into()
    }

    fn free_position(&self, object: Option<u16>, draw: u64) -> Option<[f64; 2]> {
        let radius_m = object
            .and_then(|object| self.0.find(object))
            .map_or(UNSEEN_RADIUS_M, |object| object.model.footprint_radius_m());
        let others = self
            .0
            .objects
            .iter()
            .filter(|other| Some(other.id) != object);
        let taken: Vec<_> = others
            .map(|other| {
                let at = other.world_from_object.translation;
                ([at.x, at.y], other.model.footprint_radius_m())
            })
            .collect();
        let mut random = random_stream(draw, STREAM_FREE_SPOT);
        arrangement::free_position(&taken, radius_m, &self.0.scene.table, GAP_M, &mut random)
    }

    fn random_model(&self, draw: u64) -> Option<ModelChoice> {
        self.0.library().choose(1, draw).pop()
    }
}
