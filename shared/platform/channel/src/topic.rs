//! Topics of a domain: types, limits and overflow policies in one place.

use crate::reservation::{Reservation, SLOT_OVERHEAD_BYTES};
use bytemuck::AnyBitPattern;
use iceoryx2::prelude::ZeroCopySend;
use message::{
    ActorEvent, ArmState, CloudPoint, FrameDone, FrameHeader, Health, ImageHeader, MAX_CAPSULES,
    MAX_PLANNED_VIEWS, MAX_SCENE_OBJECTS, MAX_SPANS, MAX_TRUE_OBJECTS, MaskPixel, MemoryChange,
    ObjectCloudHeader, ObjectViewHeader, PersonBody, PlainHeader, PlannedView, SceneObject,
    SceneSummary, SequencedHeader, Span, TraceHeader, TrueObject, TruthHeader, ViewPlanHeader,
    WireCapsule, image_bytes, service_name,
};
use std::fmt::Debug;

/// Number of points of a frame for which every domain has room: those of a Kinect. A source of
/// larger frames reserves more, see [`Publisher::for_items`](crate::Publisher::for_items).
pub const MAX_FRAME_POINTS: usize = 640 * 480;

/// Overflow policy: the treatment of a message for a full subscriber queue.
pub trait Overflow {
    /// `true` when the oldest message makes room; otherwise sending fails.
    const DROPS_OLDEST: bool;
}

/// Drop-oldest policy for sensor data and state: the oldest message makes room and
/// the receiver counts it as lost.
#[derive(Debug)]
pub enum DropOldest {}

/// Refusal policy for reports that must arrive: the sender gets an error.
#[derive(Debug)]
pub enum Refuse {}

impl Overflow for DropOldest {
    const DROPS_OLDEST: bool = true;
}

impl Overflow for Refuse {
    const DROPS_OLDEST: bool = false;
}

/// Limits of a service; they determine the shared memory that it reserves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Largest number of publishers of the topic.
    pub publishers: usize,
    /// Largest number of subscribers of the topic beside its guests.
    pub subscribers: usize,
    /// Queue length of each subscriber, messages.
    pub buffer: usize,
    /// Largest number of messages that a subscriber holds.
    pub borrowed: usize,
    /// Newest messages delivered to a new subscriber (history).
    pub history: usize,
    /// Largest number of unsent loans of a publisher.
    pub loaned: usize,
    /// Queue and borrow limit of a guest; `None` when all subscribers are alike.
    pub guest: Option<GuestLimits>,
}

/// Limits of a guest: one of the domain's [places](crate::Domain::guest_places) of a topic with large
/// messages, of which a publisher keeps as few as it can.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GuestLimits {
    /// Queue length of the guest, messages.
    pub buffer: usize,
    /// Largest number of messages that the guest holds.
    pub borrowed: usize,
}

impl Limits {
    /// Largest number of subscribers of all kinds.
    pub(crate) fn all_subscribers(&self, guest_places: u32) -> usize {
        self.subscribers + self.guest.map_or(0, |_| guest_places as usize)
    }

    /// Message slots of one publisher: one for each message that can wait at or be held by a
    /// subscriber, for its history and its loans.
    pub(crate) fn slots(&self, guest_places: u32) -> usize {
        let of_guest = self.guest.map_or(0, |guest| guest.buffer + guest.borrowed);
        self.subscribers * (self.buffer + self.borrowed)
            + guest_places as usize * of_guest
            + self.history
            + self.loaned
    }
}

/// Publish-subscribe topic: a header and a slice of items.
pub trait Topic: Debug + Send + Sync + 'static {
    /// Header type of the topic's messages.
    type Header: Debug
        + Copy
        + Default
        + SequencedHeader
        + AnyBitPattern
        + ZeroCopySend
        + Send
        + Sync;
    /// Item of the payload: plain numbers, any bit pattern valid.
    type Item: Debug + Copy + Default + AnyBitPattern + ZeroCopySend + Send + Sync;
    /// Overflow policy of the topic's queues.
    type Overflow: Overflow;
    /// Name of the topic's service within the domain.
    const NAME: &'static str;
    /// Largest number of items of a message, unless its publisher reserves more.
    const MAX_ITEMS: usize;
    /// Limits of the topic's service.
    const LIMITS: Limits;
}

/// Reservation of a topic's publishers for messages of at most `max_items`, in a domain with so
/// many guest places.
pub(crate) fn reservation<T: Topic>(max_items: usize, guest_places: u32) -> Reservation {
    let limits = T::LIMITS;
    let slots = limits.slots(guest_places);
    let bytes = size_of::<T::Header>() + max_items * size_of::<T::Item>();
    Reservation {
        service: T::NAME,
        slots: (slots * limits.publishers) as u64,
        slot_bytes: bytes as u64 + SLOT_OVERHEAD_BYTES,
    }
}

/// Largest number of items of a topic's messages when frames have so many points.
fn items_of_frame<T: Topic>(frame_points: usize) -> usize {
    let of_frame = match T::NAME {
        service_name::CAMERA_CLOUD | service_name::TRUTH_MASK => frame_points,
        service_name::CAMERA_IMAGE => image_bytes(frame_points),
        _ => 0,
    };
    T::MAX_ITEMS.max(of_frame)
}

/// Number of points of frames for which messages of a topic have so many items: more than
/// [`MAX_FRAME_POINTS`] for clouds of a larger camera.
pub(crate) fn frame_points<T: Topic>(max_items: usize) -> usize {
    match T::NAME {
        service_name::CAMERA_CLOUD | service_name::TRUTH_MASK => max_items.max(MAX_FRAME_POINTS),
        _ => MAX_FRAME_POINTS,
    }
}

/// Limits of guests that read frames: the newest one waits while two are held.
const FRAME_GUEST: Option<GuestLimits> = Some(GuestLimits {
    buffer: 1,
    borrowed: 2,
});

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

        /// Shared-memory reservations of all topics' publishers, for frames of so many points.
        pub(crate) fn reservations(frame_points: usize, guest_places: u32) -> Vec<Reservation> {
            vec![$(reservation::<$topic>(items_of_frame::<$topic>(frame_points), guest_places)),*]
        }
    };
}

/// Limits of state topics: many small subscribers; one queued state is enough for
/// those that poll.
const STATE: Limits = Limits {
    publishers: 1,
    subscribers: 8,
    buffer: 2,
    borrowed: 2,
    history: 1,
    loaned: 2,
    guest: None,
};

topics! {
    /// Point clouds of the camera. Perception may hold one frame for each worker
    /// and two more, because a subscriber at its borrow limit receives no more.
    CameraCloud { CAMERA_CLOUD, FrameHeader, [CloudPoint; MAX_FRAME_POINTS], DropOldest,
        Limits { publishers: 1, subscribers: 1, buffer: 2, borrowed: 6, history: 0, loaned: 2, guest: FRAME_GUEST } }
    /// Raw images of the camera. Nothing is written without a subscriber.
    CameraImages { CAMERA_IMAGE, ImageHeader, [u8; image_bytes(MAX_FRAME_POINTS)], DropOldest,
        Limits { publishers: 1, subscribers: 0, buffer: 1, borrowed: 2, history: 0, loaned: 1, guest: FRAME_GUEST } }
    /// Reports of finished frames to a lockstep source.
    FinishedFrames { FRAME_DONE, PlainHeader, [FrameDone; 1], Refuse,
        Limits { publishers: 6, subscribers: 6, buffer: 8, borrowed: 2, history: 0, loaned: 2, guest: None } }
    /// Topic of live scenes: the tracked objects.
    Scene { SCENE, SceneSummary, [SceneObject; MAX_SCENE_OBJECTS], DropOldest, STATE }
    /// Described views of objects.
    ObjectView { OBJECT_VIEW, ObjectViewHeader, [f32; 1024], DropOldest,
        Limits { publishers: 1, subscribers: 4, buffer: 64, borrowed: 2, history: 0, loaned: 2, guest: None } }
    /// Topic of point clouds of single objects.
    ObjectCloud { OBJECT_CLOUD, ObjectCloudHeader, [CloudPoint; 65_536], DropOldest,
        Limits { publishers: 1, subscribers: 0, buffer: 8, borrowed: 2, history: 0, loaned: 2,
            guest: Some(GuestLimits { buffer: 8, borrowed: 2 }) } }
    /// Topic of the plans of the next best view. A new subscriber gets the newest one of each
    /// planner that is still running.
    ViewPlans { VIEW_PLAN, ViewPlanHeader, [PlannedView; MAX_PLANNED_VIEWS], DropOldest,
        Limits { publishers: 2, subscribers: 4, buffer: 2, borrowed: 2, history: 1, loaned: 1, guest: None } }
    /// Life-cycle events of the object actors. A new subscriber gets the newest ones.
    ActorEvents { ACTOR_EVENT, PlainHeader, [ActorEvent; 1], DropOldest,
        Limits { publishers: 1, subscribers: 4, buffer: 64, borrowed: 2, history: 16, loaned: 2, guest: None } }
    /// Topic of the robot arm's state.
    ArmStates { ARM_STATE, ArmState, [WireCapsule; MAX_CAPSULES], DropOldest,
        Limits { publishers: 1, subscribers: 6, buffer: 8, borrowed: 2, history: 1, loaned: 2, guest: None } }
    /// Topic of the bodies of people around the table, as capsules.
    PersonBodies { PERSON_BODY, PersonBody, [WireCapsule; MAX_CAPSULES], DropOldest, STATE }
    /// Topic of the ground-truth objects of simulated frames.
    TrueObjects { TRUTH_OBJECTS, TruthHeader, [TrueObject; MAX_TRUE_OBJECTS], DropOldest,
        Limits { publishers: 1, subscribers: 4, buffer: 4, borrowed: 2, history: 1, loaned: 2, guest: None } }
    /// Topic of the ground-truth masks of simulated frames.
    TrueMasks { TRUTH_MASK, TruthHeader, [MaskPixel; MAX_FRAME_POINTS], DropOldest,
        Limits { publishers: 1, subscribers: 2, buffer: 2, borrowed: 2, history: 0, loaned: 2, guest: None } }
    /// Topic that announces changes of the memory.
    MemoryChanged { MEMORY_CHANGE, PlainHeader, [MemoryChange; 1], DropOldest, STATE }
    /// Latency traces of frames. Unread traces make room and are counted: measuring
    /// never delays a frame.
    FrameTraces { TRACE, TraceHeader, [Span; MAX_SPANS], DropOldest,
        Limits { publishers: 4, subscribers: 2, buffer: 24, borrowed: 2, history: 0, loaned: 2, guest: None } }
    /// Topic of health reports of all processes.
    ProcessHealth { HEALTH, PlainHeader, [Health; 1], DropOldest,
        Limits { publishers: 12, subscribers: 6, buffer: 16, borrowed: 2, history: 1, loaned: 2, guest: None } }
}
