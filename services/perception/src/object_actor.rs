//! One object, one actor.

use crate::detector::Detected;
use crate::intake::Arrived;
use crate::learned::SharedLearned;
use actor::{Actor, Flow, KeepLatest, Progress};
use message::{SegmentLocation, points};
use pipeline::{Config, Error, Measured, ObjectState, ObjectTools, Observation, Posterior};
use std::sync::{Arc, PoisonError};

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
    /// What was measured.
    pub(crate) measured: Measured,
    /// Memory for the descriptor.
    pub(crate) descriptor: Vec<f32>,
}

/// The actor's answer.
#[derive(Debug)]
pub(crate) struct Observed {
    pub(crate) posterior: Posterior,
    /// The descriptor of the view.
    pub(crate) descriptor: Vec<f32>,
    /// History sequence of the memory the label was made with.
    pub(crate) memory_sequence: u64,
    /// Where the points were read.
    pub(crate) location: SegmentLocation,
    /// The first of them.
    pub(crate) first_point_index: u32,
    /// When the view was finished, monotonic.
    pub(crate) described_ns: u64,
}

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
        let Observe {
            arrived,
            detected,
            candidate,
            measured,
            mut descriptor,
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
        let learned = self
            .context
            .learned
            .read()
            .unwrap_or_else(PoisonError::into_inner);
        let posterior = self.state.observe(
            &observation,
            &learned.index,
            &self.context.config,
            &mut self.tools,
            &mut descriptor,
        )?;
        Ok(Flow::Continue(Observed {
            posterior,
            descriptor,
            memory_sequence: learned.sequence,
            location: arrived.frame.location(),
            first_point_index: indices.first().copied().unwrap_or(0),
            described_ns: service::monotonic_ns(),
        }))
    }

    fn checkpoint(&self) -> ObjectState {
        self.state.clone()
    }
}
