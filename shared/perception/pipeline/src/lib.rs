//! Per-frame perception pipeline: data association, tracking, description and
//! recognition as pure functions over explicit state.
//!
//! [`FramePipeline`] runs a frame through its stages: predict, detect, associate,
//! observe, apply. Detection and the observation of objects are carried out by a
//! [`FrameExecutor`]: the daemon's uses a worker pool and actors, [`SequentialExecutor`]
//! the calling thread.
//!
//! - [`TrackTable`] predicts the tracks, associates the candidates of a
//!   [`detection::Detection`] with them, starts tracks and ends them.
//! - [`ObjectState::observe`] processes one object's measurement: motion filter,
//!   descriptor, recognition and key-view selection. Its [`Posterior`] is applied to the
//!   object's track.
//!
//! Invariants: this crate never reads a clock, draws no random numbers, does no I/O, and
//! knows nothing of threads, actors or messages.
//!
//! # Example
//!
//! ```
//! use geometry::RigidTransform;
//! use pipeline::{Config, FramePipeline, FramePose, SequentialFrame, SequentialState};
//! use point_cloud::{OrganizedCloud, Point};
//! use tracking::{AssociationConfig, MotionConfig};
//!
//! let config = Config::new(MotionConfig::default(), AssociationConfig::default(), 0.5)?;
//! let mut state = SequentialState::new(detection::Config::default(), config)?;
//! let mut pipeline = FramePipeline::new(config);
//! let points = vec![Point::default(); 4];
//! let frame = SequentialFrame {
//!     pose: FramePose {
//!         capture_ns: 0,
//!         world_from_camera: RigidTransform::identity(),
//!         up_in_camera: None,
//!         camera: None,
//!     },
//!     cloud: OrganizedCloud::new(&points, 2, 2)?,
//!     people: None,
//!     robot: None,
//! };
//! state.process(&mut pipeline, &frame)?;
//! assert!(pipeline.tracks().is_empty());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod candidate_measurement;
mod config;
mod depth_noise_estimate;
mod duplicate_tracks;
mod error;
mod frame_pipeline;
mod frame_pose;
mod key_view_selector;
mod lesson_feedback;
mod light_estimate;
mod lost_track_gallery;
mod object_state;
mod scene_motion;
mod sequential_executor;
mod shared_shift;
mod sighting_evidence;
mod stored_view;
mod surface_memory;
mod table_height;
mod track;
mod track_initiation;
mod track_recovery;
mod track_table;

pub use candidate_measurement::CandidateMeasurement;
pub use config::{Config, calibration, category_index};
pub use error::Error;
pub use frame_pipeline::{FrameExecutor, FramePipeline, FrameStage, ObservedTracks};
pub use frame_pose::FramePose;
pub use lesson_feedback::LessonFeedback;
pub use object_state::{
    ObjectState, ObjectWorkspace, Observation, ObservationOutput, ObservationStage, Posterior,
};
pub use sequential_executor::{SequentialExecutor, SequentialFrame, SequentialState};
pub use stored_view::StoredViewDescriber;
pub use track::Track;
pub use track_table::{Sighting, TrackTable, TrackUpdate};
