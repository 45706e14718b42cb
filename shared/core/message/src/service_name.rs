//! Topic names: iceoryx2 service names within one domain.

/// Organised clouds of the camera: [`FrameHeader`](crate::FrameHeader) and points.
pub const CAMERA_CLOUD: &str = "camera/cloud";
/// Raw images of the camera, sent only while a subscriber exists:
/// [`ImageHeader`](crate::ImageHeader) and bytes.
pub const CAMERA_IMAGE: &str = "camera/image";
/// Lockstep acknowledgements of the followers: [`FrameDone`](crate::FrameDone).
pub const FRAME_DONE: &str = "frame/done";
/// Tracked objects after each frame: [`SceneSummary`](crate::SceneSummary).
pub const SCENE: &str = "scene";
/// Described views of objects: [`ObjectViewHeader`](crate::ObjectViewHeader) and the
/// descriptor.
pub const OBJECT_VIEW: &str = "object/view";
/// Point clouds of objects, sent only while a subscriber exists:
/// [`ObjectCloudHeader`](crate::ObjectCloudHeader) and points.
pub const OBJECT_CLOUD: &str = "object/cloud";
/// Plans of the next best view, sent by each `tabula view plan`:
/// [`ViewPlanHeader`](crate::ViewPlanHeader) and [`PlannedView`](crate::PlannedView)s.
pub const VIEW_PLAN: &str = "view/plan";
/// Life-cycle events of the object actors: [`ActorEvent`](crate::ActorEvent).
pub const ACTOR_EVENT: &str = "actor/event";
/// Change notifications of the memory: [`MemoryChange`](crate::MemoryChange).
pub const MEMORY_CHANGE: &str = "memory/change";
/// Health reports of the processes: [`Health`](crate::Health).
pub const HEALTH: &str = "health";
/// Latency traces of frames: [`TraceHeader`](crate::TraceHeader) and [`Span`](crate::Span)s.
pub const TRACE: &str = "trace";
/// State of the arm: [`ArmState`](crate::ArmState) and the capsules of its links.
pub const ARM_STATE: &str = "arm/state";
/// Volumes occupied by people: [`PersonBody`](crate::PersonBody) and capsules.
pub const PERSON_BODY: &str = "person/body";
/// Ground-truth objects of simulated frames: [`TruthHeader`](crate::TruthHeader) and
/// [`TrueObject`](crate::TrueObject)s.
pub const TRUTH_OBJECTS: &str = "truth/objects";
/// Ground-truth instance masks of simulated frames: [`TruthHeader`](crate::TruthHeader) and
/// [`MaskPixel`](crate::MaskPixel)s.
pub const TRUTH_MASK: &str = "truth/mask";
