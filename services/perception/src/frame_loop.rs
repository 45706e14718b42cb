//! Frame loop: detection, data association, object actors and publication for each frame;
//! owner of the track table.

use crate::assumption_log::AssumptionLog;
use crate::body_subscriber::BodySubscribers;
use crate::config::Config;
use crate::detector::{DetectedFrame, DetectionError, Detector};
use crate::frame_receiver::{FrameReceiver, ReceivedFrame};
use crate::frame_trace::FrameTrace;
use crate::latest_scene::LatestScene;
use crate::memory_replica::{CategorySnapshot, SharedCategories, SyncBarrier};
use crate::newest_view::{self, LabelEstimate, NewestView, NewestViews};
use crate::object_actors::{ObjectActors, SightingOutcome};
use crate::outbox::{Outbox, StoreReceipt};
use crate::publishers::Publishers;
use crate::scene_report;
use crate::table_log::TableLog;
use crate::track_ids::TrackIds;
use actor::{Progress, WorkerPool};
use channel::{Domain, Error};
use constraint::Assumptions;
use message::{
    FrameDone, PlainHeader, ProcessKind, SceneObject, SceneSummary, Stage, Text, points,
};
use pipeline::{ObjectWorkspace, TrackTable, TrackUpdate};
use service::{HealthCounters, Stopwatch, monotonic_ns};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

/// Period of the liveness probe of the loop and its workers while no frames arrive.
const PROBE: Duration = Duration::from_millis(500);

/// State of the frame loop that lasts from frame to frame.
pub(crate) struct FrameLoop {
    frame_receiver: FrameReceiver,
    bodies: BodySubscribers,
    detector: Detector,
    rule: Text,
    assumption_log: AssumptionLog,
    table_log: TableLog,
    pool: WorkerPool,
    table: TrackTable,
    actors: ObjectActors,
    ids: Arc<TrackIds>,
    outbox: Outbox,
    sync_barrier: SyncBarrier,
    categories: SharedCategories,
    config: pipeline::Config,
    latest_scene: Arc<LatestScene>,
    health: Arc<HealthCounters>,
    actor_deadline: Duration,
    publishers: Publishers,
    trace: FrameTrace,
    step: TrackUpdate,
    outcomes: Vec<SightingOutcome>,
    objects: Vec<SceneObject>,
    newest_views: NewestViews,
    last_capture_ns: u64,
    last_finished: Option<FrameDone>,
}

/// Dependencies of the frame loop.
pub(crate) struct FrameLoopParts {
    pub(crate) pool: WorkerPool,
    pub(crate) actors: ObjectActors,
    pub(crate) ids: Arc<TrackIds>,
    pub(crate) outbox: Outbox,
    pub(crate) sync_barrier: SyncBarrier,
    pub(crate) categories: SharedCategories,
    pub(crate) latest_scene: Arc<LatestScene>,
    pub(crate) health: Arc<HealthCounters>,
}

impl FrameLoop {
    pub(crate) fn new(
        domain: &Domain,
        config: &Config,
        parts: FrameLoopParts,
    ) -> Result<Self, Error> {
        let publishers = Publishers::new(domain)?;
        let trace = FrameTrace::new(domain)?;
        parts.health.shared_memory_bytes.store(
            publishers.reserved_bytes() + trace.reserved_bytes(),
            Ordering::Relaxed,
        );
        let detector = Detector::new(parts.pool.clone(), config.detection.clone());
        let rule = detector.config().rule().to_string();
        tracing::info!("a candidate becomes an object when {rule}");
        Ok(Self {
            frame_receiver: FrameReceiver::new(domain)?,
            bodies: BodySubscribers::new(domain)?,
            detector,
            rule: Text::truncated(&rule),
            assumption_log: AssumptionLog::default(),
            table_log: TableLog::default(),
            pool: parts.pool,
            table: TrackTable::new(config.pipeline),
            actors: parts.actors,
            ids: parts.ids,
            outbox: parts.outbox,
            sync_barrier: parts.sync_barrier,
            categories: parts.categories,
            config: config.pipeline,
            latest_scene: parts.latest_scene,
            health: parts.health,
            actor_deadline: config.actor_deadline,
            publishers,
            trace,
            step: TrackUpdate::default(),
            outcomes: Vec::new(),
            objects: Vec::new(),
            newest_views: NewestViews::new(),
            last_capture_ns: 0,
            last_finished: None,
        })
    }

    /// Processes frames as they arrive, until the future is dropped or shared memory
    /// fails.
    pub(crate) async fn run(&mut self) -> Result<(), Error> {
        let mut probe = tokio::time::interval(PROBE);
        loop {
            while let Some(received) = self.frame_receiver.newest()? {
                self.frame(&received).await?;
                probe.reset();
                // A camera faster than the loop leaves no pause between frames.
                self.relabel_if_requested().await;
            }
            tokio::select! {
                () = self.frame_receiver.woken() => {}
                () = self.latest_scene.outdated() => self.relabel_if_requested().await,
                _ = probe.tick() => self.probe().await?,
            }
        }
    }

    /// Stops all actors gracefully.
    pub(crate) async fn stop(&self) {
        self.actors.stop_all().await;
    }

    /// Liveness probe: runs an empty job on the worker pool and reports health.
    async fn probe(&mut self) -> Result<(), Error> {
        if self.pool.run(|_| ()).await.is_ok() {
            self.health.record_progress();
        }
        self.report_actors();
        self.publishers.scene.deliver_history()
    }

    fn report_actors(&self) {
        let count = |n: usize| n as u64;
        self.health
            .actors
            .store(count(self.actors.n_actors()), Ordering::Relaxed);
        self.health
            .abandoned
            .store(count(self.pool.n_abandoned()), Ordering::Relaxed);
    }

    async fn frame(&mut self, received: &ReceivedFrame) -> Result<(), Error> {
        if self.is_repeated(received) {
            return self.report_finished(received);
        }
        self.restart_if_time_jumped(received.frame.header().capture_stamp_ns);
        if received.is_lockstep() {
            // Determinism: a replay has the same categories at the same frame.
            self.sync_barrier.wait().await;
        }
        self.trace.begin(received);
        self.gather_priors(received)?;
        let detected = match self.detector.detect(received).await {
            Ok(detected) => detected,
            Err(failed) => {
                self.log_failure(received, &failed);
                return self.report_finished(received);
            }
        };
        self.trace.add_detection(&detected);
        let mut summary = scene_report::summary(received);
        summary.stamps.detected_ns = self.trace.at_ns();
        self.associate(received, &detected);
        let detected = Arc::new(detected);
        self.observe(received, &detected).await;
        summary.stamps.recognised_ns = self.trace.at_ns();
        let receipts = self.publish(&mut summary, received, &detected)?;
        self.trace.send(received);
        self.finish(received, detected, receipts).await
    }

    /// True if the frame is a retransmission: a lockstep source sends a frame again when
    /// a report was lost.
    fn is_repeated(&self, received: &ReceivedFrame) -> bool {
        let header = received.frame.header();
        self.last_finished
            .is_some_and(|last| (last.session, last.sequence) == (header.session, header.sequence))
    }

    /// Ends all tracks when the capture time runs backwards, which is the start of
    /// another recording.
    fn restart_if_time_jumped(&mut self, capture_ns: u64) {
        if capture_ns < self.last_capture_ns {
            self.step.ended_tracks.clear();
            self.table.clear(&mut self.step.ended_tracks);
            self.dismiss_gone();
        }
        self.last_capture_ns = capture_ns;
    }

    /// Gathers the scene priors of a frame: people, the robot, and the predicted tracks.
    fn gather_priors(&mut self, received: &ReceivedFrame) -> Result<(), Error> {
        let mut watch = Stopwatch::since(self.trace.at_ns());
        let capture_ns = received.frame.header().capture_stamp_ns;
        let world_from_camera = received.checked.world_from_camera.as_ref();
        let priors = self.detector.priors_mut();
        self.table
            .predict(&received.frame_pose(), &mut priors.tracks);
        self.bodies
            .priors_at(capture_ns, world_from_camera, priors)?;
        self.trace.end_work(watch.lap(Stage::GatherPriors, 0));
        Ok(())
    }

    fn associate(&mut self, received: &ReceivedFrame, detected: &DetectedFrame) {
        let mut watch = Stopwatch::since(self.trace.at_ns());
        let frame = received.frame_pose();
        let ids = &self.ids;
        self.table.update(
            &detected.detection,
            points(received.frame.items()),
            &frame,
            || ids.take(),
            &mut self.step,
        );
        for sighting in self
            .step
            .sightings
            .iter()
            .filter(|sighting| sighting.is_new)
        {
            self.actors.spawn(sighting.track_id);
        }
        self.dismiss_gone();
        self.trace.end_work(watch.lap(Stage::Association, 0));
    }

    fn dismiss_gone(&mut self) {
        for track_id in &self.step.ended_tracks {
            self.actors.dismiss(*track_id);
            self.newest_views.remove(track_id);
        }
    }

    async fn observe(&mut self, received: &ReceivedFrame, detected: &Arc<DetectedFrame>) {
        let deadline = (!received.is_lockstep()).then_some(self.actor_deadline);
        let Self {
            actors,
            step,
            outcomes,
            ..
        } = self;
        actors
            .observe(received, detected, &step.sightings, deadline, outcomes)
            .await;
        self.trace.add_observations(&self.outcomes);
    }

    /// Publishes the results of a frame: key views to the memory, objects and scene to
    /// subscribers.
    fn publish(
        &mut self,
        summary: &mut SceneSummary,
        received: &ReceivedFrame,
        detected: &DetectedFrame,
    ) -> Result<Vec<StoreReceipt>, Error> {
        let begin = Stopwatch::since(self.trace.at_ns());
        let mut watch = begin;
        self.absorb();
        let receipts = self.send_key_views(received);
        self.trace.add(watch.lap(Stage::Outbox, 0));
        self.publish_objects(received, detected);
        self.trace.add(watch.lap(Stage::ObjectTopics, 0));
        self.publish_scene(summary, received, detected)?;
        self.trace.add(watch.lap(Stage::SceneTopic, 0));
        self.trace
            .end_work(watch.span_since(&begin, Stage::Publishing, 0));
        Ok(receipts)
    }

    /// Applies the actors' posteriors to the track table.
    fn absorb(&mut self) {
        for view in self.newest_views.values_mut() {
            view.is_key_view = false;
        }
        for (sighting, observed) in &mut self.outcomes {
            let Some(observed) = observed else { continue };
            self.table
                .apply_posterior(sighting.track_id, &observed.posterior);
            let view = NewestView::new(observed, &sighting.measured);
            if let Some(older) = self.newest_views.insert(sighting.track_id, view) {
                self.actors.recycle_points(older.points);
            }
        }
    }

    async fn relabel_if_requested(&mut self) {
        if self.latest_scene.take_outdated() {
            self.relabel().await;
        }
    }

    /// Recomputes outdated labels of the latest scene, for clients that wait for them.
    /// Tracks out of view would keep a label until they are seen again.
    async fn relabel(&mut self) {
        let snapshot = self.categories.get();
        let mut outdated = Vec::new();
        for (track_id, view) in &mut self.newest_views {
            if snapshot.is_current(view.recognised.position) {
                view.recognised.position = snapshot.position;
            } else {
                outdated.push((*track_id, view.clone()));
            }
        }
        let position = snapshot.position;
        match self
            .pool
            .run(recognition(outdated, snapshot, self.config))
            .await
        {
            Ok(recognised) => {
                for (track_id, recognised) in recognised {
                    if let Some(view) = self.newest_views.get_mut(&track_id) {
                        view.recognised = recognised;
                    }
                }
            }
            Err(lost) => {
                self.health.restarts.fetch_add(1, Ordering::Relaxed);
                tracing::error!("the labels were not recomputed: {lost}");
            }
        }
        let views = &self.newest_views;
        let position = newest_view::oldest_position(views, position);
        self.latest_scene.update(position, |object| {
            if let Some(view) = views.get(&object.track_id) {
                scene_report::set_label(object, &view.recognised);
            }
        });
    }

    fn send_key_views(&mut self, received: &ReceivedFrame) -> Vec<StoreReceipt> {
        let key_views = self.outcomes.iter_mut().filter_map(|(sighting, observed)| {
            let observed = observed
                .as_mut()
                .filter(|observed| observed.posterior.is_key_view)?;
            Some(scene_report::stored_view(received, sighting, observed))
        });
        key_views.filter_map(|view| self.outbox.put(view)).collect()
    }

    fn publish_objects(&mut self, received: &ReceivedFrame, detected: &DetectedFrame) {
        let Self {
            publishers,
            table,
            outcomes,
            ..
        } = self;
        publishers.publish_objects(received, detected, outcomes, table.tracks());
    }

    fn publish_scene(
        &mut self,
        summary: &mut SceneSummary,
        received: &ReceivedFrame,
        detected: &DetectedFrame,
    ) -> Result<(), Error> {
        let tracks = self.table.tracks();
        scene_report::objects(tracks, &self.newest_views, &mut self.objects);
        summary.n_objects_total = tracks.len() as u32;
        summary.rule = self.rule;
        summary.n_late = self
            .outcomes
            .iter()
            .filter(|(_, observed)| observed.is_none())
            .count() as u32;
        summary.frames_dropped = self.frame_receiver.n_dropped();
        scene_report::add_detection(
            summary,
            &detected.detection,
            &self.step.rejected_candidates,
            received.checked.world_from_camera.as_ref(),
        );
        self.assumption_log
            .update(Assumptions::from_bits(summary.assumptions));
        self.table_log.update(detected.detection.table.as_ref());
        summary.stamps.published_ns = monotonic_ns();
        let newest = self.categories.get().position;
        let position = newest_view::oldest_position(&self.newest_views, newest);
        self.latest_scene.set(summary, &self.objects, position);
        self.publishers.scene.send_copy(*summary, &self.objects)
    }

    async fn finish(
        &mut self,
        received: &ReceivedFrame,
        detected: Arc<DetectedFrame>,
        receipts: Vec<StoreReceipt>,
    ) -> Result<(), Error> {
        self.actors.recycle(&mut self.outcomes);
        // A late actor still holds the detection, and this frame's buffers with it.
        if let Ok(detected) = Arc::try_unwrap(detected) {
            self.detector.recycle(detected);
        }
        self.health.frames.fetch_add(1, Ordering::Relaxed);
        self.health
            .frames_dropped
            .store(self.frame_receiver.n_dropped(), Ordering::Relaxed);
        self.report_actors();
        self.health.record_progress();
        if received.is_lockstep() {
            for stored in receipts {
                let _ = stored.await;
            }
        }
        self.report_finished(received)
    }

    fn report_finished(&mut self, received: &ReceivedFrame) -> Result<(), Error> {
        let header = received.frame.header();
        let done = FrameDone {
            session: header.session,
            sequence: header.sequence,
            process: u64::from(ProcessKind::Perception.code()),
        };
        self.last_finished = Some(done);
        if received.is_lockstep() {
            self.publishers
                .finished
                .send_copy(PlainHeader::default(), &[done])?;
        }
        Ok(())
    }

    fn log_failure(&self, received: &ReceivedFrame, failed: &DetectionError) {
        if failed.is_restart() {
            self.health.restarts.fetch_add(1, Ordering::Relaxed);
        }
        let sequence = received.frame.header().sequence;
        match failed {
            DetectionError::Unusable(error) => {
                tracing::warn!("frame {sequence} can not be searched: {error}");
            }
            DetectionError::Lost(error) => {
                tracing::error!("detection of frame {sequence}: {error}");
            }
        }
    }
}

/// Worker job that recognises views with the newest categories.
fn recognition(
    views: Vec<(u64, NewestView)>,
    snapshot: Arc<CategorySnapshot>,
    config: pipeline::Config,
) -> impl FnOnce(&Progress) -> Vec<(u64, LabelEstimate)> + Send + 'static {
    move |progress| {
        let mut recognised = Vec::with_capacity(views.len());
        let Ok(mut tools) = ObjectWorkspace::new() else {
            return recognised;
        };
        for (track_id, view) in views {
            progress.tick();
            match view.recognise(&snapshot, &config, &mut tools) {
                Ok(result) => recognised.push((track_id, result)),
                Err(error) => tracing::warn!("track {track_id} keeps an old label: {error}"),
            }
        }
        recognised
    }
}
