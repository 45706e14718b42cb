//! Live executor of the frame pipeline: detection on the worker pool, one actor for
//! each object.

use crate::body_subscriber::BodySubscribers;
use crate::detector::{DetectedFrame, DetectionError, Detector};
use crate::frame_receiver::ReceivedFrame;
use crate::frame_trace::FrameTrace;
use crate::memory_replica::CategorySnapshot;
use crate::newest_view::{NewestView, NewestViews};
use crate::object_actors::{ObjectActors, ObservedFrame, SightingOutcome};
use crate::track_ids::TrackIds;
use detection::{Detection, ExpectedTrack};
use geometry::Plane;
use message::Stage;
use pipeline::{FrameExecutor, FrameStage, ObservedTracks, Sighting};
use service::Stopwatch;
use std::sync::Arc;
use std::time::Duration;

/// State of the executor that lasts from frame to frame.
pub(crate) struct LiveState {
    pub(crate) bodies: BodySubscribers,
    pub(crate) detector: Detector,
    pub(crate) actors: ObjectActors,
    pub(crate) ids: Arc<TrackIds>,
    /// Limit of the wait for the actors' answers.
    pub(crate) actor_deadline: Duration,
    pub(crate) trace: FrameTrace,
    /// Sightings of the frame with the answers of their actors.
    pub(crate) outcomes: Vec<SightingOutcome>,
    pub(crate) newest_views: NewestViews,
}

/// Executor of one received frame.
pub(crate) struct LiveExecutor<'a> {
    state: &'a mut LiveState,
    received: &'a ReceivedFrame,
    /// Taught views that all objects of the frame are recognised with.
    taught: &'a Arc<CategorySnapshot>,
    watch: Stopwatch,
    /// End of detection, monotonic clock, nanoseconds.
    pub(crate) detected_ns: u64,
}

/// Failure that ends a frame.
#[derive(Debug)]
pub(crate) enum FrameError {
    /// Failure of the shared-memory channel.
    Channel(channel::Error),
    /// Failure of detection in the frame.
    Detection(DetectionError),
}

impl<'a> LiveExecutor<'a> {
    pub(crate) fn new(
        state: &'a mut LiveState,
        received: &'a ReceivedFrame,
        taught: &'a Arc<CategorySnapshot>,
    ) -> Self {
        Self {
            watch: Stopwatch::since(state.trace.at_ns()),
            state,
            received,
            taught,
            detected_ns: 0,
        }
    }
}

fn trace_stage(stage: FrameStage) -> Stage {
    match stage {
        FrameStage::Priors => Stage::GatherPriors,
        FrameStage::Association => Stage::Association,
    }
}

impl FrameExecutor for LiveExecutor<'_> {
    type Detected = Arc<DetectedFrame>;
    type Error = FrameError;

    fn stage_started(&mut self, _stage: FrameStage) {
        self.watch = Stopwatch::since(self.state.trace.at_ns());
    }

    fn stage_finished(&mut self, stage: FrameStage) {
        let span = self.watch.lap(trace_stage(stage), 0);
        self.state.trace.end_work(span);
    }

    fn expected_tracks(&mut self) -> &mut Vec<ExpectedTrack> {
        &mut self.state.detector.priors_mut().tracks
    }

    fn expected_surfaces(&mut self) -> &mut Vec<Plane> {
        &mut self.state.detector.priors_mut().surfaces
    }

    fn gather_priors(&mut self) -> Result<(), FrameError> {
        let LiveState {
            bodies, detector, ..
        } = &mut *self.state;
        let capture_ns = self.received.frame.header().capture_stamp_ns;
        let world_from_camera = self.received.checked.world_from_camera.as_ref();
        bodies
            .priors_at(capture_ns, world_from_camera, detector.priors_mut())
            .map_err(FrameError::Channel)
    }

    async fn detect(&mut self) -> Result<Arc<DetectedFrame>, FrameError> {
        let detected = self.state.detector.detect(self.received).await;
        let detected = detected.map_err(FrameError::Detection)?;
        self.state.trace.add_detection(&detected);
        self.detected_ns = self.state.trace.at_ns();
        Ok(Arc::new(detected))
    }

    fn detection(detected: &Arc<DetectedFrame>) -> &Detection {
        &detected.detection
    }

    fn next_track_id(&mut self) -> Option<u64> {
        self.state.ids.take()
    }

    fn track_started(&mut self, track_id: u64) {
        self.state.actors.spawn(track_id);
    }

    fn track_ended(&mut self, track_id: u64) {
        self.state.actors.dismiss(track_id);
        self.state.newest_views.remove(&track_id);
    }

    async fn observe(
        &mut self,
        detected: &Arc<DetectedFrame>,
        sightings: &[Sighting],
        mut tracks: ObservedTracks<'_>,
    ) -> Result<(), FrameError> {
        let LiveState {
            actors,
            actor_deadline,
            trace,
            outcomes,
            newest_views,
            ..
        } = &mut *self.state;
        // In lockstep a replay waits for every actor.
        let deadline = (!self.received.is_lockstep()).then_some(*actor_deadline);
        let frame = ObservedFrame {
            received: self.received,
            detected,
            taught: self.taught,
            tracks: &tracks,
        };
        actors.observe(&frame, sightings, deadline, outcomes).await;
        trace.add_observations(outcomes);
        for view in newest_views.values_mut() {
            view.is_key_view = false;
        }
        for (sighting, observed) in outcomes {
            let Some(observed) = observed else { continue };
            tracks.apply(sighting.track_id, &observed.posterior);
            let view = NewestView {
                is_key_view: observed.posterior.is_key_view,
                stamps: observed.stamps,
            };
            newest_views.insert(sighting.track_id, view);
        }
        Ok(())
    }
}
