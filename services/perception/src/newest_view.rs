//! Newest view of each track, from which its label is recomputed when the taught views
//! have changed.

use crate::learned::{HistoryPosition, Learned};
use crate::object_actor::Observed;
use learning::{CategoryName, N_NEAREST, Neighbour};
use message::ActorStamps;
use pipeline::{Config, Error, Measured, ObjectState, ObjectTools, Observation, Posterior};
use point_cloud::Point;
use std::collections::BTreeMap;

/// The newest views, by track-id.
pub(crate) type NewestViews = BTreeMap<u64, NewestView>;

/// The newest view of a track, as the frame loop keeps it for the scene.
#[derive(Debug, Clone)]
pub(crate) struct NewestView {
    /// Result of the recognition.
    pub(crate) recognised: Recognised,
    /// True if the view is of this frame, and a key view.
    pub(crate) is_key_view: bool,
    /// Times at which it passed the actor.
    pub(crate) stamps: ActorStamps,
    /// Points of the object, camera frame.
    pub(crate) points: Vec<Point>,
    /// Measurement of the object, for the description.
    measured: Measured,
}

/// Result of a recognition, and the knowledge it was made with.
#[derive(Debug, Clone)]
pub(crate) struct Recognised {
    /// Category; `None` when unknown.
    pub(crate) label: Option<CategoryName>,
    /// Distance to the nearest stored view; infinite when nothing was taught.
    pub(crate) distance: f32,
    /// Probability of the nearest category; `None` when nothing was taught.
    pub(crate) probability: Option<f32>,
    /// Nearest stored view of each of the nearest categories, nearest first.
    pub(crate) nearest: [Option<Neighbour>; N_NEAREST],
    /// Position in the history of the memory.
    pub(crate) position: HistoryPosition,
}

impl Recognised {
    fn new(posterior: Posterior, position: HistoryPosition) -> Self {
        let Posterior {
            label,
            distance,
            probability,
            nearest,
            ..
        } = posterior;
        Self {
            label,
            distance,
            probability,
            nearest,
            position,
        }
    }
}

impl NewestView {
    /// The view of an actor's answer, whose points are moved out of it.
    pub(crate) fn new(observed: &mut Observed, measured: &Measured) -> Self {
        Self {
            recognised: Recognised::new(observed.posterior.clone(), observed.position),
            is_key_view: observed.posterior.is_key_view,
            stamps: observed.stamps,
            points: std::mem::take(&mut observed.points),
            measured: *measured,
        }
    }

    /// Recognises the view with other taught views: the same answer as if it were
    /// observed now.
    ///
    /// # Errors
    /// When the points cannot be described.
    pub(crate) fn recognise(
        &self,
        learned: &Learned,
        config: &Config,
        tools: &mut ObjectTools,
    ) -> Result<Recognised, Error> {
        let mut measured = self.measured;
        // The points are no image.
        measured.frame.camera = None;
        let indices: Vec<u32> = (0..self.points.len() as u32).collect();
        let observation = Observation {
            cloud: &self.points,
            indices: &indices,
            measured: &measured,
        };
        // Description and recognition do not depend on the state of the object.
        let mut state = ObjectState::default();
        let mut descriptor = Vec::new();
        let posterior = state.observe(
            &observation,
            &learned.index,
            config,
            tools,
            &mut descriptor,
        )?;
        Ok(Recognised::new(posterior, learned.position))
    }
}

/// The oldest knowledge that any label was made with; the newest there is when there
/// are no labels.
pub(crate) fn oldest_position(views: &NewestViews, newest: HistoryPosition) -> HistoryPosition {
    let positions = views.values().map(|view| view.recognised.position);
    positions.fold(newest, HistoryPosition::oldest)
}
