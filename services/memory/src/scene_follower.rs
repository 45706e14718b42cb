//! Following the scenes: a lockstep source waits for the memory, too.

use channel::topic::{FrameFinished, Scene};
use channel::{Domain, Error, Publisher, Received, Subscriber};
use message::{FrameDone, PlainHeader, ProcessKind, SceneSummary, frame_flag};
use service::HealthBoard;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// Sees every scene and reports it finished where the source waits.
pub(crate) struct SceneFollower {
    scenes: Subscriber<Scene>,
    finished: Publisher<FrameFinished>,
    health: Arc<HealthBoard>,
}

impl SceneFollower {
    pub(crate) fn new(domain: &Domain, health: Arc<HealthBoard>) -> Result<Self, Error> {
        Ok(Self {
            scenes: Subscriber::waiting(domain)?,
            finished: Publisher::new(domain)?,
            health,
        })
    }

    /// Shared memory of the publisher.
    pub(crate) fn reserved_bytes(&self) -> u64 {
        self.finished.reservation().bytes()
    }

    pub(crate) async fn run(mut self) {
        loop {
            self.scenes.woken().await;
            if let Err(error) = self.take_all() {
                tracing::warn!("a scene was not followed: {error}");
            }
        }
    }

    fn take_all(&mut self) -> Result<(), Error> {
        while let Received::Message(scene) = self.scenes.receive()? {
            self.health.frames.fetch_add(1, Ordering::Relaxed);
            self.health
                .frames_dropped
                .store(self.scenes.n_lost(), Ordering::Relaxed);
            let scene: &SceneSummary = scene.header();
            if scene.frame_flags & frame_flag::LOCKSTEP != 0 {
                self.report(scene)?;
            }
        }
        Ok(())
    }

    fn report(&mut self, scene: &SceneSummary) -> Result<(), Error> {
        let done = FrameDone {
            session: scene.session,
            sequence: scene.sequence,
            process: u64::from(ProcessKind::Memory.code()),
        };
        self.finished.send_copy(PlainHeader::default(), &[done])
    }
}
