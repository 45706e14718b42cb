//! What is really there in a frame.

use crate::world::{ObjectState, SceneObject};
use geometry::RigidTransform;
use nalgebra::Vector3;
use serde::Serialize;

/// Value of the mask where the arm is seen.
pub const ARM_ID: u16 = u16::MAX;
/// Value of the mask where a person is seen.
pub const PERSON_ID: u16 = u16::MAX - 1;

/// One object of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct TrueObject {
    /// Number in the scene, from 1; its value in the mask.
    pub id: u16,
    /// Name that tells instances apart.
    pub name: String,
    /// Category.
    pub category: String,
    /// Pose: origin in the middle of the model's bounding box.
    pub world_from_object: RigidTransform,
    /// Sides of the model's bounding box, metres.
    pub size_m: Vector3<f64>,
    /// Velocity, world frame, m/s.
    pub velocity_m_s: Vector3<f64>,
    /// What it is doing.
    pub state: ObjectState,
    /// Pixels that show it.
    pub visible_px: u32,
    /// Pixels it would fill if nothing was before it.
    pub unoccluded_px: u32,
}

impl TrueObject {
    pub(crate) fn new(object: &SceneObject, visible_px: u32, unoccluded_px: u32) -> Self {
        Self {
            id: object.id,
            name: object.model.name.clone(),
            category: object.model.category.clone(),
            world_from_object: object.world_from_object,
            size_m: object.model.half_sides_m * 2.0,
            velocity_m_s: object.velocity_m_s,
            state: object.state,
            visible_px,
            unoccluded_px,
        }
    }

    /// Share of its pixels that show it, 0 to 1; 0 outside the image.
    pub fn visible_fraction(&self) -> f64 {
        f64::from(self.visible_px) / f64::from(self.unoccluded_px.max(1))
    }
}

/// A frame's truth as it stands in a file.
#[derive(Debug, Serialize)]
struct Document<'a> {
    frame: u64,
    time_s: f64,
    objects: Vec<ObjectDocument<'a>>,
}

#[derive(Debug, Serialize)]
struct ObjectDocument<'a> {
    id: u16,
    name: &'a str,
    category: &'a str,
    state: &'static str,
    position_m: [f64; 3],
    orientation_xyzw: [f64; 4],
    size_m: [f64; 3],
    velocity_m_s: [f64; 3],
    visible_px: u32,
    unoccluded_px: u32,
    visible_fraction: f64,
}

/// The truth of a frame as JSON text.
pub fn truth_json(frame: u64, time_s: f64, objects: &[TrueObject]) -> String {
    let objects = objects.iter().map(|object| ObjectDocument {
        id: object.id,
        name: &object.name,
        category: &object.category,
        state: object.state.word(),
        position_m: object.world_from_object.translation.vector.into(),
        orientation_xyzw: object.world_from_object.rotation.coords.into(),
        size_m: object.size_m.into(),
        velocity_m_s: object.velocity_m_s.into(),
        visible_px: object.visible_px,
        unoccluded_px: object.unoccluded_px,
        visible_fraction: object.visible_fraction(),
    });
    let document = Document {
        frame,
        time_s,
        objects: objects.collect(),
    };
    // Plain numbers and strings: there is nothing in it that JSON can not say.
    serde_json::to_string_pretty(&document).unwrap_or_default()
}
