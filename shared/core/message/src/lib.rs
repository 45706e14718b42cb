//! Messages in shared memory: the types of every topic.
//!
//! They are `repr(C)` plain numbers. Any bit pattern is a
//! valid value of the type, so a torn or hostile message can never be undefined
//! behaviour; the values are validated on receipt (`checked`). Sizes are
//! asserted at compile time. Type names are explicit and carry the schema
//! version, so that different versions of tabula cannot be connected by accident.
//!
//! This crate does no I/O; only iceoryx2's marker trait is used here.
//!
//! # Example
//!
//! ```
//! use geometry::PinholeCamera;
//! use message::FrameHeader;
//!
//! let mut header = FrameHeader::default();
//! header.set_camera(&PinholeCamera::KINECT_V1);
//! // A receiver validates the header against the number of points and its clock before use.
//! let received_ns = 1_000_000;
//! let frame = header.checked(640 * 480, received_ns)?;
//! assert_eq!(frame.camera, PinholeCamera::KINECT_V1);
//! assert!(header.checked(17, received_ns).is_err());
//! # Ok::<(), message::InvalidFrame>(())
//! ```

mod actor_event;
mod camera_images;
pub mod document;
mod frame;
mod ground_truth;
mod health;
mod memory_change;
mod near_category;
mod object_view;
mod pose;
mod rejected_candidate;
mod robot;
mod scene;
mod scene_time;
mod sequenced_header;
pub mod service_name;
mod stage;
mod surface;
mod text;
mod trace;
mod view_plan;

pub use actor_event::{ActorEvent, ActorEventKind};
pub use camera_images::{CheckedImages, ImageHeader, InvalidImages, image_bytes};
pub use camera_images::{color_encoding, depth_encoding, image_flag};
pub use frame::{CheckedFrame, CloudPoint, FrameDone, FrameHeader, InvalidFrame, SegmentLocation};
pub use frame::{frame_flag, points, points_mut};
pub use ground_truth::{MAX_TRUE_OBJECTS, MaskPixel, TrueObject, TrueState, TruthHeader};
pub use health::{Health, ProcessState};
pub use memory_change::MemoryChange;
pub use near_category::{MAX_NEAR_CATEGORIES, NearCategory};
pub use object_view::{ObjectCloudHeader, ObjectViewHeader};
pub use pose::{WirePose, WireTransform, upper_triangle};
pub use process_registry::{Duty, ProcessKind};
pub use rejected_candidate::{MAX_REJECTED_CANDIDATES, RejectedCandidate, WireFinding};
pub use robot::{ArmActivity, ArmState, MAX_CAPSULES, PersonBody, WireCapsule};
pub use scene::{ActorStamps, MAX_SCENE_OBJECTS, SceneObject, SceneSummary, StageStamps};
pub use scene_document::{ARM_JOINTS, CategoryAnswer, TrackState};
pub use scene_time::SceneTime;
pub use sequenced_header::{PlainHeader, SequencedHeader};
pub use stage::{Stage, StageScope};
pub use surface::{MAX_SURFACE_CORNERS, MAX_SURFACES, SurfaceKind, WireSurface};
pub use text::Text;
pub use trace::{MAX_SPANS, Span, TraceHeader};
pub use view_plan::{CheckedView, MAX_PLANNED_VIEWS, PlannedView, ViewPlanHeader, ViewState};

/// Schema version of the types in this crate, written into their headers. A type's name in
/// shared memory carries the schema version in which the type last changed.
pub const SCHEMA_VERSION: u32 = 6;
