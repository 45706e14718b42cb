//! Object actor: tracking, description and recognition of one object.

use crate::detector::DetectedFrame;
use crate::frame_receiver::ReceivedFrame;
use crate::memory_replica::CategorySnapshot;
use actor::{Actor, DropOldest, Flow, Progress};
use control_protocol::pack_cloud;
use learning::TrackEvidence;
use message::{ActorStamps, SegmentLocation, Span, Stage, points};
use pipeline::{
    CandidateMeasurement, Config, Error, ObjectState, ObjectWorkspace, Observation,
    ObservationOutput, Posterior,
};
use point_cloud::Point;
use service::Stopwatch;
use std::sync::Arc;

/// Actor that owns the state of one object.
pub(crate) struct ObjectActor {
    state: ObjectState,
    workspace: ObjectWorkspace,
}

/// Message: one frame's view of the object.
#[derive(Debug)]
pub(crate) struct ObserveView {
    /// Received frame, in shared memory.
    pub(crate) received: ReceivedFrame,
    /// Detection result of the frame.
    pub(crate) detected: Arc<DetectedFrame>,
    /// Index of the object's candidate in the detection.
    pub(crate) candidate: usize,
    /// Track-id of the observed object.
    pub(crate) track_id: u64,
    /// Settings of the frame, the same for all objects in it.
    pub(crate) config: Config,
    /// Measurement of the candidate that was matched with the track.
    pub(crate) measured: CandidateMeasurement,
    /// Evidence of the track's earlier views.
    pub(crate) evidence: TrackEvidence,
    /// Taught views of the frame, the same for all objects in it.
    pub(crate) taught: Arc<CategorySnapshot>,
    /// Buffer for the descriptor, reused.
    pub(crate) descriptor: Vec<f32>,
    /// Time at which the message was sent, monotonic clock, nanoseconds.
    pub(crate) asked_ns: u64,
    /// True if the actor must panic at this message.
    #[cfg(feature = "fault-injection")]
    pub(crate) is_to_panic: bool,
}

/// Reply: the posterior and the descriptor of a view.
#[derive(Debug)]
pub(crate) struct ObservedView {
    pub(crate) posterior: Posterior,
    /// Descriptor of the observed view.
    pub(crate) descriptor: Vec<f32>,
    /// Points of a key view in the world frame, white balanced and packed; empty for other views.
    pub(crate) packed_cloud: Vec<u8>,
    /// Shared-memory location of the object's points.
    pub(crate) location: SegmentLocation,
    /// Index of the object's first point in the frame.
    pub(crate) first_point_index: u32,
    /// Times at which the view passed the actor; the frame loop adds that of the answer.
    pub(crate) stamps: ActorStamps,
    /// Time spans of the stages, in the order of [`OBJECT_STAGES`].
    pub(crate) spans: [Span; OBJECT_STAGES.len()],
}

/// Stages of an observation, in order.
const OBJECT_STAGES: [Stage; 4] = [
    Stage::Tracking,
    Stage::Description,
    Stage::Recognition,
    Stage::KeyView,
];

impl Actor for ObjectActor {
    type Message = ObserveView;
    type Reply = ObservedView;
    type Checkpoint = ObjectState;
    type Context = ();
    type Error = Error;
    type Overflow = DropOldest;

    fn start(_: &Arc<()>, state: ObjectState) -> Result<Self, Error> {
        let workspace = ObjectWorkspace::new()?;
        Ok(Self { state, workspace })
    }

    fn handle(&mut self, message: ObserveView, _: &Progress) -> Result<Flow<ObservedView>, Error> {
        let mut laps = StageTimer::start(message.track_id);
        #[cfg(feature = "fault-injection")]
        assert!(!message.is_to_panic, "a fault on purpose");
        let ObserveView {
            received,
            detected,
            candidate,
            config,
            measured,
            evidence,
            taught,
            mut descriptor,
            asked_ns,
            track_id,
            ..
        } = message;
        let indices = match detected.detection.candidates.get(candidate) {
            Some(candidate) => detected.detection.points_of(candidate),
            None => &[],
        };
        let cloud = points(received.frame.items());
        let observation = Observation {
            cloud,
            indices,
            measured: &measured,
            evidence: &evidence,
        };
        self.discard_future(&received, track_id);
        let stages = ObservationOutput {
            descriptor: &mut descriptor,
            on_stage: Some(&mut |_| laps.next()),
        };
        let posterior = self.state.observe(
            &observation,
            &taught.index,
            &config,
            &mut self.workspace,
            stages,
        )?;
        let packed_cloud = if posterior.is_key_view {
            let world_from_camera = received.frame_pose().world_from_camera;
            let points = balanced(cloud, indices, &measured);
            pack_cloud(points, &world_from_camera)
        } else {
            Vec::new()
        };
        laps.next();
        Ok(Flow::Continue(ObservedView {
            posterior,
            descriptor,
            packed_cloud,
            location: received.frame.location(),
            first_point_index: indices.first().copied().unwrap_or(0),
            stamps: laps.stamps(asked_ns),
            spans: laps.spans,
        }))
    }

    fn checkpoint(&self) -> ObjectState {
        self.state.clone()
    }
}

impl ObjectActor {
    /// Discards a checkpoint of a time after the frame.
    fn discard_future(&mut self, received: &ReceivedFrame, track_id: u64) {
        let capture_ns = received.frame_pose().capture_ns;
        if self.state.discard_future(capture_ns) {
            tracing::warn!(
                "track {track_id}: its motion was of a time after the frame of {capture_ns} ns; \
                 it starts anew"
            );
        }
    }
}

/// Lap timer for the stages of one observation.
struct StageTimer {
    watch: Stopwatch,
    track_id: u64,
    n_ended: usize,
    spans: [Span; OBJECT_STAGES.len()],
}

impl StageTimer {
    fn start(track_id: u64) -> Self {
        Self {
            watch: Stopwatch::start(),
            track_id,
            n_ended: 0,
            spans: [Span::default(); OBJECT_STAGES.len()],
        }
    }

    fn next(&mut self) {
        if let Some(stage) = OBJECT_STAGES.get(self.n_ended) {
            self.spans[self.n_ended] = self.watch.lap(*stage, self.track_id);
            self.n_ended += 1;
        }
    }

    fn stamps(&self, asked_ns: u64) -> ActorStamps {
        let [tracking, description, recognition, _] = &self.spans;
        ActorStamps {
            asked_ns,
            begun_ns: tracking.begin_ns,
            described_ns: description.end_ns,
            recognised_ns: recognition.end_ns,
            answered_ns: 0,
        }
    }
}

fn points_at<'a>(cloud: &'a [Point], indices: &'a [u32]) -> impl Iterator<Item = &'a Point> {
    indices
        .iter()
        .filter_map(|index| cloud.get(*index as usize))
}

/// Points of an object with white-balanced colours.
fn balanced<'a>(
    cloud: &'a [Point],
    indices: &'a [u32],
    measured: &CandidateMeasurement,
) -> impl Iterator<Item = Point> + use<'a> {
    let white_balance = measured.white_balance;
    points_at(cloud, indices).map(move |point| Point {
        color: white_balance.color(point.color),
        ..*point
    })
}
