//! Receiver of all recorded topics by polling, which costs the daemon no wake-up.

use crate::message_queue::MessageQueue;
use crate::queued_message::{Content, QueuedMessage};
use channel::topic::{
    ActorEvents, ArmStates, CameraCloud, MemoryChanged, ObjectView, PersonBodies, ProcessHealth,
    Scene,
};
use channel::{Domain, Error, Subscriber};
use service::wall_clock_ns;

/// Subscribers of all recorded topics.
pub(crate) struct TopicReceiver {
    clouds: Subscriber<CameraCloud>,
    arm: Subscriber<ArmStates>,
    people: Subscriber<PersonBodies>,
    scenes: Subscriber<Scene>,
    views: Subscriber<ObjectView>,
    actors: Subscriber<ActorEvents>,
    memory: Subscriber<MemoryChanged>,
    health: Subscriber<ProcessHealth>,
    /// True after the first frame, which is left out: a publisher connects a new subscriber when
    /// it sends, so that the states before that frame may not have come.
    has_begun: bool,
}

impl TopicReceiver {
    pub(crate) fn new(domain: &Domain) -> Result<Self, Error> {
        Ok(Self {
            arm: Subscriber::polled(domain)?,
            people: Subscriber::polled(domain)?,
            scenes: Subscriber::polled(domain)?,
            views: Subscriber::polled(domain)?,
            actors: Subscriber::polled(domain)?,
            memory: Subscriber::polled(domain)?,
            health: Subscriber::polled(domain)?,
            clouds: Subscriber::polled(domain)?,
            has_begun: false,
        })
    }

    /// Moves all waiting messages into the queue. Clouds are taken first and queued last: a source
    /// publishes the states of arm and people before the frame that they belong to.
    pub(crate) fn receive(&mut self, queue: &MessageQueue) -> Result<(), Error> {
        let mut clouds = Vec::new();
        self.clouds.take_all(|cloud| {
            clouds.push(queued(Content::Frame(Box::new(cloud))));
        })?;
        if !self.has_begun && !clouds.is_empty() {
            self.has_begun = true;
            clouds.remove(0);
        }
        let push = |content| queue.push(queued(content));
        self.arm.take_all(|state| {
            push(Content::Arm(
                Box::new(*state.header()),
                state.items().to_vec(),
            ));
        })?;
        self.people.take_all(|body| {
            push(Content::Person(*body.header(), body.items().to_vec()));
        })?;
        self.scenes.take_all(|scene| {
            push(Content::Scene(
                Box::new(*scene.header()),
                scene.items().to_vec(),
            ));
        })?;
        self.views.take_all(|view| {
            push(Content::View(
                Box::new(*view.header()),
                view.items().to_vec(),
            ));
        })?;
        self.actors.take_all(|events| {
            events
                .items()
                .iter()
                .for_each(|event| push(Content::Actor(Box::new(*event))));
        })?;
        self.memory.take_all(|changes| {
            changes
                .items()
                .iter()
                .for_each(|change| push(Content::Memory(*change)));
        })?;
        self.health.take_all(|reports| {
            reports
                .items()
                .iter()
                .for_each(|health| push(Content::Health(Box::new(*health))));
        })?;
        for cloud in clouds {
            queue.push(cloud);
        }
        Ok(())
    }

    /// Number of frames that were overwritten before they were received.
    pub(crate) fn n_frames_lost(&self) -> u64 {
        self.clouds.n_lost()
    }

    /// Number of other messages that were overwritten before they were received.
    pub(crate) fn n_others_lost(&self) -> u64 {
        self.arm.n_lost()
            + self.people.n_lost()
            + self.scenes.n_lost()
            + self.views.n_lost()
            + self.actors.n_lost()
            + self.memory.n_lost()
            + self.health.n_lost()
    }
}

fn queued(content: Content) -> QueuedMessage {
    QueuedMessage {
        received_ns: wall_clock_ns().unsigned_abs(),
        content,
    }
}
