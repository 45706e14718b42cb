//! Facts: temporally valid statements (subject, property value, validity interval).

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use crate::world_config::WorldConfig;

/// Subject of a fact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Subject {
    /// Object as the subject, by its track-id.
    #[serde(rename = "ObjectRecord")]
    Object(u64),
    /// Robot as the subject.
    Robot,
    /// Task as the subject, by its number.
    Task(u64),
    /// Support surface as the subject, by its number.
    Surface(u64),
}

/// Property of a subject in the world model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Property {
    /// State of a track, a task or a surface.
    State,
    /// Label of an object; there is no such fact while the object is unknown.
    Label,
    /// Pose and size of the box of an object or of a surface.
    Place,
    /// Activity of the robot.
    Activity,
    /// Gripper state of the robot: holding something or not.
    Holding,
}

/// Value of a subject's property.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Value {
    /// Value of [`Property::State`].
    State(String),
    /// Value of [`Property::Label`].
    Label(String),
    /// Value of [`Property::Label`] that is only probable.
    ProbableLabel(String),
    /// Value of [`Property::Place`].
    #[serde(rename = "BoxPose")]
    Place(BoxPose),
    /// Value of [`Property::Activity`].
    Activity(String),
    /// Value of [`Property::Holding`].
    Holding(bool),
}

/// Borrowed [`Value`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum ValueRef<'a> {
    State(&'a str),
    Label(&'a str),
    ProbableLabel(&'a str),
    Place(&'a BoxPose),
    Activity(&'a str),
    Holding(bool),
}

/// Oriented bounding box of an object in the world frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BoxPose {
    /// Centre of the box, world frame, metres.
    pub position_m: [f64; 3],
    /// Orientation: unit quaternion x, y, z, w.
    pub orientation_xyzw: [f64; 4],
    /// Full side lengths of the box, metres.
    pub size_m: [f64; 3],
}

/// Fact with its validity interval.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fact {
    /// Number of the fact, increasing in the order of detection.
    pub number: u64,
    /// Subject of the fact.
    pub subject: Subject,
    /// Value of the property that the fact asserts.
    pub value: Value,
    /// Start of the validity, nanoseconds since 1970.
    pub start_ns: u64,
    /// End of the validity, not before `start_ns`; `None` while the fact holds.
    pub end_ns: Option<u64>,
}

impl Value {
    /// Label, certain or probable; `None` for another property.
    pub fn label(&self) -> Option<&str> {
        match self {
            Self::Label(label) | Self::ProbableLabel(label) => Some(label),
            _ => None,
        }
    }

    /// Property to which the value belongs.
    pub fn property(&self) -> Property {
        self.as_value_ref().property()
    }

    pub(crate) fn as_value_ref(&self) -> ValueRef<'_> {
        match self {
            Self::State(state) => ValueRef::State(state),
            Self::Label(label) => ValueRef::Label(label),
            Self::ProbableLabel(label) => ValueRef::ProbableLabel(label),
            Self::Place(place) => ValueRef::Place(place),
            Self::Activity(activity) => ValueRef::Activity(activity),
            Self::Holding(is_holding) => ValueRef::Holding(*is_holding),
        }
    }
}

impl ValueRef<'_> {
    pub(crate) fn property(self) -> Property {
        match self {
            Self::State(_) => Property::State,
            Self::Label(_) | Self::ProbableLabel(_) => Property::Label,
            Self::Place(_) => Property::Place,
            Self::Activity(_) => Property::Activity,
            Self::Holding(_) => Property::Holding,
        }
    }

    pub(crate) fn to_value(self) -> Value {
        match self {
            Self::State(state) => Value::State(state.to_owned()),
            Self::Label(label) => Value::Label(label.to_owned()),
            Self::ProbableLabel(label) => Value::ProbableLabel(label.to_owned()),
            Self::Place(place) => Value::Place(*place),
            Self::Activity(activity) => Value::Activity(activity.to_owned()),
            Self::Holding(is_holding) => Value::Holding(is_holding),
        }
    }

    /// `true` if the value equals the known one within the thresholds of the configuration. A
    /// label that was certain and is probable now is the same.
    pub(crate) fn matches_value(self, value: &Value, config: &WorldConfig) -> bool {
        match (self, value) {
            (Self::Place(place), Value::Place(known)) => {
                !place.has_moved_from(known, config) && !place.has_other_size_than(known, config)
            }
            (Self::ProbableLabel(label), Value::Label(known)) => label == known,
            _ => self == value.as_value_ref(),
        }
    }
}

impl BoxPose {
    /// Distance between the centres of two boxes, metres.
    pub fn distance_m(&self, other: &Self) -> f64 {
        (Vector3::from(self.position_m) - Vector3::from(other.position_m)).norm()
    }

    /// Rotation angle between the orientations, radians, 0 to π.
    pub fn turn_rad(&self, other: &Self) -> f64 {
        let rotation =
            |[x, y, z, w]: [f64; 4]| UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
        rotation(self.orientation_xyzw).angle_to(&rotation(other.orientation_xyzw))
    }

    pub(crate) fn has_moved_from(&self, other: &Self, config: &WorldConfig) -> bool {
        self.distance_m(other) > config.move_min_m || self.turn_rad(other) > config.turn_min_rad
    }

    fn has_other_size_than(&self, other: &Self, config: &WorldConfig) -> bool {
        let sides = self.size_m.iter().zip(&other.size_m);
        sides
            .map(|(a, b)| (a - b).abs())
            .any(|d| d > config.move_min_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(x: f64, turn_rad: f64, side_m: f64) -> BoxPose {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn_rad);
        BoxPose {
            position_m: [x, 0.0, 0.0],
            orientation_xyzw: turn.coords.into(),
            size_m: [0.1, side_m, 0.1],
        }
    }

    #[test]
    fn place_changes_by_distance_angle_or_size() {
        let config = WorldConfig {
            move_min_m: 0.02,
            turn_min_rad: 0.3,
            keep_ns: 0,
            n_kept_most: 0,
            seen_period_ns: 0,
            write_buffer_bytes: 4 << 20,
        };
        let known = Value::Place(place(0.0, 0.0, 0.1));
        let matches_value = |place: BoxPose| ValueRef::Place(&place).matches_value(&known, &config);
        assert!(matches_value(place(0.019, 0.29, 0.119)));
        assert!(!matches_value(place(0.021, 0.0, 0.1)));
        assert!(!matches_value(place(0.0, -0.31, 0.1)));
        assert!(!matches_value(place(0.0, 0.0, 0.121)));
        // A full turn is no rotation.
        assert!(matches_value(place(0.0, std::f64::consts::TAU, 0.1)));
    }
}
