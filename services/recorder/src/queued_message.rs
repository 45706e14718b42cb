//! Received message on its way to the file.

use channel::SharedMessage;
use channel::topic::CameraCloud;
use message::service_name::{
    ACTOR_EVENT, ARM_STATE, HEALTH, MEMORY_CHANGE, OBJECT_VIEW, PERSON_BODY, SCENE,
};
use message::{
    ActorEvent, ArmState, Health, MemoryChange, ObjectViewHeader, PersonBody, SceneObject,
    SceneSummary, WireCapsule, document,
};
use recording::documents::{
    ActorEventDocument, ArmDocument, MemoryChangeDocument, ObjectViewDocument, PersonDocument,
};
use recording::{ChannelSpec, Error, MessageTime, RecordingWriter, frame_channel};
use scene_document::{HealthDocument, SceneDocument};
use std::io::Write;

/// Message with the time of its reception, wall clock, nanoseconds.
#[derive(Debug)]
pub(crate) struct QueuedMessage {
    pub(crate) received_ns: u64,
    pub(crate) content: Content,
}

/// Content of a received message. Frames stay in shared memory; the others are copies.
#[derive(Debug)]
pub(crate) enum Content {
    Frame(Box<SharedMessage<CameraCloud>>),
    Arm(Box<ArmState>, Vec<WireCapsule>),
    Person(PersonBody, Vec<WireCapsule>),
    Scene(Box<SceneSummary>, Vec<SceneObject>),
    View(Box<ObjectViewHeader>, Vec<f32>),
    Actor(Box<ActorEvent>),
    Memory(MemoryChange),
    Health(Box<Health>),
}

/// Channels of all topics that are recorded. They are written first, so that every later chunk
/// can be read.
pub(crate) fn channels() -> Vec<ChannelSpec> {
    vec![
        frame_channel(),
        ChannelSpec::json::<ArmDocument>(ARM_STATE),
        ChannelSpec::json::<PersonDocument>(PERSON_BODY),
        ChannelSpec::json::<SceneDocument>(SCENE),
        ChannelSpec::json::<ObjectViewDocument>(OBJECT_VIEW),
        ChannelSpec::json::<ActorEventDocument>(ACTOR_EVENT),
        ChannelSpec::json::<MemoryChangeDocument>(MEMORY_CHANGE),
        ChannelSpec::json::<HealthDocument>(HEALTH),
    ]
}

impl QueuedMessage {
    /// True for a frame, which holds shared memory.
    pub(crate) fn is_frame(&self) -> bool {
        matches!(self.content, Content::Frame(_))
    }
}

/// Writes a message other than a frame as a document.
pub(crate) fn write_document<W: Write>(
    writer: &mut RecordingWriter<W>,
    time: MessageTime,
    content: &Content,
) -> Result<(), Error> {
    match content {
        Content::Frame(_) => Ok(()),
        Content::Arm(state, capsules) => {
            writer.write_document(ARM_STATE, time, &ArmDocument::new(state, capsules))
        }
        Content::Person(body, capsules) => {
            writer.write_document(PERSON_BODY, time, &PersonDocument::new(body, capsules))
        }
        Content::Scene(scene, objects) => writer.write_document(
            SCENE,
            time,
            &document::scene(scene, objects, scene.stamps.published_ns),
        ),
        Content::View(view, descriptor) => {
            let document = ObjectViewDocument::new(view, descriptor);
            writer.write_document(OBJECT_VIEW, time, &document)
        }
        Content::Actor(event) => {
            writer.write_document(ACTOR_EVENT, time, &ActorEventDocument::from(&**event))
        }
        Content::Memory(change) => {
            let document = MemoryChangeDocument::from(change);
            writer.write_document(MEMORY_CHANGE, time, &document)
        }
        Content::Health(health) => document::health(health).map_or(Ok(()), |health| {
            writer.write_document(HEALTH, time, &health)
        }),
    }
}
