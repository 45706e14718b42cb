//! What crosses a process border: data-plane and control-plane types.
//!
//! *Data plane*: `repr(C)` plain numbers in shared memory. Any bit pattern is a
//! valid value of the type, so a torn or hostile message can never be undefined
//! behaviour; what the numbers mean is checked on receipt (`checked`). Sizes are
//! asserted at compile time, type names are explicit and carry the schema
//! version, so that two versions of tabula refuse each other loudly.
//!
//! *Control plane*: serde types with a protocol version, see [`control`].
//!
//! This crate does no I/O; only iceoryx2's marker trait is used here.

mod actor_event;
pub mod control;
mod counted;
mod frame;
mod health;
mod ignored;
mod memory_change;
mod near_category;
mod object;
mod pose;
mod robot;
mod scene;
pub mod service_name;
mod stage;
mod text;
mod trace;
mod truth;

pub use actor_event::{ActorEvent, ActorEventKind};
pub use counted::{Counted, PlainHeader};
pub use frame::{CheckedFrame, CloudPoint, FrameDone, FrameHeader, InvalidFrame, SegmentLocation};
pub use frame::{frame_flag, points, points_mut};
pub use health::{Health, ProcessKind, ProcessState};
pub use ignored::{IgnoredBlob, MAX_IGNORED, WireFinding};
pub use memory_change::MemoryChange;
pub use near_category::{MAX_NEAR_CATEGORIES, NearCategory};
pub use object::{ObjectCloudHeader, ObjectViewHeader};
pub use pose::{WirePose, WireTransform, symmetric};
pub use robot::{ARM_JOINTS, ArmActivity, ArmState, MAX_CAPSULES, PersonBody, WireCapsule};
pub use scene::{
    ActorStamps, MAX_SCENE_OBJECTS, SceneObject, SceneSummary, StageStamps, TrackState,
};
pub use stage::{Place, Stage};
pub use text::Text;
pub use trace::{MAX_SPANS, Span, TraceHeader};
pub use truth::{MAX_TRUE_OBJECTS, MaskPixel, TrueObject, TrueState, TruthHeader};

/// Version of the types in this crate, written into their headers. A type's name
/// in shared memory carries the version in which the type last changed.
pub const SCHEMA_VERSION: u32 = 5;
