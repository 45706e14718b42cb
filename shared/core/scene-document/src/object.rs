//! Document of a tracked object.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Answer of recognition about the category of an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CategoryAnswer {
    /// The object is of the category that is its label.
    Is,
    /// The object is probably of its best category.
    Probably,
    /// The category of the object is not known.
    #[default]
    Unknown,
}

impl CategoryAnswer {
    /// Least probability of the best category from which it is said without doubt. Chosen: on mesh
    /// categories nineteen in twenty such names are right.
    pub const IS_PROBABILITY_MIN: f64 = 0.9;

    /// Answer about an object with or without a label, and with the probability of its best
    /// category. A label without a probability is said without doubt.
    pub fn of(is_labelled: bool, probability: Option<f64>) -> Self {
        let is_certain = probability.is_none_or(|one| one >= Self::IS_PROBABILITY_MIN);
        match (is_labelled, is_certain) {
            (false, _) => Self::Unknown,
            (true, true) => Self::Is,
            (true, false) => Self::Probably,
        }
    }

    /// Text of a label: as it is, with a question mark when it is only probable, or `unknown`.
    pub fn shown(self, label: Option<&str>) -> String {
        match (self, label) {
            (_, None) => "unknown".to_owned(),
            (Self::Probably, Some(label)) => format!("{label}?"),
            (_, Some(label)) => label.to_owned(),
        }
    }
}

/// Tracked object.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct ObjectDocument {
    /// Track-id of the object.
    pub track_id: u64,
    /// State of the track: `tracked`, `missing`, `occluded` or `out-of-view`;
    /// `stale` while the scene is, because nothing is known about the present then.
    pub state: String,
    /// Age of the scene, as in [`SceneDocument::scene_age_s`](crate::SceneDocument::scene_age_s).
    #[serde(default)]
    pub scene_age_s: Option<f64>,
    /// Capture time of the scene's frame, as in [`SceneDocument::capture_stamp_ns`](crate::SceneDocument::capture_stamp_ns).
    #[serde(default)]
    pub capture_stamp_ns: Option<u64>,
    /// Category name of the object, certain or probable; null when unknown.
    pub label: Option<String>,
    /// Answer about the category: `is`, `probably` or `unknown`.
    #[serde(default)]
    pub answer: CategoryAnswer,
    /// Distance in descriptor space to the nearest stored view of the best category, mean over the
    /// sides; null when nothing is stored.
    pub distance: Option<f64>,
    /// Probability that the object belongs to the best category; null when nothing is stored.
    pub probability: Option<f64>,
    /// Centre of the box in the world, metres.
    pub position_m: [f64; 3],
    /// Orientation of the box in the world, quaternion: x, y, z, w.
    pub orientation_xyzw: [f64; 4],
    /// Side lengths of the object's box, metres.
    pub size_m: [f64; 3],
    /// Capture time of the track's first measurement, nanoseconds, on the clock of the frame.
    #[serde(default)]
    pub first_seen_ns: u64,
    /// Capture time of the object's last measurement, nanoseconds, on the clock of the frame.
    #[serde(default)]
    pub last_seen_ns: u64,
    /// Age of the track in capture time, seconds.
    pub age_s: f64,
    /// Time since the capture in which the object was last measured, seconds. It goes on while
    /// no frame comes, except in lockstep.
    pub unseen_s: f64,
    /// Number of measured points of the object.
    pub n_points: u32,
    /// Number of described views of the object so far.
    pub n_views: u32,
    /// Mean colour of the object: red, green, blue.
    pub mean_rgb: [u8; 3],
    /// Basic colour terms of the object, greatest share first.
    #[serde(default)]
    pub colors: Vec<ColorShareDocument>,
    /// True if the image border cuts the object.
    pub cut_by_image: bool,
    /// History sequence of the memory with which the label was recognised.
    pub memory_sequence: u64,
    /// Covariance of the pose; null when unknown.
    #[serde(default)]
    pub covariance: Option<CovarianceDocument>,
    /// Velocity of the box's centre, world axes, metres per second; null when unknown.
    #[serde(default)]
    pub velocity_m_s: Option<[f64; 3]>,
    /// Angular velocity, world axes, radians per second; null when unknown.
    #[serde(default)]
    pub angular_velocity_rad_s: Option<[f64; 3]>,
    /// Number of the newest view, from 0; null before the first view.
    #[serde(default)]
    pub view: Option<u32>,
    /// True if this frame's view is a key view.
    #[serde(default)]
    pub is_key_view: bool,
    /// Number of key views of the object so far.
    #[serde(default)]
    pub n_key_views: u32,
    /// Number of different sides of the object that the label rests on.
    #[serde(default)]
    pub n_sides: u32,
    /// Most probable categories, best first.
    #[serde(default)]
    pub categories: Vec<NearCategoryDocument>,
    /// Track-id of the lost track that this object continues; null for none.
    #[serde(default)]
    pub linked_to: Option<u64>,
    /// Processing times of the newest view in the object's actor.
    #[serde(default)]
    pub stamps: ActorStampsDocument,
}

/// Covariance of a pose, each matrix packed as xx, xy, xz, yy, yz, zz, world axes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CovarianceDocument {
    /// Covariance of the object's position, square metres.
    pub position_m2: [f64; 6],
    /// Covariance of a small rotation vector, square radians.
    pub rotation_rad2: [f64; 6],
}

/// Basic colour term with its share of an object.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ColorShareDocument {
    /// Colour term: `black`, `white`, `grey`, `red`, `green`, `yellow`, `blue`, `brown`, `orange`,
    /// `pink` or `purple`.
    pub color: String,
    /// Share of the object's measured points, 0 to 1, in hundredths.
    pub share: f64,
}

/// Candidate category of an object with its descriptor distance and probability.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct NearCategoryDocument {
    /// Name of the nearby category.
    pub label: String,
    /// Distance in descriptor space to the category's nearest view.
    pub distance: f64,
    /// Probability that the object belongs to the category, 0 to 1.
    #[serde(default)]
    pub probability: f64,
}

/// Processing times of a view in its actor, monotonic clock, nanoseconds; null when not
/// reached.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub struct ActorStampsDocument {
    /// Time at which the view was sent to the actor.
    pub asked_ns: Option<u64>,
    /// Time at which the actor began to process the view.
    pub begun_ns: Option<u64>,
    /// Time at which the descriptor was complete.
    pub described_ns: Option<u64>,
    /// Time at which the recognition of the view was complete.
    pub recognised_ns: Option<u64>,
    /// Time at which the frame loop received the actor's answer.
    pub answered_ns: Option<u64>,
}
