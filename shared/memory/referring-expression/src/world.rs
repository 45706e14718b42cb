//! World of a query: objects, viewpoint, lessons and names, as the caller knows them.

use nalgebra::{UnitQuaternion, Vector3};

/// Presence of an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Presence {
    /// The camera sees the object now.
    #[default]
    InView,
    /// The object is believed to be at its place, but is not seen now.
    OutOfView,
    /// The object is not there any more. Its place is the one where it was last seen, and what is
    /// not known of it never fits.
    Gone,
}

/// Object that an expression may refer to.
#[derive(Debug, Clone, PartialEq)]
pub struct WorldObject {
    /// Number of the track.
    pub track_id: u64,
    /// Categories with their probability, best first. The first is the label if `is_labelled`.
    pub names: Vec<(String, f64)>,
    /// True if a person gave the first name to this very object.
    pub is_labelled: bool,
    /// Shares of the basic colour terms, in the order of [`ColorTerm::ALL`](crate::ColorTerm::ALL),
    /// 0 to 1. All zero if the colour is not known.
    pub color_shares: [f32; 11],
    /// Centre of the box, world frame, z up.
    pub centre_in_world_m: [f64; 3],
    /// Orientation of the box, world from box, as a quaternion x, y, z, w.
    pub orientation_xyzw: [f64; 4],
    /// Edges of the box along its own axes.
    pub size_m: [f64; 3],
    /// Presence on the table.
    pub presence: Presence,
    /// Instant of the first view, wall clock since 1970.
    pub first_seen_ns: i64,
    /// Instant of the last view, wall clock since 1970.
    pub last_seen_ns: i64,
}

impl WorldObject {
    /// Most probable name, if there is one.
    pub fn best_name(&self) -> Option<&str> {
        self.names.first().map(|(name, _)| name.as_str())
    }

    /// True if the object is not there any more.
    pub fn is_gone(&self) -> bool {
        self.presence == Presence::Gone
    }
}

/// Viewpoint of left, right, in front of and behind: those of a person beside the camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Viewpoint {
    /// Position of the camera, world frame.
    pub position_in_world_m: [f64; 3],
    /// Horizontal direction to the right of the image, world frame.
    pub right_in_world: [f64; 3],
    /// Horizontal direction away from the camera, world frame.
    pub forward_in_world: [f64; 3],
}

impl Viewpoint {
    /// Viewpoint of a camera in a world whose z axis points up. The camera looks along its z
    /// axis, and its y axis points down in the image. `None` for a pose that is not finite.
    pub fn of_camera(
        position_in_world_m: Vector3<f64>,
        rotation: &UnitQuaternion<f64>,
    ) -> Option<Self> {
        // A camera that looks straight down has the upper edge of its image ahead.
        let ahead = rotation * Vector3::z() - 1e-3 * (rotation * Vector3::y());
        let forward = Vector3::new(ahead.x, ahead.y, 0.0).try_normalize(1e-6)?;
        position_in_world_m
            .iter()
            .all(|value| value.is_finite())
            .then_some(Self {
                position_in_world_m: position_in_world_m.into(),
                right_in_world: [forward.y, -forward.x, 0.0],
                forward_in_world: forward.into(),
            })
    }
}

/// Teaching event: a person gave a category to an object.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Lesson {
    /// Track of the object that was shown, if it is known.
    pub track_id: Option<u64>,
    /// Category that was taught.
    pub category: String,
    /// Person who taught it.
    pub author: String,
    /// Instant, wall clock since 1970.
    pub wall_ns: i64,
}

/// World in which an expression is grounded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QueryWorld<'a> {
    /// Objects that are known now, in view or not.
    pub objects: &'a [WorldObject],
    /// Viewpoint; None if the pose of the camera is not known.
    pub viewpoint: Option<Viewpoint>,
    /// Teaching events, in any order.
    pub lessons: &'a [Lesson],
    /// Names of all categories in memory, also of objects that are not here.
    pub taught_names: &'a [String],
    /// The present, wall clock since 1970.
    pub now_ns: i64,
    /// Offset of local time to UTC, for calendar days.
    pub utc_offset_s: i32,
    /// Person who asks: the author that "I" means. None if it is not known.
    pub speaker: Option<&'a str>,
}
