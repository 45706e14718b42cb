//! One object, one actor.

use crate::detector::Detected;
use crate::intake::Arrived;
use crate::learned::{HistoryPosition, SharedLearned};
use actor::{Actor, Flow, KeepLatest, Progress};
use message::control::pack_cloud;
use message::{ActorStamps, SegmentLocation, Span, Stage, points};
use pipeline::{Config, Error, Measured, ObjectState, ObjectTools, Observation, Posterior, Stages};
use point_cloud::Point;
use service::Stopwatch;
use std::sync::Arc;

/// Tracks, describes and recognises one object.
pub(crate) struct ObjectActor {
    state: ObjectState,
    tools: ObjectTools,
    context: Arc<ObjectContext>,
}

/// What all object actors share.
pub(crate) struct ObjectContext {
    pub(crate) config: Config,
    pub(crate) learned: SharedLearned,
}

/// One frame's view of the object.
#[derive(Debug)]
pub(crate) struct Observe {
    /// The frame, in shared memory.
    pub(crate) arrived: Arrived,
    /// What was detected in it.
    pub(crate) detected: Arc<Detected>,
    /// The object's place in the detection.
    pub(crate) candidate: usize,
    /// The object's track.
    pub(crate) track_id: u64,
    /// What was measured.
    pub(crate) measured: Measured,
    /// Memory for the descriptor.
    pub(crate) descriptor: Vec<f32>,
    /// Memory for the object's points.
    pub(crate) points: Vec<Point>,
    /// When it was handed over, monotonic.
    pub(crate) asked_ns: u64,
    /// Whether the actor is to panic at it.
    #[cfg(feature = "fault-injection")]
    pub(crate) is_to_panic: bool,
}

/// The actor's answer.
#[derive(Debug)]
pub(crate) struct Observed {
    pub(crate) posterior: Posterior,
    /// The descriptor of the view.
    pub(crate) descriptor: Vec<f32>,
    /// The points of a key view in the world, packed; empty for others.
    pub(crate) packed_cloud: Vec<u8>,
    /// The object's points, camera frame.
    pub(crate) points: Vec<Point>,
    /// Position in the history of the memory that the label was made with.
    pub(crate) position: HistoryPosition,
    /// Where the points were read.
    pub(crate) location: SegmentLocation,
    /// The first of them.
    pub(crate) first_point_index: u32,
    /// When the view passed the actor; answered when the frame loop has it.
    pub(crate) stamps: ActorStamps,
    /// What its stages cost, in the order of [`OBJECT_STAGES`].
    pub(crate) spans: [Span; OBJECT_STAGES.len()],
}

/// What an actor does with a view.
const OBJECT_STAGES: [Stage; 4] = [
    Stage::Tracking,
    Stage::Description,
    Stage::Recognition,
    Stage::KeyView,
];

impl Actor for ObjectActor {
    type Message = Observe;
    type Reply = Observed;
    type Checkpoint = ObjectState;
    type Context = ObjectContext;
    type Error = Error;
    type Overflow = KeepLatest;

    fn start(context: &Arc<ObjectContext>, state: ObjectState) -> Result<Self, Error> {
        let tools = ObjectTools::new()?;
        Ok(Self {
            state,
            tools,
            context: context.clone(),
        })
    }

    fn handle(&mut self, message: Observe, _: &Progress) -> Result<Flow<Observed>, Error> {
        let mut laps = Laps::start(message.track_id);
        #[cfg(feature = "fault-injection")]
        assert!(!message.is_to_panic, "a fault on purpose");
        let Observe {
            arrived,
            detected,
            candidate,
            measured,
            mut descriptor,
            points: mut own_points,
            asked_ns,
            ..
        } = message;
        let indices = match detected.detection.candidates.get(candidate) {
            Some(candidate) => detected.detection.points_of(candidate),
            None => &[],
        };
        let cloud = points(arrived.frame.items());
        let observation = Observation {
            cloud,
            indices,
            measured: &measured,
        };
        let learned = self.context.learned.get();
        let stages = Stages {
            descriptor: &mut descriptor,
            on_stage: &mut |_| laps.next(),
        };
        let posterior = self.state.observe_in_stages(
            &observation,
            &learned.index,
            &self.context.config,
            &mut self.tools,
            stages,
        )?;
        let packed_cloud = if posterior.is_key_view {
            let world_from_camera = arrived.circumstances().world_from_camera;
            pack_cloud(points_at(cloud, indices), &world_from_camera)
        } else {
            Vec::new()
        };
        own_points.clear();
        own_points.extend(points_at(cloud, indices).copied());
        laps.next();
        Ok(Flow::Continue(Observed {
            posterior,
            descriptor,
            packed_cloud,
            points: own_points,
            position: learned.position,
            location: arrived.frame.location(),
            first_point_index: indices.first().copied().unwrap_or(0),
            stamps: laps.stamps(asked_ns),
            spans: laps.spans,
        }))
    }

    fn checkpoint(&self) -> ObjectState {
        self.state.clone()
    }
}

/// The stages of one view, measured one after the other.
struct Laps {
    watch: Stopwatch,
    track_id: u64,
    n_ended: usize,
    spans: [Span; OBJECT_STAGES.len()],
}

impl Laps {
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
