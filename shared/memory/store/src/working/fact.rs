//! Facts: what holds of whom, from when to when.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use super::world_config::WorldConfig;

/// What a fact is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Subject {
    /// The object with this track-id.
    Object(u64),
    /// The robot.
    Robot,
    /// The task with this number.
    Task(u64),
}

/// What a fact says something about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Property {
    /// State of a track or of a task.
    State,
    /// What an object is called; there is no such fact while it is unknown.
    Label,
    /// Where an object is, and how large.
    Place,
    /// What the robot is doing.
    Activity,
    /// Whether the robot holds something.
    Holding,
}

/// What a fact says.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Value {
    /// See [`Property::State`].
    State(String),
    /// See [`Property::Label`].
    Label(String),
    /// See [`Property::Place`].
    Place(Place),
    /// See [`Property::Activity`].
    Activity(String),
    /// See [`Property::Holding`].
    Holding(bool),
}

/// A value that is claimed and not kept yet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Claim<'a> {
    State(&'a str),
    Label(&'a str),
    Place(&'a Place),
    Activity(&'a str),
    Holding(bool),
}

/// The box of an object in the world.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Place {
    /// Centre, metres.
    pub position_m: [f64; 3],
    /// Orientation: x, y, z, w of a unit quaternion.
    pub orientation_xyzw: [f64; 4],
    /// Full lengths of the sides, metres.
    pub size_m: [f64; 3],
}

/// Something that holds, or held, for a time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fact {
    /// Numbers of facts grow in the order in which the facts were noticed.
    pub number: u64,
    /// What it is about.
    pub subject: Subject,
    /// What it says.
    pub value: Value,
    /// Since when it holds, nanoseconds since 1970.
    pub start_ns: u64,
    /// Until when it held, never before `start_ns`; `None` while it holds.
    pub end_ns: Option<u64>,
}

impl Value {
    /// What the value is of.
    pub fn property(&self) -> Property {
        self.as_claim().property()
    }

    pub(super) fn as_claim(&self) -> Claim<'_> {
        match self {
            Self::State(state) => Claim::State(state),
            Self::Label(label) => Claim::Label(label),
            Self::Place(place) => Claim::Place(place),
            Self::Activity(activity) => Claim::Activity(activity),
            Self::Holding(is_holding) => Claim::Holding(*is_holding),
        }
    }
}

impl Claim<'_> {
    pub(super) fn property(self) -> Property {
        match self {
            Self::State(_) => Property::State,
            Self::Label(_) => Property::Label,
            Self::Place(_) => Property::Place,
            Self::Activity(_) => Property::Activity,
            Self::Holding(_) => Property::Holding,
        }
    }

    pub(super) fn to_value(self) -> Value {
        match self {
            Self::State(state) => Value::State(state.to_owned()),
            Self::Label(label) => Value::Label(label.to_owned()),
            Self::Place(place) => Value::Place(*place),
            Self::Activity(activity) => Value::Activity(activity.to_owned()),
            Self::Holding(is_holding) => Value::Holding(is_holding),
        }
    }

    /// Whether nothing new is claimed beside what `value` says.
    pub(super) fn agrees(self, value: &Value, config: &WorldConfig) -> bool {
        match (self, value) {
            (Self::Place(place), Value::Place(known)) => {
                !place.has_moved_from(known, config) && !place.has_other_size_than(known, config)
            }
            _ => self == value.as_claim(),
        }
    }
}

impl Place {
    /// Distance between the centres, metres.
    pub fn distance_m(&self, other: &Self) -> f64 {
        (Vector3::from(self.position_m) - Vector3::from(other.position_m)).norm()
    }

    /// The angle by which one is turned against the other, radians, 0 to π.
    pub fn turn_rad(&self, other: &Self) -> f64 {
        let rotation =
            |[x, y, z, w]: [f64; 4]| UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
        rotation(self.orientation_xyzw).angle_to(&rotation(other.orientation_xyzw))
    }

    pub(super) fn has_moved_from(&self, other: &Self, config: &WorldConfig) -> bool {
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

    fn place(x: f64, turn_rad: f64, side_m: f64) -> Place {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn_rad);
        Place {
            position_m: [x, 0.0, 0.0],
            orientation_xyzw: turn.coords.into(),
            size_m: [0.1, side_m, 0.1],
        }
    }

    #[test]
    fn a_place_is_another_one_by_distance_angle_or_size() {
        let config = WorldConfig {
            move_min_m: 0.02,
            turn_min_rad: 0.3,
            keep_ns: 0,
            n_kept_most: 0,
            seen_period_ns: 0,
            write_buffer_bytes: crate::WRITE_BUFFER_BYTES,
        };
        let known = Value::Place(place(0.0, 0.0, 0.1));
        let agrees = |place: Place| Claim::Place(&place).agrees(&known, &config);
        assert!(agrees(place(0.019, 0.29, 0.119)));
        assert!(!agrees(place(0.021, 0.0, 0.1)));
        assert!(!agrees(place(0.0, -0.31, 0.1)));
        assert!(!agrees(place(0.0, 0.0, 0.121)));
        // A full turn is none.
        assert!(agrees(place(0.0, std::f64::consts::TAU, 0.1)));
    }
}
