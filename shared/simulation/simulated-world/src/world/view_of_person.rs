//! The world as its person sees it.

use super::{ObjectState, World};
use crate::arrangement;
use crate::chance;
use crate::person::Surroundings;
use crate::scene::ModelChoice;
use nalgebra::Point3;

/// Free space a person leaves around an object, metres.
const GAP_M: f64 = 0.05;
/// Footprint of an object that is not there yet, metres.
const UNSEEN_RADIUS_M: f64 = 0.11;
/// Purpose of the random stream.
const SPOT: u64 = 4;

pub(super) struct ViewOfPerson<'a>(&'a World);

impl<'a> ViewOfPerson<'a> {
    pub(super) fn new(world: &'a World) -> Self {
        Self(world)
    }
}

impl Surroundings for ViewOfPerson<'_> {
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
        let model = self.0.library().look_at(model).ok()?;
        Some(2.0 * model.half_sides_m.z)
    }

    fn table_height_m(&self) -> f64 {
        self.0.scene.table.height_m
    }

    fn camera(&self) -> Point3<f64> {
        self.0.world_from_camera().translation.vector.into()
    }

    fn free_spot(&self, object: Option<u16>, draw: u64) -> Option<[f64; 2]> {
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
        let mut random = chance::stream(draw, SPOT);
        arrangement::free_spot(&taken, radius_m, &self.0.scene.table, GAP_M, &mut random)
    }

    fn another_model(&self, draw: u64) -> Option<ModelChoice> {
        self.0.library().choose(1, draw).pop()
    }
}
