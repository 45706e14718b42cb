//! Newest view of each track, from which its label is recomputed after a change of the
//! categories.

use crate::memory_replica::{CategorySnapshot, HistoryPosition};
use crate::object_actor::ObservedView;
use learning::{CategoryName, N_NEAREST, Neighbour};
use message::ActorStamps;
use pipeline::{
    CandidateMeasurement, Config, Error, ObjectState, ObjectWorkspace, Observation, Posterior,
};
use point_cloud::Point;
use std::collections::BTreeMap;

/// Newest views by track-id.
pub(crate) type NewestViews = BTreeMap<u64, NewestView>;

/// Newest view of a track, for the scene and for relabelling.
#[derive(Debug, Clone)]
pub(crate) struct NewestView {
    /// Recognition result: label and category distances.
    pub(crate) recognised: LabelEstimate,
    /// True if the view is a key view of the latest frame.
    pub(crate) is_key_view: bool,
    /// Times at which the view passed through the object's actor.
    pub(crate) stamps: ActorStamps,
    /// Points of the object, camera frame.
    pub(crate) points: Vec<Point>,
    /// Measurement of the object, for the description.
    measured: CandidateMeasurement,
}

/// Result of a recognition, with the categories' position in the history.
#[derive(Debug, Clone)]
pub(crate) struct LabelEstimate {
    /// Category; `None` when unknown.
    pub(crate) label: Option<CategoryName>,
    /// Distance to the nearest stored view; infinite when nothing was taught.
    pub(crate) distance: f32,
    /// Probability of the best category; `None` when nothing was taught.
    pub(crate) probability: Option<f32>,
    /// Number of different sides of the object that the label rests on.
    pub(crate) n_sides: u32,
    /// Most probable categories with their nearest stored views, best first.
    pub(crate) nearest: [Option<Neighbour>; N_NEAREST],
    /// Position in the history of the memory.
    pub(crate) position: HistoryPosition,
}

impl LabelEstimate {
    fn new(posterior: Posterior, position: HistoryPosition) -> Self {
        let Posterior {
            label,
            distance,
            probability,
            n_sides,
            nearest,
            ..
        } = posterior;
        Self {
            label,
            distance,
            probability,
            n_sides: n_sides as u32,
            nearest,
            position,
        }
    }
}

impl NewestView {
    /// Moves the newest view out of an actor's answer.
    pub(crate) fn new(observed: &mut ObservedView, measured: &CandidateMeasurement) -> Self {
        Self {
            recognised: LabelEstimate::new(observed.posterior.clone(), observed.position),
            is_key_view: observed.posterior.is_key_view,
            stamps: observed.stamps,
            points: std::mem::take(&mut observed.points),
            measured: *measured,
        }
    }

    /// Recognises the view with other categories; the answer is that of a new
    /// observation.
    ///
    /// # Errors
    /// When the points cannot be described.
    pub(crate) fn recognise(
        &self,
        snapshot: &CategorySnapshot,
        config: &Config,
        tools: &mut ObjectWorkspace,
    ) -> Result<LabelEstimate, Error> {
        let mut measured = self.measured;
        // Without intrinsics, since the points are not an image.
        measured.frame.camera = None;
        let indices: Vec<u32> = (0..self.points.len() as u32).collect();
        let observation = Observation {
            cloud: &self.points,
            indices: &indices,
            measured: &measured,
        };
        // Description and recognition do not depend on the state of the object, and evidence of
        // another one must not count.
        let mut state = ObjectState::default();
        tools.forget_object();
        let mut descriptor = Vec::new();
        let posterior = state.observe(
            &observation,
            &snapshot.index,
            config,
            tools,
            &mut descriptor,
        )?;
        Ok(LabelEstimate::new(posterior, snapshot.position))
    }
}

/// Oldest position of all labels; `newest` when there are none.
pub(crate) fn oldest_position(views: &NewestViews, newest: HistoryPosition) -> HistoryPosition {
    let positions = views.values().map(|view| view.recognised.position);
    positions.fold(newest, HistoryPosition::oldest)
}
