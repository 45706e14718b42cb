//! Ground truth of a simulated frame.

use crate::scene_object::{ObjectState, SimulatedObject};
use geometry::RigidTransform;
use nalgebra::{Quaternion, Translation3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

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
#[derive(Debug, Serialize, Deserialize)]
struct TruthDocument<'a> {
    #[serde(default)]
    frame: u64,
    #[serde(default)]
    time_s: f64,
    objects: Vec<ObjectDocument<'a>>,
}

#[derive(Debug, Serialize, Deserialize)]
struct ObjectDocument<'a> {
    id: u16,
    name: Cow<'a, str>,
    category: Cow<'a, str>,
    state: Cow<'a, str>,
    position_m: [f64; 3],
    orientation_xyzw: [f64; 4],
    size_m: [f64; 3],
    velocity_m_s: [f64; 3],
    visible_px: u32,
    unoccluded_px: u32,
    #[serde(skip_deserializing)]
    visible_fraction: f64,
}

/// Ground truth of a frame as JSON text.
pub fn truth_json(frame: u64, time_s: f64, objects: &[ObjectTruth]) -> String {
    let objects = objects.iter().map(|object| ObjectDocument {
        id: object.id,
        name: object.name.as_str().into(),
        category: object.category.as_str().into(),
        state: object.state.word().into(),
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

impl TryFrom<ObjectDocument<'_>> for ObjectTruth {
    type Error = String;

    fn try_from(raw: ObjectDocument<'_>) -> Result<Self, String> {
        let rotation = Quaternion::from(raw.orientation_xyzw);
        if !(0.99..1.01).contains(&rotation.norm()) {
            return Err(format!(
                "the orientation of object {} is no unit quaternion",
                raw.id
            ));
        }
        let rotation = UnitQuaternion::new_normalize(rotation);
        let mut states = ObjectState::ALL.into_iter();
        let state = states.find(|state| state.word() == raw.state);
        Ok(Self {
            id: raw.id,
            name: raw.name.into_owned(),
            category: raw.category.into_owned(),
            world_from_object: RigidTransform::from_parts(
                Translation3::from(Vector3::from(raw.position_m)),
                rotation,
            ),
            size_m: raw.size_m.into(),
            velocity_m_s: raw.velocity_m_s.into(),
            state: state.unwrap_or(ObjectState::Moving),
            visible_px: raw.visible_px,
            unoccluded_px: raw.unoccluded_px,
        })
    }
}

/// Reads the ground truth of a frame from its JSON text.
///
/// # Errors
/// A sentence about what is wrong with the text.
pub fn truth_from_json(json: &[u8]) -> Result<Vec<ObjectTruth>, String> {
    let document: TruthDocument<'_> =
        serde_json::from_slice(json).map_err(|error| error.to_string())?;
    let objects = document.objects.into_iter();
    objects.map(TryInto::try_into).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ground_truth_files_are_read_back_and_validated() {
        let object = ObjectTruth {
            id: 3,
            name: "mug-7".into(),
            category: "mug".into(),
            world_from_object: RigidTransform::new(Vector3::new(0.1, 0.2, 0.7), Vector3::z()),
            size_m: Vector3::new(0.1, 0.08, 0.09),
            velocity_m_s: Vector3::zeros(),
            state: ObjectState::HeldByPerson,
            visible_px: 900,
            unoccluded_px: 1000,
        };
        let text = truth_json(4, 0.5, std::slice::from_ref(&object));
        let read = truth_from_json(text.as_bytes()).unwrap();
        assert_eq!(
            (read[0].id, &read[0].name, read[0].state),
            (3, &object.name, object.state)
        );
        let apart = read[0].world_from_object.inverse() * object.world_from_object;
        assert!(apart.translation.vector.norm() < 1e-12 && apart.rotation.angle() < 1e-7);
        let w = object.world_from_object.rotation.w;
        let broken = text.replace(&format!("{w}"), "9.0");
        assert!(
            truth_from_json(broken.as_bytes())
                .unwrap_err()
                .contains("object 3")
        );
        assert!(truth_from_json(b"{}").is_err());
        // Only the objects count, whoever has written them.
        assert_eq!(truth_from_json(br#"{"objects": []}"#).unwrap().len(), 0);
    }
}
