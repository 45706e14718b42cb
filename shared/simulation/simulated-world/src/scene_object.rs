//! Object of the running world: pose, velocity and state.

use crate::ObjectModel;
use crate::furniture::TableDimensions;
use crate::physics::{BodyId, Physics};
use geometry::RigidTransform;
use nalgebra::{Point3, Vector3};
use std::sync::Arc;

/// Distance below the table top from which an object has fallen off, metres. Chosen.
const UNDER_M: f64 = 0.05;

coded_enum::coded_enum! {
    /// State of motion of an object.
    pub enum ObjectState {
        /// Object at rest.
        Settled, "settled";
        /// Object moving freely.
        Moving, "moving";
        /// Object held by the person.
        HeldByPerson, "held-by-person";
        /// Object held by the arm.
        HeldByArm, "held-by-arm";
        /// Object fallen off the table.
        OnFloor, "on-floor";
    }
}

/// Simulated object in the running world.
#[derive(Debug, Clone)]
pub struct SimulatedObject {
    /// Number in the scene, from 1; never reused.
    pub id: u16,
    /// Model of the object.
    pub model: Arc<ObjectModel>,
    /// Pose: origin in the middle of the model's bounding box.
    pub world_from_object: RigidTransform,
    /// Velocity of the origin, world frame, m/s.
    pub velocity_m_s: Vector3<f64>,
    /// State of motion of the object.
    pub state: ObjectState,
    pub(crate) body: BodyId,
    is_fall_reported: bool,
}

impl SimulatedObject {
    pub(crate) fn new(id: u16, model: Arc<ObjectModel>, body: BodyId) -> Self {
        Self {
            id,
            model,
            world_from_object: RigidTransform::identity(),
            velocity_m_s: Vector3::zeros(),
            state: ObjectState::Moving,
            body,
            is_fall_reported: false,
        }
    }

    pub(crate) fn is_held(&self) -> bool {
        matches!(
            self.state,
            ObjectState::HeldByPerson | ObjectState::HeldByArm
        )
    }

    pub(crate) fn refresh(&mut self, physics: &Physics, table: &TableDimensions) {
        self.world_from_object = physics.pose(self.body);
        self.velocity_m_s = physics.velocity(self.body).0;
        if self.is_held() {
            return;
        }
        self.state = if self.is_off(table) {
            ObjectState::OnFloor
        } else if physics.is_at_rest(self.body) {
            ObjectState::Settled
        } else {
            ObjectState::Moving
        };
    }

    /// True if the object is below the table top or next to the table.
    fn is_off(&self, table: &TableDimensions) -> bool {
        let at = self.world_from_object.translation;
        let is_above = at.x.abs() < table.size_m[0] / 2.0 && at.y.abs() < table.size_m[1] / 2.0;
        let is_under = at.z < table.height_m - UNDER_M;
        is_under || (!is_above && self.height_range_m().0 < table.height_m - UNDER_M)
    }

    /// True once for each object that has fallen to the floor.
    pub(crate) fn has_newly_fallen(&mut self) -> bool {
        let is_news = self.state == ObjectState::OnFloor && !self.is_fall_reported;
        self.is_fall_reported |= is_news;
        is_news
    }

    /// Lowest and highest point of the surface, world z, metres.
    pub(crate) fn height_range_m(&self) -> (f64, f64) {
        let rotation = self.world_from_object.rotation.cast::<f32>();
        let up = rotation.inverse() * Vector3::z();
        let heights = self
            .model
            .mesh
            .vertices
            .iter()
            .map(|v| v.position.coords.dot(&up));
        let (low, high) = heights.fold((f32::MAX, f32::MIN), |(low, high), z| {
            (low.min(z), high.max(z))
        });
        let z = self.world_from_object.translation.z;
        (z + f64::from(low), z + f64::from(high))
    }

    /// Middle of the top, world frame, metres.
    pub(crate) fn top(&self) -> Point3<f64> {
        let position = self.world_from_object.translation;
        Point3::new(position.x, position.y, self.height_range_m().1)
    }
}
