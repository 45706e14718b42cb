//! Frame loop: receives each frame, runs it through the pipeline and publishes the results.

mod configuration_change;

use crate::assumption_log::AssumptionLog;
use crate::body_subscriber::BodySubscribers;
use crate::camera_watch::{CameraWatch, LOOK_PERIOD};
use crate::config::Config;
use crate::detector::{DetectedFrame, DetectionError, Detector};
use crate::frame_receiver::{FrameReceiver, ReceivedFrame};
use crate::frame_trace::FrameTrace;
use crate::latest_scene::LatestScene;
use crate::live_executor::{FrameError, LiveExecutor, LiveState};
use crate::liveness_probe::{LivenessProbe, PROBE_PERIOD};
use crate::memory_replica::{CategorySnapshot, SharedCategories, SyncBarrier};
use crate::newest_view::NewestViews;
use crate::noise_log::NoiseLog;
use crate::object_actors::ObjectActors;
use crate::outbox::{Outbox, StoreReceipt};
use crate::publishers::Publishers;
use crate::scene_report;
use crate::table_log::TableLog;
use crate::track_ids::TrackIds;
use actor::{Progress, WorkerPool};
use channel::{Domain, Error};
use constraint::Assumptions;
use detection::Table;
use learning::{NoveltyPrior, TrackEvidence, UnknownRule};
use message::{
    FrameDone, PlainHeader, ProcessKind, SceneObject, SceneSummary, Stage, Text, points,
};
use pipeline::{FramePipeline, LessonFeedback};
use service::{HealthCounters, LiveConfig, Stopwatch, monotonic_ns};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use tokio::sync::watch;

/// State of the frame loop that lasts from frame to frame.
pub(crate) struct FrameLoop {
    settings: LiveConfig<Config>,
    frame_receiver: FrameReceiver,
    camera_watch: CameraWatch,
    pipeline: FramePipeline,
    live: LiveState,
    rule: Text,
    assumption_log: AssumptionLog,
    table_log: TableLog,
    noise_log: NoiseLog,
    pool: WorkerPool,
    liveness_probe: LivenessProbe,
    outbox: Outbox,
    sync_barrier: SyncBarrier,
    categories: SharedCategories,
    category_changes: watch::Receiver<Arc<CategorySnapshot>>,
    /// Taught views that the labels of all tracks were read against.
    labelled_by: Arc<CategorySnapshot>,
    lesson_feedback: LessonFeedback,
    novelty_prior: watch::Sender<NoveltyPrior>,
    config: pipeline::Config,
    latest_scene: Arc<LatestScene>,
    health: Arc<HealthCounters>,
    publishers: Publishers,
    objects: Vec<SceneObject>,
    /// Session and number of the frame on which the work has ended last.
    last_finished: Option<(u64, u64)>,
}

/// Dependencies of the frame loop.
pub(crate) struct FrameLoopParts {
    pub(crate) pool: WorkerPool,
    pub(crate) actors: ObjectActors,
    pub(crate) ids: Arc<TrackIds>,
    pub(crate) outbox: Outbox,
    pub(crate) sync_barrier: SyncBarrier,
    pub(crate) categories: SharedCategories,
    pub(crate) novelty_prior: watch::Sender<NoveltyPrior>,
    pub(crate) latest_scene: Arc<LatestScene>,
    pub(crate) health: Arc<HealthCounters>,
}

impl FrameLoop {
    pub(crate) fn new(
        domain: &Domain,
        settings: LiveConfig<Config>,
        parts: FrameLoopParts,
    ) -> Result<Self, Error> {
        let config = settings.get();
        let publishers = Publishers::new(domain)?;
        let trace = FrameTrace::new(domain)?;
        parts.health.shared_memory_bytes.store(
            publishers.reserved_bytes() + trace.reserved_bytes(),
            Ordering::Relaxed,
        );
        let detector = Detector::new(parts.pool.clone(), config.detection.clone());
        #[cfg(feature = "fault-injection")]
        let detector = detector.with_fault(config.fault.frame);
        let rule = detector.config().rule().to_string();
        tracing::info!("a candidate becomes an object when {rule}");
        let mut frames = Self {
            settings,
            frame_receiver: FrameReceiver::new(domain)?,
            camera_watch: CameraWatch::new(parts.health.clone()),
            pipeline: FramePipeline::new(config.pipeline),
            live: LiveState {
                bodies: BodySubscribers::new(domain)?,
                detector,
                actors: parts.actors,
                ids: parts.ids,
                actor_deadline: config.actor_deadline,
                trace,
                outcomes: Vec::new(),
                newest_views: NewestViews::new(),
            },
            rule: Text::truncated(&rule),
            assumption_log: AssumptionLog::default(),
            table_log: TableLog::default(),
            noise_log: NoiseLog::default(),
            liveness_probe: LivenessProbe::new(parts.pool.clone(), parts.health.clone()),
            pool: parts.pool,
            outbox: parts.outbox,
            sync_barrier: parts.sync_barrier,
            category_changes: parts.categories.changes(),
            categories: parts.categories,
            labelled_by: Arc::default(),
            lesson_feedback: LessonFeedback::default(),
            novelty_prior: parts.novelty_prior,
            config: config.pipeline,
            latest_scene: parts.latest_scene,
            health: parts.health,
            publishers,
            objects: Vec::new(),
            last_finished: None,
        };
        frames.set_pipeline_config(config.pipeline);
        Ok(frames)
    }

    /// Processes frames as they arrive, until the future is dropped or shared memory
    /// fails.
    pub(crate) async fn run(&mut self) -> Result<(), Error> {
        let mut probe = tokio::time::interval(PROBE_PERIOD);
        let mut looks = tokio::time::interval(LOOK_PERIOD);
        loop {
            while let Some(received) = self.frame_receiver.newest()? {
                self.take_configuration_change().await;
                self.frame(&received).await?;
                probe.reset();
            }
            tokio::select! {
                () = self.frame_receiver.woken() => {}
                _ = self.category_changes.changed() => self.relabel_scene().await,
                config = self.settings.change() => self.apply(&config).await,
                _ = probe.tick() => self.probe().await?,
                _ = looks.tick() => self.camera_watch.look(monotonic_ns()),
            }
        }
    }

    /// Stops all object actors gracefully.
    pub(crate) async fn stop(&self) {
        self.live.actors.stop_all().await;
    }

    /// Liveness probe: runs an empty job on the worker pool and reports health.
    async fn probe(&mut self) -> Result<(), Error> {
        self.liveness_probe.probe().await;
        self.report_actors();
        self.publishers.scene.deliver_history()
    }

    fn report_actors(&self) {
        let count = |n: usize| n as u64;
        self.health
            .actors
            .store(count(self.live.actors.n_actors()), Ordering::Relaxed);
        self.health
            .abandoned
            .store(count(self.pool.n_abandoned()), Ordering::Relaxed);
    }

    async fn frame(&mut self, received: &ReceivedFrame) -> Result<(), Error> {
        self.camera_watch
            .frame_received(received.received_ns, received.is_lockstep());
        if self.is_repeated(received) {
            return self.report_finished(received);
        }
        if received.is_lockstep() {
            // Determinism: a replay has the same categories at the same frame.
            self.liveness_probe
                .while_waiting(self.sync_barrier.wait())
                .await;
        }
        self.live.trace.begin(received);
        let taught = self.categories.get();
        let mut executor = LiveExecutor::new(&mut self.live, received, &taught);
        let cloud = points(received.frame.items());
        let processed = self
            .pipeline
            .process(&received.frame_pose(), cloud, &mut executor)
            .await;
        let detected_ns = executor.detected_ns;
        let detected = match processed {
            Ok(detected) => detected,
            Err(FrameError::Channel(error)) => return Err(error),
            Err(FrameError::Detection(failed)) => {
                self.log_failure(received, &failed);
                return self.report_finished(received);
            }
        };
        self.reread_labels(taught).await;
        let mut summary = scene_report::summary(received);
        summary.stale_after_ns = self.camera_watch.stale_after_ns();
        summary.stamps.detected_ns = detected_ns;
        summary.stamps.recognised_ns = self.live.trace.at_ns();
        let receipts = self.publish(&mut summary, received, &detected)?;
        self.live.trace.send(received);
        self.finish(received, detected, receipts).await
    }

    /// True for a retransmission of the last finished frame: a lockstep source sends a frame again
    /// when a report was lost.
    fn is_repeated(&self, received: &ReceivedFrame) -> bool {
        let header = received.frame.header();
        self.last_finished == Some((header.session, header.sequence))
    }

    /// Publishes the results of a frame: key views to the memory, objects and scene to
    /// subscribers.
    fn publish(
        &mut self,
        summary: &mut SceneSummary,
        received: &ReceivedFrame,
        detected: &DetectedFrame,
    ) -> Result<Vec<StoreReceipt>, Error> {
        let begin = Stopwatch::since(self.live.trace.at_ns());
        let mut watch = begin;
        let receipts = self.send_key_views(received);
        self.live.trace.add(watch.lap(Stage::Outbox, 0));
        self.publish_objects(received, detected);
        self.live.trace.add(watch.lap(Stage::ObjectTopics, 0));
        self.publish_scene(summary, received, detected)?;
        self.live.trace.add(watch.lap(Stage::SceneTopic, 0));
        self.live
            .trace
            .end_work(watch.span_since(&begin, Stage::Publishing, 0));
        Ok(receipts)
    }

    /// Reads the labels of the latest scene anew, for clients that wait for them and for tracks
    /// that no frame shows.
    async fn relabel_scene(&mut self) {
        let newest = self.categories.get();
        self.reread_labels(newest).await;
        let (tracks, at) = (self.pipeline.tracks(), self.labelled_by.position);
        self.latest_scene.update(at, |object| {
            let track = tracks.iter().find(|track| track.id == object.track_id);
            if let Some(track) = track {
                scene_report::set_label(object, track.recognition(), at.sequence);
            }
        });
    }

    /// Reads the evidence of each track anew whose label is of other taught views or of another
    /// rule.
    async fn reread_labels(&mut self, taught: Arc<CategorySnapshot>) {
        self.learn_novelty_prior(&taught);
        let outdated = self.pipeline.outdated_evidence(&taught.index);
        if !outdated.is_empty() {
            let rule = self.config.unknown_rule();
            match self
                .pool
                .run(rereading(outdated, taught.clone(), rule))
                .await
            {
                Ok(reread) => self.pipeline.set_evidence(reread),
                Err(lost) => {
                    self.health.restarts.fetch_add(1, Ordering::Relaxed);
                    tracing::error!("labels were not read anew: {lost}");
                    return;
                }
            }
        }
        self.labelled_by = taught;
    }

    /// Learns the prior of novelty from the lessons since the labels were read last.
    fn learn_novelty_prior(&mut self, taught: &Arc<CategorySnapshot>) {
        if Arc::ptr_eq(taught, &self.labelled_by) {
            return;
        }
        let tracks = self.pipeline.tracks().iter();
        let labels = tracks.map(|track| (track.id, track.recognition().label.as_ref()));
        let before = &self.labelled_by.index;
        let feedback = self
            .lesson_feedback
            .read(&labels.collect(), before, &taught.index);
        if feedback.is_empty() {
            return;
        }
        self.novelty_prior.send_modify(|prior| {
            for one in feedback {
                prior.learn(one);
            }
        });
        let prior = self.novelty_prior.borrow().probability();
        tracing::info!(
            "after these lessons one object in {:.0} is taken to be new",
            prior.recip()
        );
        self.set_pipeline_config(self.config);
    }

    /// Sets the configuration of tracking and recognition, with the learned prior of novelty.
    fn set_pipeline_config(&mut self, config: pipeline::Config) {
        self.config = config.with_novelty_prior(*self.novelty_prior.borrow());
        self.pipeline.set_config(self.config);
        self.live.actors.set_pipeline_config(self.config);
    }

    fn send_key_views(&mut self, received: &ReceivedFrame) -> Vec<StoreReceipt> {
        let key_views = self
            .live
            .outcomes
            .iter_mut()
            .filter_map(|(sighting, observed)| {
                let observed = observed
                    .as_mut()
                    .filter(|observed| observed.posterior.is_key_view)?;
                Some(scene_report::stored_view(received, sighting, observed))
            });
        key_views.filter_map(|view| self.outbox.put(view)).collect()
    }

    fn publish_objects(&mut self, received: &ReceivedFrame, detected: &DetectedFrame) {
        let (outcomes, tracks) = (&self.live.outcomes, self.pipeline.tracks());
        self.publishers
            .publish_objects(received, detected, outcomes, tracks);
    }

    fn publish_scene(
        &mut self,
        summary: &mut SceneSummary,
        received: &ReceivedFrame,
        detected: &DetectedFrame,
    ) -> Result<(), Error> {
        let tracks = self.pipeline.tracks();
        let (views, at) = (&self.live.newest_views, self.labelled_by.position);
        scene_report::objects(tracks, views, at.sequence, &mut self.objects);
        summary.n_objects_total = tracks.len() as u32;
        summary.rule = self.rule;
        summary.n_late = self
            .live
            .outcomes
            .iter()
            .filter(|(_, observed)| observed.is_none())
            .count() as u32;
        summary.frames_dropped = self.frame_receiver.n_dropped();
        scene_report::add_detection(
            summary,
            &detected.detection,
            &self.pipeline.update().rejected_candidates,
            received.checked.world_from_camera.as_ref(),
        );
        self.assumption_log
            .update(Assumptions::from_bits(summary.assumptions));
        self.table_log.update(detected.detection.table());
        let noise_ratio = self.pipeline.noise_ratio();
        self.noise_log.update(noise_ratio);
        let table_depth_m = detected.detection.table().map(Table::middle_depth_m);
        self.latest_scene
            .set_depth_noise(noise_ratio, table_depth_m);
        summary.stamps.published_ns = monotonic_ns();
        self.latest_scene.set(summary, &self.objects, at);
        self.publishers.scene.send_copy(*summary, &self.objects)
    }

    async fn finish(
        &mut self,
        received: &ReceivedFrame,
        detected: Arc<DetectedFrame>,
        receipts: Vec<StoreReceipt>,
    ) -> Result<(), Error> {
        self.live.actors.recycle(&mut self.live.outcomes);
        // A late actor still holds the detection, and this frame's buffers with it.
        if let Ok(detected) = Arc::try_unwrap(detected) {
            self.live.detector.recycle(detected);
        }
        self.health.frames.fetch_add(1, Ordering::Relaxed);
        self.health
            .frames_dropped
            .store(self.frame_receiver.n_dropped(), Ordering::Relaxed);
        self.report_actors();
        if received.is_lockstep() {
            let stored = async {
                for stored in receipts {
                    let _ = stored.await;
                }
            };
            self.liveness_probe.while_waiting(stored).await;
        }
        self.report_finished(received)
    }

    /// Ends the work on a frame, used or unusable: that is progress.
    fn report_finished(&mut self, received: &ReceivedFrame) -> Result<(), Error> {
        self.health.record_progress();
        let header = received.frame.header();
        let (session, sequence) = (header.session, header.sequence);
        self.last_finished = Some((session, sequence));
        if !received.is_lockstep() {
            return Ok(());
        }
        let done = FrameDone {
            session,
            sequence,
            process: u64::from(ProcessKind::PERCEPTION.code()),
        };
        let finished = &mut self.publishers.finished;
        finished.send_copy(PlainHeader::default(), &[done])
    }

    fn log_failure(&self, received: &ReceivedFrame, failed: &DetectionError) {
        if failed.is_restart() {
            self.health.restarts.fetch_add(1, Ordering::Relaxed);
        }
        let sequence = received.frame.header().sequence;
        match failed {
            DetectionError::Unusable(error) => {
                tracing::warn!("frame {sequence} cannot be searched: {error}");
            }
            DetectionError::Lost(error) => {
                tracing::error!("detection of frame {sequence}: {error}");
            }
        }
    }
}

/// Worker job that reads the evidence of tracks against the taught views.
fn rereading(
    mut evidence: Vec<(u64, TrackEvidence)>,
    taught: Arc<CategorySnapshot>,
    rule: UnknownRule,
) -> impl FnOnce(&Progress) -> Vec<(u64, TrackEvidence)> + Send + 'static {
    move |progress| {
        for (_, evidence) in &mut evidence {
            progress.tick();
            taught.index.reread_track(rule, evidence);
        }
        evidence
    }
}
