//! Objects of the world model, with their last observed state.

use serde::{Deserialize, Serialize};

use crate::fact::BoxPose;

/// Observation of an object in one scene.
#[derive(Debug, Clone, Copy)]
pub struct Sighting<'a> {
    /// Track-id of the object.
    pub track_id: u64,
    /// State of the track.
    pub state: &'a str,
    /// Label of the object; `None` when unknown.
    pub label: Option<&'a str>,
    /// True if the label is only probable.
    pub is_probable: bool,
    /// Pose and size in the world frame.
    pub place: BoxPose,
    /// Number of the surface that carries the object; `None` without one.
    pub surface: Option<u64>,
    /// Start of the track, nanoseconds since 1970.
    pub first_seen_ns: u64,
    /// Time of the last measurement, nanoseconds since 1970.
    pub last_seen_ns: u64,
}

/// Object of the world model, present or past.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ObjectRecord {
    /// Track-id of the object.
    pub track_id: u64,
    /// Last observed state of the track.
    pub state: String,
    /// Last label; `None` for an unknown object.
    pub label: Option<String>,
    /// True if the last label is only probable.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_probable: bool,
    /// Last pose and size in the world frame; small changes make no new fact.
    pub place: BoxPose,
    /// Start of the track, nanoseconds since 1970.
    pub first_seen_ns: u64,
    /// Time of the last measurement, nanoseconds since 1970.
    pub last_seen_ns: u64,
    /// Time of the disappearance; `None` for a present object.
    pub gone_ns: Option<u64>,
    /// Number of the surface that carried the object in its last scene.
    #[serde(skip)]
    pub surface: Option<u64>,
    /// Number of the last scene that contained the object.
    #[serde(skip)]
    pub(crate) scene: u64,
    /// Value of `last_seen_ns` on disk, or about to be written.
    #[serde(skip)]
    pub(crate) noted_seen_ns: u64,
}

impl ObjectRecord {
    pub(crate) fn new(sighting: &Sighting<'_>) -> Self {
        Self {
            track_id: sighting.track_id,
            state: sighting.state.to_owned(),
            label: sighting.label.map(str::to_owned),
            is_probable: sighting.is_probable,
            place: sighting.place,
            first_seen_ns: sighting.first_seen_ns,
            last_seen_ns: sighting.last_seen_ns,
            gone_ns: None,
            surface: sighting.surface,
            scene: 0,
            noted_seen_ns: sighting.last_seen_ns,
        }
    }

    /// Copies an observation; allocates only for changed strings.
    pub(crate) fn update(&mut self, sighting: &Sighting<'_>) {
        if self.state != sighting.state {
            sighting.state.clone_into(&mut self.state);
        }
        if self.label.as_deref() != sighting.label {
            self.label = sighting.label.map(str::to_owned);
        }
        self.is_probable = sighting.is_probable;
        self.surface = sighting.surface;
        self.place = sighting.place;
        self.last_seen_ns = sighting.last_seen_ns;
    }
}
