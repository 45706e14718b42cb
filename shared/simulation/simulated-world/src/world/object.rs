//! One object of the running world.

use crate::ObjectModel;
use crate::physics::{BodyId, Physics};
use crate::scene::Table;
use geometry::RigidTransform;
use nalgebra::{Point3, Vector3};
use std::sync::Arc;

/// What is lower than this under the table's surface has fallen, metres.
const UNDER_M: f64 = 0.05;

/// What an object is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ObjectState {
    /// It lies still.
    Settled,
    /// It moves by itself.
    Moving,
    /// A person holds it.
    HeldByPerson,
    /// The arm holds it.
    HeldByArm,
    /// It has fallen off the table.
    OnFloor,
}

impl ObjectState {
    /// The word for people and files.
    pub fn word(self) -> &'static str {
        match self {
            Self::Settled => "settled",
            Self::Moving => "moving",
            Self::HeldByPerson => "held-by-person",
            Self::HeldByArm => "held-by-arm",
            Self::OnFloor => "on-floor",
        }
    }
}

/// One object.
#[derive(Debug, Clone)]
pub struct SceneObject {
    /// Number in the scene, from 1; never used twice.
    pub id: u16,
    /// What it is.
    pub model: Arc<ObjectModel>,
    /// Pose: origin in the middle of the model's bounding box.
    pub world_from_object: RigidTransform,
    /// Velocity of the origin, world frame, m/s.
    pub velocity_m_s: Vector3<f64>,
    /// What it is doing.
    pub state: ObjectState,
    pub(crate) body: BodyId,
    is_fall_told: bool,
}

impl SceneObject {
    pub(crate) fn new(id: u16, model: Arc<ObjectModel>, body: BodyId) -> Self {
        Self {
            id,
            model,
            world_from_object: RigidTransform::identity(),
            velocity_m_s: Vector3::zeros(),
            state: ObjectState::Moving,
            body,
            is_fall_told: false,
        }
    }

    pub(crate) fn is_held(&self) -> bool {
        matches!(
            self.state,
            ObjectState::HeldByPerson | ObjectState::HeldByArm
        )
    }

    pub(crate) fn refresh(&mut self, physics: &Physics, table: &Table) {
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

    /// Whether it is beside the table, and lower.
    fn is_off(&self, table: &Table) -> bool {
        let at = self.world_from_object.translation;
        let is_above = at.x.abs() < table.size_m[0] / 2.0 && at.y.abs() < table.size_m[1] / 2.0;
        let is_under = at.z < table.height_m - UNDER_M;
        is_under || (!is_above && self.height_range_m().0 < table.height_m - UNDER_M)
    }

    /// Whether it lies on the floor and nobody was told.
    pub(crate) fn has_newly_fallen(&mut self) -> bool {
        let is_news = self.state == ObjectState::OnFloor && !self.is_fall_told;
        self.is_fall_told |= is_news;
        is_news
    }

    /// Lowest and highest point of its surface, world z, metres.
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

    /// Middle of its top, world frame, metres.
    pub(crate) fn top(&self) -> Point3<f64> {
        let position = self.world_from_object.translation;
        Point3::new(position.x, position.y, self.height_range_m().1)
    }
}
