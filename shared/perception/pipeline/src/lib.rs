//! Per-frame perception pipeline: data association, tracking, description and
//! recognition as pure functions over explicit state.
//!
//! A frame is processed in two halves, because the second runs once per object and on
//! any thread:
//!
//! - [`TrackTable::predict`] supplies the expected boxes that detection needs as a
//!   prior. [`TrackTable::step`] associates the candidates of a [`detection::Detection`]
//!   with the tracks, starts tracks for accepted candidates and ends lost tracks.
//! - [`ObjectState::observe`] processes one object's measurement: motion filter,
//!   descriptor, recognition and key-view selection. [`TrackTable::absorb`] applies the
//!   resulting [`Posterior`] to the track.
//!
//! Invariants: this crate never reads a clock, draws no random numbers, does no I/O, and
//! knows nothing of threads, actors or messages.
//!
//! # Example
//!
//! ```
//! use geometry::RigidTransform;
//! use pipeline::{Config, FramePose, TrackUpdate, TrackTable};
//! use tracking::{AssociationConfig, MotionConfig};
//!
//! let config = Config::new(MotionConfig::default(), AssociationConfig::default(), 0.5)?;
//! let mut table = TrackTable::new(config);
//! let frame = FramePose {
//!     capture_ns: 0,
//!     world_from_camera: RigidTransform::identity(),
//!     camera: None,
//! };
//! // Expected boxes of the tracks: a prior for detection.
//! let mut expected = Vec::new();
//! table.predict(&frame, &mut expected);
//! let detection = detection::Detection::default();
//!
//! let (mut ids, mut update) = (1_u64.., TrackUpdate::default());
//! table.step(&detection, &[], &frame, || ids.next(), &mut update);
//! assert!(update.sightings.is_empty() && table.tracks().is_empty());
//! # Ok::<(), pipeline::Error>(())
//! ```

mod candidate_measurement;
mod config;
mod error;
mod frame_pose;
mod key_view_selector;
mod lost_track_gallery;
mod object_state;
mod track;
mod track_recovery;
mod track_table;

pub use candidate_measurement::CandidateMeasurement;
pub use config::{Config, DESCRIPTOR_KIND, calibration, category_index};
pub use error::Error;
pub use frame_pose::FramePose;
pub use object_state::{
    ObjectState, ObjectWorkspace, Observation, ObservationOutput, ObservationStage, Posterior,
};
pub use track::Track;
pub use track_table::{Sighting, TrackTable, TrackUpdate};
