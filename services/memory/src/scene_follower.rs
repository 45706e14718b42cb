//! Scene follower: feeds scenes to the world model, and acknowledges lockstep frames.

use crate::config::Config;
use crate::world_model_updater::WorldModelUpdater;
use channel::topic::{FinishedFrames, Scene};
use channel::{Domain, Error, Publisher, Received, Subscriber};
use message::{FrameDone, PlainHeader, ProcessKind, SceneSummary, Span, Stage, frame_flag};
use service::{HealthCounters, LiveConfig, TracePublisher, monotonic_ns};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;
use tokio::time::{Interval, MissedTickBehavior};

/// Subscriber to scenes that acknowledges each frame of a lockstep source.
pub(crate) struct SceneFollower {
    scenes: Subscriber<Scene>,
    finished: Publisher<FinishedFrames>,
    /// Reports of all followers of a lockstep source.
    reports: Subscriber<FinishedFrames>,
    /// Session and number of the frame on which perception has reported last.
    of_perception: Option<(u64, u64)>,
    /// Session and number of the frame on which this process has reported last.
    reported: Option<(u64, u64)>,
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
            finished: Publisher::new(domain)?,
            reports: Subscriber::waiting(domain)?,
            of_perception: None,
            reported: None,
            trace: TracePublisher::new(domain, ProcessKind::MEMORY)?,
            health,
            feed,
            live,
        })
    }

    /// Shared memory reserved by the publishers, bytes.
    pub(crate) fn reserved_bytes(&self) -> u64 {
        self.finished.reservation().bytes() + self.trace.reserved_bytes()
    }

    pub(crate) async fn run(mut self) {
        let mut looks = interval(self.live.take().world_period);
        loop {
            let followed = tokio::select! {
                () = self.scenes.wake_event() => self.take_all(),
                () = self.reports.wake_event() => self.repeat_reports(),
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
            if header.frame_flags & frame_flag::LOCKSTEP != 0 {
                self.report((header.session, header.sequence))?;
            }
            self.feed.keep(scene);
        }
        Ok(())
    }

    /// Reports again when perception does: the source has sent the frame again, and waits for all.
    fn repeat_reports(&mut self) -> Result<(), Error> {
        while let Received::Message(reports) = self.reports.receive()? {
            for done in reports.items() {
                if done.process != u64::from(ProcessKind::PERCEPTION.code()) {
                    continue;
                }
                let frame = (done.session, done.sequence);
                let is_repeated = self.of_perception.replace(frame) == Some(frame);
                if is_repeated && self.reported == Some(frame) {
                    self.report(frame)?;
                }
            }
        }
        Ok(())
    }

    fn report(&mut self, (session, sequence): (u64, u64)) -> Result<(), Error> {
        self.reported = Some((session, sequence));
        let done = FrameDone {
            session,
            sequence,
            process: u64::from(ProcessKind::MEMORY.code()),
        };
        self.finished.send_copy(PlainHeader::default(), &[done])
    }
}

fn interval(period: Duration) -> Interval {
    let mut interval = tokio::time::interval(period);
    interval.set_missed_tick_behavior(MissedTickBehavior::Delay);
    interval
}
