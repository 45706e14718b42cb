//! The frame loop: it owns the track table and gives every frame its way.

use crate::assumption_log::AssumptionLog;
use crate::bodies::Bodies;
use crate::config::Config;
use crate::detector::{DetectFailed, Detected, Detector};
use crate::frame_trace::FrameTrace;
use crate::intake::{Arrived, Intake};
use crate::key_view_outbox::{OnDisk, Outbox};
use crate::learned::{CatchUp, Learned, SharedLearned};
use crate::newest_view::{self, NewestView, NewestViews, Recognised};
use crate::observation_round::{Actors, Outcome};
use crate::ports::Ports;
use crate::scene_report;
use crate::table_log::TableLog;
use crate::track_ids::TrackIds;
use crate::world::World;
use actor::{Progress, WorkerPool};
use channel::{Domain, Error};
use constraint::Assumptions;
use message::{
    FrameDone, PlainHeader, ProcessKind, SceneObject, SceneSummary, Stage, Text, points,
};
use pipeline::{ObjectTools, Step, TrackTable};
use service::{HealthBoard, Stopwatch, monotonic_ns};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

/// Without frames the loop proves this often that it and its workers are alive.
const PROBE: Duration = Duration::from_millis(500);

/// Everything that lasts from frame to frame.
pub(crate) struct FrameLoop {
    intake: Intake,
    bodies: Bodies,
    detector: Detector,
    rule: Text,
    assumption_log: AssumptionLog,
    table_log: TableLog,
    pool: WorkerPool,
    table: TrackTable,
    actors: Actors,
    ids: Arc<TrackIds>,
    outbox: Outbox,
    catch_up: CatchUp,
    learned: SharedLearned,
    config: pipeline::Config,
    world: Arc<World>,
    health: Arc<HealthBoard>,
    actor_deadline: Duration,
    ports: Ports,
    trace: FrameTrace,
    step: Step,
    outcomes: Vec<Outcome>,
    objects: Vec<SceneObject>,
    newest_views: NewestViews,
    last_capture_ns: u64,
    last_finished: Option<FrameDone>,
}

/// What the loop is given.
pub(crate) struct Surroundings {
    pub(crate) pool: WorkerPool,
    pub(crate) actors: Actors,
    pub(crate) ids: Arc<TrackIds>,
    pub(crate) outbox: Outbox,
    pub(crate) catch_up: CatchUp,
    pub(crate) learned: SharedLearned,
    pub(crate) world: Arc<World>,
    pub(crate) health: Arc<HealthBoard>,
}

impl FrameLoop {
    pub(crate) fn new(
        domain: &Domain,
        config: &Config,
        given: Surroundings,
    ) -> Result<Self, Error> {
        let ports = Ports::new(domain)?;
        let trace = FrameTrace::new(domain)?;
        given.health.shared_memory_bytes.store(
            ports.reserved_bytes() + trace.reserved_bytes(),
            Ordering::Relaxed,
        );
        let detector = Detector::new(given.pool.clone(), config.detection.clone());
        let rule = detector.config().rule().to_string();
        tracing::info!("a candidate becomes an object when {rule}");
        Ok(Self {
            intake: Intake::new(domain)?,
            bodies: Bodies::new(domain)?,
            detector,
            rule: Text::truncated(&rule),
            assumption_log: AssumptionLog::default(),
            table_log: TableLog::default(),
            pool: given.pool,
            table: TrackTable::new(config.pipeline),
            actors: given.actors,
            ids: given.ids,
            outbox: given.outbox,
            catch_up: given.catch_up,
            learned: given.learned,
            config: config.pipeline,
            world: given.world,
            health: given.health,
            actor_deadline: config.actor_deadline,
            ports,
            trace,
            step: Step::default(),
            outcomes: Vec::new(),
            objects: Vec::new(),
            newest_views: NewestViews::new(),
            last_capture_ns: 0,
            last_finished: None,
        })
    }

    /// Works on frames as they come, until the future is dropped or shared
    /// memory fails.
    pub(crate) async fn run(&mut self) -> Result<(), Error> {
        let mut probe = tokio::time::interval(PROBE);
        loop {
            while let Some(arrived) = self.intake.newest()? {
                self.frame(&arrived).await?;
                probe.reset();
            }
            tokio::select! {
                () = self.intake.woken() => {}
                () = self.world.outdated() => self.relabel().await,
                _ = probe.tick() => self.probe().await?,
            }
        }
    }

    /// Stops all actors in good order.
    pub(crate) async fn stop(&self) {
        self.actors.stop_all().await;
    }

    /// Nothing has come for a while: is everything still able to work?
    async fn probe(&mut self) -> Result<(), Error> {
        if self.pool.run(|_| ()).await.is_ok() {
            self.health.tick();
        }
        self.report_actors();
        self.ports.scene.greet_new_subscribers()
    }

    fn report_actors(&self) {
        let count = |n: usize| n as u64;
        self.health
            .actors
            .store(count(self.actors.n_actors()), Ordering::Relaxed);
        self.health
            .abandoned
            .store(count(self.pool.abandoned()), Ordering::Relaxed);
    }

    async fn frame(&mut self, arrived: &Arrived) -> Result<(), Error> {
        if self.is_repeated(arrived) {
            return self.report_finished(arrived);
        }
        self.restart_if_time_jumped(arrived.frame.header().capture_stamp_ns);
        if arrived.is_lockstep() {
            // A replay must know the same at the same frame.
            self.catch_up.wait().await;
        }
        self.trace.begin(arrived);
        self.look_around(arrived)?;
        let detected = match self.detector.detect(arrived).await {
            Ok(detected) => detected,
            Err(failed) => {
                self.say_failed(arrived, &failed);
                return self.report_finished(arrived);
            }
        };
        self.trace.detected(&detected);
        let mut summary = scene_report::summary(arrived);
        summary.stamps.detected_ns = self.trace.at_ns();
        self.associate(arrived, &detected);
        let detected = Arc::new(detected);
        self.observe(arrived, &detected).await;
        summary.stamps.recognised_ns = self.trace.at_ns();
        let on_disk = self.publish(&mut summary, arrived, &detected)?;
        self.trace.send(arrived);
        self.finish(arrived, detected, on_disk).await
    }

    /// A lockstep source sends a frame again when a report was lost.
    fn is_repeated(&self, arrived: &Arrived) -> bool {
        let header = arrived.frame.header();
        self.last_finished
            .is_some_and(|last| (last.session, last.sequence) == (header.session, header.sequence))
    }

    /// Capture time runs backwards when another recording begins: nothing that
    /// was tracked has to do with it.
    fn restart_if_time_jumped(&mut self, capture_ns: u64) {
        if capture_ns < self.last_capture_ns {
            self.step.gone.clear();
            self.table.clear(&mut self.step.gone);
            self.dismiss_gone();
        }
        self.last_capture_ns = capture_ns;
    }

    /// Gathers what is known to be there before a frame is searched: people, the
    /// robot, and where the tracks are expected.
    fn look_around(&mut self, arrived: &Arrived) -> Result<(), Error> {
        let mut watch = Stopwatch::since(self.trace.at_ns());
        let capture_ns = arrived.frame.header().capture_stamp_ns;
        let world_from_camera = arrived.checked.world_from_camera.as_ref();
        let known = self.detector.known_mut();
        self.table
            .predict(&arrived.circumstances(), &mut known.tracks);
        self.bodies.at(capture_ns, world_from_camera, known)?;
        self.trace.worked(watch.lap(Stage::Surroundings, 0));
        Ok(())
    }

    fn associate(&mut self, arrived: &Arrived, detected: &Detected) {
        let mut watch = Stopwatch::since(self.trace.at_ns());
        let frame = arrived.circumstances();
        let ids = &self.ids;
        self.table.step(
            &detected.detection,
            points(arrived.frame.items()),
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
        self.trace.worked(watch.lap(Stage::Association, 0));
    }

    fn dismiss_gone(&mut self) {
        for track_id in &self.step.gone {
            self.actors.dismiss(*track_id);
            self.newest_views.remove(track_id);
        }
    }

    async fn observe(&mut self, arrived: &Arrived, detected: &Arc<Detected>) {
        let deadline = (!arrived.is_lockstep()).then_some(self.actor_deadline);
        let Self {
            actors,
            step,
            outcomes,
            ..
        } = self;
        actors
            .observe(arrived, detected, &step.sightings, deadline, outcomes)
            .await;
        self.trace.observed(&self.outcomes);
    }

    /// Makes known what the frame has brought: key views to the memory, the objects
    /// and the scene to all.
    fn publish(
        &mut self,
        summary: &mut SceneSummary,
        arrived: &Arrived,
        detected: &Detected,
    ) -> Result<Vec<OnDisk>, Error> {
        let begin = Stopwatch::since(self.trace.at_ns());
        let mut watch = begin;
        self.absorb();
        let on_disk = self.send_key_views(arrived);
        self.trace.tell(watch.lap(Stage::Outbox, 0));
        self.publish_objects(arrived, detected);
        self.trace.tell(watch.lap(Stage::ObjectTopics, 0));
        self.publish_scene(summary, arrived, detected)?;
        self.trace.tell(watch.lap(Stage::SceneTopic, 0));
        self.trace
            .worked(watch.span_since(&begin, Stage::Publishing, 0));
        Ok(on_disk)
    }

    /// Takes over what the actors have found.
    fn absorb(&mut self) {
        for view in self.newest_views.values_mut() {
            view.is_key_view = false;
        }
        for (sighting, observed) in &mut self.outcomes {
            let Some(observed) = observed else { continue };
            self.table.absorb(sighting.track_id, &observed.posterior);
            let view = NewestView::new(observed, &sighting.measured);
            if let Some(older) = self.newest_views.insert(sighting.track_id, view) {
                self.actors.recycle_points(older.points);
            }
        }
    }

    /// Recomputes the labels of the latest scene that were made with older knowledge,
    /// for clients that wait for it. Tracks that are not seen keep a label until they are
    /// seen again; this is how it changes before.
    async fn relabel(&mut self) {
        let learned = self.learned.get();
        let mut outdated = Vec::new();
        for (track_id, view) in &mut self.newest_views {
            if learned.is_current(view.recognised.position) {
                view.recognised.position = learned.position;
            } else {
                outdated.push((*track_id, view.clone()));
            }
        }
        let position = learned.position;
        match self.pool.run(recognition(outdated, learned, self.config)).await {
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
        self.world.update(position, |object| {
            if let Some(view) = views.get(&object.track_id) {
                scene_report::set_recognised(object, &view.recognised);
            }
        });
    }

    fn send_key_views(&mut self, arrived: &Arrived) -> Vec<OnDisk> {
        let key_views = self.outcomes.iter_mut().filter_map(|(sighting, observed)| {
            let observed = observed
                .as_mut()
                .filter(|observed| observed.posterior.is_key_view)?;
            Some(scene_report::stored_view(arrived, sighting, observed))
        });
        key_views.filter_map(|view| self.outbox.put(view)).collect()
    }

    fn publish_objects(&mut self, arrived: &Arrived, detected: &Detected) {
        let Self {
            ports,
            table,
            outcomes,
            ..
        } = self;
        ports.publish_objects(arrived, detected, outcomes, table.tracks());
    }

    fn publish_scene(
        &mut self,
        summary: &mut SceneSummary,
        arrived: &Arrived,
        detected: &Detected,
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
        summary.frames_dropped = self.intake.n_dropped();
        scene_report::add_detection(
            summary,
            &detected.detection,
            &self.step.rejected,
            arrived.checked.world_from_camera.as_ref(),
        );
        self.assumption_log
            .tell(Assumptions::from_bits(summary.assumptions));
        self.table_log.tell(detected.detection.table.as_ref());
        summary.stamps.published_ns = monotonic_ns();
        let newest = self.learned.get().position;
        let position = newest_view::oldest_position(&self.newest_views, newest);
        self.world.set(summary, &self.objects, position);
        self.ports.scene.send_copy(*summary, &self.objects)
    }

    async fn finish(
        &mut self,
        arrived: &Arrived,
        detected: Arc<Detected>,
        on_disk: Vec<OnDisk>,
    ) -> Result<(), Error> {
        self.actors.recycle(&mut self.outcomes);
        // An actor that is late keeps the detection, and this frame's memory with it.
        if let Ok(detected) = Arc::try_unwrap(detected) {
            self.detector.recycle(detected);
        }
        self.health.frames.fetch_add(1, Ordering::Relaxed);
        self.health
            .frames_dropped
            .store(self.intake.n_dropped(), Ordering::Relaxed);
        self.report_actors();
        self.health.tick();
        if arrived.is_lockstep() {
            for stored in on_disk {
                let _ = stored.await;
            }
        }
        self.report_finished(arrived)
    }

    fn report_finished(&mut self, arrived: &Arrived) -> Result<(), Error> {
        let header = arrived.frame.header();
        let done = FrameDone {
            session: header.session,
            sequence: header.sequence,
            process: u64::from(ProcessKind::Perception.code()),
        };
        self.last_finished = Some(done);
        if arrived.is_lockstep() {
            self.ports
                .finished
                .send_copy(PlainHeader::default(), &[done])?;
        }
        Ok(())
    }

    fn say_failed(&self, arrived: &Arrived, failed: &DetectFailed) {
        if failed.is_restart() {
            self.health.restarts.fetch_add(1, Ordering::Relaxed);
        }
        let sequence = arrived.frame.header().sequence;
        match failed {
            DetectFailed::Unusable(error) => {
                tracing::warn!("frame {sequence} can not be searched: {error}");
            }
            DetectFailed::Lost(error) => tracing::error!("detection of frame {sequence}: {error}"),
        }
    }
}

/// The job that recognises views with the knowledge of now.
fn recognition(
    views: Vec<(u64, NewestView)>,
    learned: Arc<Learned>,
    config: pipeline::Config,
) -> impl FnOnce(&Progress) -> Vec<(u64, Recognised)> + Send + 'static {
    move |progress| {
        let mut recognised = Vec::with_capacity(views.len());
        let Ok(mut tools) = ObjectTools::new() else {
            return recognised;
        };
        for (track_id, view) in views {
            progress.tick();
            match view.recognise(&learned, &config, &mut tools) {
                Ok(result) => recognised.push((track_id, result)),
                Err(error) => tracing::warn!("track {track_id} keeps an old label: {error}"),
            }
        }
        recognised
    }
}
