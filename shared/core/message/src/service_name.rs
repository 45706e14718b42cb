//! The names of the services of one domain.

/// Organised clouds from the camera: [`FrameHeader`](crate::FrameHeader) and points.
pub const CAMERA_CLOUD: &str = "camera/cloud";
/// Reports of the followers of a lockstep source: [`FrameDone`](crate::FrameDone).
pub const FRAME_DONE: &str = "frame/done";
/// The live world model: [`SceneSummary`](crate::SceneSummary).
pub const SCENE: &str = "scene";
/// One described view of one object: [`ObjectViewHeader`](crate::ObjectViewHeader)
/// and the descriptor.
pub const OBJECT_VIEW: &str = "object/view";
/// The points of one object, only while someone subscribes:
/// [`ObjectCloudHeader`](crate::ObjectCloudHeader) and points.
pub const OBJECT_CLOUD: &str = "object/cloud";
/// What happens to the object actors: [`ActorEvent`](crate::ActorEvent).
pub const ACTOR_EVENT: &str = "actor/event";
/// New history sequences of the memory: [`MemoryChange`](crate::MemoryChange).
pub const MEMORY_CHANGE: &str = "memory/change";
/// State and counters of each process: [`Health`](crate::Health).
pub const HEALTH: &str = "health";
/// Where the time of frames goes: [`TraceHeader`](crate::TraceHeader) and
/// [`Span`](crate::Span)s.
pub const TRACE: &str = "trace";
/// State of the arm: [`ArmState`](crate::ArmState) and the capsules of its links.
pub const ARM_STATE: &str = "arm/state";
/// Where people are: [`PersonBody`](crate::PersonBody) and the capsules of their bodies.
pub const PERSON_BODY: &str = "person/body";
/// Ground truth of simulated frames: [`TruthHeader`](crate::TruthHeader) and
/// [`TrueObject`](crate::TrueObject)s.
pub const TRUTH_OBJECTS: &str = "truth/objects";
/// Ground truth of simulated frames: [`TruthHeader`](crate::TruthHeader) and the
/// object of each pixel.
pub const TRUTH_MASK: &str = "truth/mask";
/// Requests to the memory process.
pub const CONTROL_MEMORY: &str = "control/memory";
/// Requests to the perception process.
pub const CONTROL_PERCEPTION: &str = "control/perception";
/// Commands to the arm, in whichever process moves it.
pub const CONTROL_ARM: &str = "arm/command";
