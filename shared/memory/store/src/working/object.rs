//! Objects as they were seen last.

use serde::{Deserialize, Serialize};

use super::fact::Place;

/// How an object looks in one scene.
#[derive(Debug, Clone, Copy)]
pub struct Sighting<'a> {
    /// The track.
    pub track_id: u64,
    /// State of the track.
    pub state: &'a str,
    /// What it is called; `None` when unknown.
    pub label: Option<&'a str>,
    /// Where it is.
    pub place: Place,
    /// When the track began, nanoseconds since 1970.
    pub first_seen_ns: u64,
    /// When it was last measured, nanoseconds since 1970.
    pub last_seen_ns: u64,
}

/// An object, there or gone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Object {
    /// The track.
    pub track_id: u64,
    /// State of the track, the last one when it has gone.
    pub state: String,
    /// What it is, or was, called; `None` when unknown.
    pub label: Option<String>,
    /// Where it is, or was last; changes without a new fact.
    pub place: Place,
    /// When the track began, nanoseconds since 1970.
    pub first_seen_ns: u64,
    /// When it was last measured, nanoseconds since 1970.
    pub last_seen_ns: u64,
    /// When it was given up; `None` while it is there.
    pub gone_ns: Option<u64>,
    /// Number of the scene that showed it last.
    #[serde(skip)]
    pub(super) scene: u64,
    /// `last_seen_ns` as it is, or is about to be, on disk.
    #[serde(skip)]
    pub(super) noted_seen_ns: u64,
}

impl Object {
    pub(super) fn new(sighting: &Sighting<'_>) -> Self {
        Self {
            track_id: sighting.track_id,
            state: sighting.state.to_owned(),
            label: sighting.label.map(str::to_owned),
            place: sighting.place,
            first_seen_ns: sighting.first_seen_ns,
            last_seen_ns: sighting.last_seen_ns,
            gone_ns: None,
            scene: 0,
            noted_seen_ns: sighting.last_seen_ns,
        }
    }

    /// Takes over what is seen; allocates only for new words.
    pub(super) fn update(&mut self, sighting: &Sighting<'_>) {
        if self.state != sighting.state {
            sighting.state.clone_into(&mut self.state);
        }
        if self.label.as_deref() != sighting.label {
            self.label = sighting.label.map(str::to_owned);
        }
        self.place = sighting.place;
        self.last_seen_ns = sighting.last_seen_ns;
    }
}
