//! Multi-object tracking: motion filter, data association, track lifecycle and key-view
//! selection.
//!
//! Every state is a plain value and every update a pure function, so that a copy of a
//! track's state is a checkpoint. Times are capture stamps in nanoseconds of a clock
//! that does not run backwards.
//!
//! Invariants: this crate never reads a clock, never does I/O, draws no random numbers
//! and assigns no track-ids. No input makes it panic or produce a number that is not
//! finite.
//!
//! # Example
//!
//! ```
//! use geometry::{OrientedBox, RigidTransform};
//! use nalgebra::Vector3;
//! use sensor_noise::DepthNoise;
//! use tracking::{HandContact, Measurement, MotionConfig, MotionFilter, ViewingConditions};
//!
//! let conditions = ViewingConditions {
//!     depth_m: 0.9,
//!     depth_noise: DepthNoise::KINECT_V1,
//!     ray_in_world: Vector3::y_axis(),
//!     variances_m2: Vector3::new(8e-4, 5e-4, 3e-3),
//!     stands_on_table: true,
//!     is_truncated: false,
//!     hand_contact: HandContact::None,
//! };
//! // An object that moves along x at 0.15 m/s.
//! let measured = |frame: u64| {
//!     let shape = OrientedBox {
//!         frame_from_box: RigidTransform::translation(0.005 * frame as f64, 0.0, 0.0),
//!         half_sides_m: Vector3::new(0.05, 0.04, 0.1),
//!     };
//!     Measurement::new(frame * 33_333_333, shape, conditions)
//! };
//! let config = MotionConfig::default();
//! let mut filter = MotionFilter::start(&measured(0)?, &config);
//! for frame in 1..60 {
//!     filter = filter.updated(&measured(frame)?, None, &config)?;
//! }
//! assert!((filter.velocity_m_s().x - 0.15).abs() < 0.02);
//! # Ok::<(), tracking::Error>(())
//! ```

mod assignment;
mod association;
mod axis_kalman;
mod depth_view;
mod error;
mod existence_test;
mod face_confidence;
mod key_view_rule;
mod measurement;
mod motion_config;
mod motion_filter;
mod observation_context;
mod orientation;
mod track_lifecycle;
mod viewing_conditions;
mod visibility;

pub use assignment::{AssignmentBuffers, assign};
pub use association::{
    AssociationBuffers, AssociationConfig, CoarseAppearance, ObservedCandidate, PredictedTrack,
    appearance_cost, associate, fraction_inside,
};
pub use depth_view::DepthView;
pub use error::Error;
pub use existence_test::{ArrivalPrior, Existence, ExistenceTest, SightingEvidence};
pub use key_view_rule::{KeyViewRule, MotionPhase};
pub use measurement::Measurement;
pub use motion_config::MotionConfig;
pub use motion_filter::MotionFilter;
pub use observation_context::ObservationContext;
pub use track_lifecycle::TrackLifecycle;
pub use viewing_conditions::{HandContact, ViewingConditions};
pub use visibility::{OcclusionState, Visibility};
