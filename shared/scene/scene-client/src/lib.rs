//! Snapshot of the table: one frame with its scene and the measured points of its objects, and
//! stored models placed in their poses.
//!
//! A [`SnapshotReceiver`] joins what a daemon publishes; a caller that has frames of its own, such
//! as an experiment, fills a [`Snapshot`] itself. A [`ModelShelf`] reads the models of the
//! categories that the objects may be from [`StoredModels`], those of a running daemon by
//! [`DaemonModels`], and [`hypotheses`] places them with the measured depth noise of the camera;
//! an object without a fitting model is its measured points.
//!
//! Invariants: this crate writes nothing, neither to the daemon nor to its memory, and the result
//! of a snapshot depends on the snapshot and the models alone.
//!
//! # Example
//!
//! ```
//! use geometry::{PinholeCamera, RigidTransform};
//! use message::TrackState;
//! use nalgebra::Point3;
//! use scene_client::{HypothesisSource, ModelShelf, Snapshot, SnapshotObject, hypotheses};
//!
//! // An unknown object of two points, a metre before the camera.
//! let mut snapshot = Snapshot::of_points(PinholeCamera::KINECT_V1, Vec::new());
//! snapshot.objects.push(SnapshotObject {
//!     track: 7,
//!     label: None,
//!     categories: Vec::new(),
//!     state: TrackState::Tracked,
//!     middle_in_world: Point3::new(0.0, 0.0, 1.0),
//!     points: vec![[-0.05, 0.0, 1.0], [0.05, 0.0, 1.0]],
//! });
//! let shelf = ModelShelf::default();
//! let found = hypotheses(&shelf, &snapshot, &RigidTransform::identity(), 0.003)?;
//! assert_eq!((found.len(), &found[0].source), (1, &HypothesisSource::Measured));
//! # Ok::<(), service::Failure>(())
//! ```

mod daemon_models;
mod depth_noise;
mod frame_headers;
mod model_shelf;
mod object_hypothesis;
mod planning_frame;
mod scene_table;
mod scene_topics;
mod snapshot;
mod snapshot_receiver;
mod stored_models;
mod visibility;

pub use daemon_models::DaemonModels;
pub use depth_noise::camera_depth_noise;
pub use model_shelf::{ModelShelf, PlacedModel};
pub use object_hypothesis::{HypothesisSource, ObjectHypothesis, hypotheses};
pub use planning_frame::PlanningFrame;
pub use scene_table::{SceneSurface, table_in_world};
pub use scene_topics::SceneTopics;
pub use snapshot::{Snapshot, SnapshotObject};
pub use snapshot_receiver::SnapshotReceiver;
pub use stored_models::StoredModels;
pub use visibility::{is_seen, is_seen_whole};
