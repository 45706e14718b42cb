//! Subscription of the topics of a scene: frames, scenes, and the clouds of objects.

use crate::frame_headers::FrameHeaders;
use channel::topic::{CameraCloud, ObjectCloud, Scene};
use channel::{Domain, Error, SharedMessage, Subscriber};
use message::FrameHeader;

/// Polled subscribers of the topics of a scene, one of each for a process. While they exist,
/// perception publishes the points of all objects.
pub struct SceneTopics {
    frames: Subscriber<CameraCloud>,
    clouds: Subscriber<ObjectCloud>,
    scenes: Subscriber<Scene>,
    headers: FrameHeaders,
}

impl SceneTopics {
    /// Joins the topics.
    ///
    /// # Errors
    /// When a topic has no room for another subscriber, or shared memory fails.
    pub fn join(domain: &Domain) -> Result<Self, Error> {
        Ok(Self {
            frames: Subscriber::polled(domain)?,
            clouds: Subscriber::polled(domain)?,
            scenes: Subscriber::polled(domain)?,
            headers: FrameHeaders::default(),
        })
    }

    /// Takes all queued frames, and keeps their headers.
    ///
    /// # Errors
    /// When shared memory fails.
    pub fn take_frames(
        &mut self,
        mut take: impl FnMut(SharedMessage<CameraCloud>),
    ) -> Result<(), Error> {
        let headers = &mut self.headers;
        self.frames.take_all(|frame| {
            headers.push(frame.header(), frame.items().len());
            take(frame);
        })
    }

    /// Takes all queued clouds of objects.
    ///
    /// # Errors
    /// When shared memory fails.
    pub fn take_clouds(
        &mut self,
        take: impl FnMut(SharedMessage<ObjectCloud>),
    ) -> Result<(), Error> {
        self.clouds.take_all(take)
    }

    /// Takes all queued scenes.
    ///
    /// # Errors
    /// When shared memory fails.
    pub fn take_scenes(&mut self, take: impl FnMut(SharedMessage<Scene>)) -> Result<(), Error> {
        self.scenes.take_all(take)
    }

    /// Newest queued scene; `None` without one.
    ///
    /// # Errors
    /// When shared memory fails.
    pub fn newest_scene(&mut self) -> Result<Option<SharedMessage<Scene>>, Error> {
        self.scenes.latest()
    }

    /// Header of a frame and the number of its points; `None` if it is not known any more.
    pub fn header(&self, session: u64, sequence: u64) -> Option<&(FrameHeader, usize)> {
        self.headers.find(session, sequence)
    }
}
