//! Ground truth of a simulated frame.

use crate::scene_object::{ObjectState, SimulatedObject};
use geometry::RigidTransform;
use nalgebra::Vector3;
use serde::Serialize;

/// Instance-mask value of the arm.
pub const ARM_ID: u16 = u16::MAX;
/// Instance-mask value of the person.
pub const PERSON_ID: u16 = u16::MAX - 1;

/// Ground truth of one object in a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectTruth {
    /// Object number in the scene, from 1; its value in the mask.
    pub id: u16,
    /// Unique name of the object instance: `mug-3`.
    pub name: String,
    /// Category of the object, such as `mug`.
    pub category: String,
    /// Pose: origin in the middle of the model's bounding box.
    pub world_from_object: RigidTransform,
    /// Sides of the model's bounding box, metres.
    pub size_m: Vector3<f64>,
    /// Velocity of the object, world frame, m/s.
    pub velocity_m_s: Vector3<f64>,
    /// State of motion of the object.
    pub state: ObjectState,
    /// Number of pixels that show the object.
    pub visible_px: u32,
    /// Number of pixels that the object would cover without occlusion.
    pub unoccluded_px: u32,
}

impl ObjectTruth {
    pub(crate) fn new(object: &SimulatedObject, visible_px: u32, unoccluded_px: u32) -> Self {
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

    /// Visible share of its unoccluded pixels, 0 to 1; 0 outside of the image.
    pub fn visible_fraction(&self) -> f64 {
        f64::from(self.visible_px) / f64::from(self.unoccluded_px.max(1))
    }
}

/// JSON document of a frame's ground truth.
#[derive(Debug, Serialize)]
struct TruthDocument<'a> {
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

/// Ground truth of a frame as JSON text.
pub fn truth_json(frame: u64, time_s: f64, objects: &[ObjectTruth]) -> String {
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
    let document = TruthDocument {
        frame,
        time_s,
        objects: objects.collect(),
    };
    // Plain numbers and strings: JSON can represent all of them.
    serde_json::to_string_pretty(&document).unwrap_or_default()
}
