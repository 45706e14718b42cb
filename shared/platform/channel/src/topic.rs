//! The services of a domain: types, limits and overflow policy in one place.

use bytemuck::AnyBitPattern;
use iceoryx2::prelude::ZeroCopySend;
use message::{
    ActorEvent, ArmState, CloudPoint, Counted, FrameDone, FrameHeader, Health, MAX_CAPSULES,
    MAX_SCENE_OBJECTS, MAX_SPANS, MAX_TRUE_OBJECTS, MaskPixel, MemoryChange, ObjectCloudHeader,
    ObjectViewHeader, PersonBody, PlainHeader, SceneObject, SceneSummary, Span, TraceHeader,
    TrueObject, TruthHeader, WireCapsule, service_name,
};
use std::fmt::Debug;

/// Points of the largest frame.
pub const MAX_FRAME_POINTS: usize = 640 * 480;

/// What happens when a subscriber's queue is full.
pub trait Overflow {
    /// Whether the oldest message makes room; otherwise sending fails.
    const DROPS_OLDEST: bool;
}

/// Sensor data and state: the oldest message makes room and is counted as lost
/// by the receiver.
#[derive(Debug)]
pub enum DropOldest {}

/// Reports that must arrive: the sender gets an error.
#[derive(Debug)]
pub enum Refuse {}

impl Overflow for DropOldest {
    const DROPS_OLDEST: bool = true;
}

impl Overflow for Refuse {
    const DROPS_OLDEST: bool = false;
}

/// Fixed numbers of a service; their product is the shared memory it reserves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Publishers at a time.
    pub publishers: usize,
    /// Subscribers at a time.
    pub subscribers: usize,
    /// Messages waiting at a subscriber.
    pub buffer: usize,
    /// Messages a subscriber may hold.
    pub borrowed: usize,
    /// Newest messages a new subscriber gets.
    pub history: usize,
    /// Messages a publisher may be filling.
    pub loaned: usize,
}

/// A publish-subscribe service: a header and a slice of items.
pub trait Topic: Debug + Send + Sync + 'static {
    /// Header beside the items.
    type Header: Debug + Copy + Default + Counted + AnyBitPattern + ZeroCopySend + Send + Sync;
    /// One item of the payload: plain numbers, any bit pattern valid.
    type Item: Debug + Copy + Default + AnyBitPattern + ZeroCopySend + Send + Sync;
    /// Overflow policy.
    type Overflow: Overflow;
    /// Name within the domain.
    const NAME: &'static str;
    /// Most items of a message.
    const MAX_ITEMS: usize;
    /// Limits.
    const LIMITS: Limits;
}

macro_rules! topics {
    ($($(#[$doc:meta])* $topic:ident { $name:ident, $header:ty, [$item:ty; $max:expr], $overflow:ty, $limits:expr })*) => {
        $($(#[$doc])*
        #[derive(Debug)]
        pub enum $topic {}

        impl Topic for $topic {
            type Header = $header;
            type Item = $item;
            type Overflow = $overflow;
            const NAME: &'static str = service_name::$name;
            const MAX_ITEMS: usize = $max;
            const LIMITS: Limits = $limits;
        })*

        /// Slots and bytes of each topic's publishers, for the sum of the domain.
        pub(crate) fn reservations() -> Vec<crate::Reservation> {
            vec![$(crate::Reservation::of_topic::<$topic>()),*]
        }
    };
}

/// Many small subscribers; one queued state is enough for those that poll.
const STATE: Limits = Limits {
    publishers: 1,
    subscribers: 8,
    buffer: 2,
    borrowed: 2,
    history: 1,
    loaned: 2,
};

topics! {
    /// Clouds of the camera. A subscriber may hold one frame for each worker and
    /// two more, because one that holds all it may borrow receives no more.
    CameraCloud { CAMERA_CLOUD, FrameHeader, [CloudPoint; MAX_FRAME_POINTS], DropOldest,
        Limits { publishers: 1, subscribers: 3, buffer: 2, borrowed: 6, history: 0, loaned: 2 } }
    /// Finished frames of a lockstep source.
    FrameFinished { FRAME_DONE, PlainHeader, [FrameDone; 1], Refuse,
        Limits { publishers: 4, subscribers: 2, buffer: 8, borrowed: 2, history: 0, loaned: 2 } }
    /// The live world model.
    Scene { SCENE, SceneSummary, [SceneObject; MAX_SCENE_OBJECTS], DropOldest, STATE }
    /// Described views.
    ObjectView { OBJECT_VIEW, ObjectViewHeader, [f32; 1024], DropOldest,
        Limits { publishers: 1, subscribers: 4, buffer: 64, borrowed: 2, history: 0, loaned: 2 } }
    /// Clouds of single objects.
    ObjectCloud { OBJECT_CLOUD, ObjectCloudHeader, [CloudPoint; 65_536], DropOldest,
        Limits { publishers: 1, subscribers: 2, buffer: 8, borrowed: 2, history: 0, loaned: 2 } }
    /// What happens to the object actors. Who comes late gets the newest ones.
    ActorEvents { ACTOR_EVENT, PlainHeader, [ActorEvent; 1], DropOldest,
        Limits { publishers: 1, subscribers: 4, buffer: 64, borrowed: 2, history: 16, loaned: 2 } }
    /// The arm.
    ArmStates { ARM_STATE, ArmState, [WireCapsule; MAX_CAPSULES], DropOldest,
        Limits { publishers: 1, subscribers: 6, buffer: 8, borrowed: 2, history: 1, loaned: 2 } }
    /// The people around the table.
    PersonBodies { PERSON_BODY, PersonBody, [WireCapsule; MAX_CAPSULES], DropOldest, STATE }
    /// Objects of simulated frames.
    TrueObjects { TRUTH_OBJECTS, TruthHeader, [TrueObject; MAX_TRUE_OBJECTS], DropOldest,
        Limits { publishers: 1, subscribers: 4, buffer: 4, borrowed: 2, history: 1, loaned: 2 } }
    /// Masks of simulated frames.
    TrueMasks { TRUTH_MASK, TruthHeader, [MaskPixel; MAX_FRAME_POINTS], DropOldest,
        Limits { publishers: 1, subscribers: 2, buffer: 2, borrowed: 2, history: 0, loaned: 2 } }
    /// Growth of the memory's history.
    MemoryChanged { MEMORY_CHANGE, PlainHeader, [MemoryChange; 1], DropOldest, STATE }
    /// Where the time of frames goes. What nobody reads in time makes room and is
    /// counted: measuring never makes a frame wait.
    FrameTraces { TRACE, TraceHeader, [Span; MAX_SPANS], DropOldest,
        Limits { publishers: 4, subscribers: 2, buffer: 24, borrowed: 2, history: 0, loaned: 2 } }
    /// Health of all processes.
    ProcessHealth { HEALTH, PlainHeader, [Health; 1], DropOldest,
        Limits { publishers: 12, subscribers: 6, buffer: 16, borrowed: 2, history: 1, loaned: 2 } }
}
