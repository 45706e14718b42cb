//! Scene follower: feeds scenes to the world model, and acknowledges lockstep frames.

use crate::config::Config;
use crate::world_model_updater::WorldModelUpdater;
use capture::{Follower, FrameFollower};
use channel::topic::Scene;
use channel::{Domain, Error, Received, Subscriber};
use message::{ProcessKind, SceneSummary, Span, Stage};
use service::{HealthCounters, LiveConfig, TracePublisher, monotonic_ns};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;
use tokio::time::{Interval, MissedTickBehavior};

/// Subscriber to scenes that acknowledges each frame of a lockstep source.
pub(crate) struct SceneFollower {
    scenes: Subscriber<Scene>,
    frames: FrameFollower,
    trace: TracePublisher,
    health: Arc<HealthCounters>,
    feed: WorldModelUpdater,
    live: LiveConfig<Config>,
}

impl SceneFollower {
    /// Scene follower that updates the world model once in the configured period.
    pub(crate) fn new(
        domain: &Domain,
        health: Arc<HealthCounters>,
        feed: WorldModelUpdater,
        live: LiveConfig<Config>,
    ) -> Result<Self, Error> {
        Ok(Self {
            scenes: Subscriber::waiting(domain)?,
            frames: FrameFollower::waiting(
                domain,
                Follower::Process(ProcessKind::MEMORY),
                &[ProcessKind::PERCEPTION],
            )?,
            trace: TracePublisher::new(domain, ProcessKind::MEMORY)?,
            health,
            feed,
            live,
        })
    }

    /// Shared memory reserved by the publishers, bytes.
    pub(crate) fn reserved_bytes(&self) -> u64 {
        self.frames.reserved_bytes() + self.trace.reserved_bytes()
    }

    pub(crate) async fn run(mut self) {
        let mut looks = interval(self.live.take().world_period);
        loop {
            let followed = tokio::select! {
                () = self.scenes.wake_event() => self.take_all(),
                () = self.frames.wake_event() => self.finish_frames(),
                _ = looks.tick() => self.feed.look(&mut self.trace),
                config = self.live.change() => {
                    looks = interval(config.world_period);
                    Ok(())
                }
            };
            if let Err(error) = followed {
                tracing::warn!("a scene was not followed: {error}");
            }
        }
    }

    /// Reports each frame that perception has finished, with its scene.
    fn finish_frames(&mut self) -> Result<(), Error> {
        while let Some(frame) = self.frames.next_frame()? {
            self.take_all()?;
            self.frames.report(frame)?;
        }
        Ok(())
    }

    fn take_all(&mut self) -> Result<(), Error> {
        while let Received::Message(scene) = self.scenes.receive()? {
            self.health.frames.fetch_add(1, Ordering::Relaxed);
            self.health
                .frames_dropped
                .store(self.scenes.n_lost(), Ordering::Relaxed);
            let header: &SceneSummary = scene.header();
            let published_ns = header.stamps.published_ns;
            let hop = Span::waiting(Stage::LabelHop, 0, published_ns, monotonic_ns());
            self.trace.send(header, &[hop]);
            self.feed.keep(scene);
        }
        Ok(())
    }
}

fn interval(period: Duration) -> Interval {
    let mut interval = tokio::time::interval(period);
    interval.set_missed_tick_behavior(MissedTickBehavior::Delay);
    interval
}
