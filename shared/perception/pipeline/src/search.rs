//! Tracks whose objects were not where they were expected.

use crate::frame::Measured;
use crate::track::Track;
use tracking::{
    AssignmentBuffers, AssociationConfig, DepthView, Place, TrackPhase, assign, look_cost,
};

/// What a hand takes is this fast at most, metres a second, ...
const CARRIED_M_S: f64 = 0.8;

/// ... and this much farther than that, metres, as its box is not its middle, ...
const REACH_MIN_M: f64 = 0.08;

/// ... and no farther than this.
const REACH_MAX_M: f64 = 0.5;

/// Colours as unlike as this are another object's, where the place is another.
const SIMILARITY_MIN: f64 = 0.75;

/// An object faster than this, metres a second, was being carried when it was seen
/// last: an empty place says nothing of it for a while.
const CARRIED_MIN_M_S: f64 = 0.1;

/// For this long.
const CARRIED_UNSEEN_NS: u64 = 300_000_000;

/// What a hand had so lately may be anywhere.
const HANDLED_NS: u64 = 1_000_000_000;

/// What the frame shows where a track that has no candidate can be: where it was
/// going, and where it was seen last.
pub(crate) fn unseen_place(track: &Track, now_ns: u64, view: &DepthView<'_>) -> Place {
    let ahead = view.place_of(&track.filter.box_in_world());
    let before = view.place_of(&track.posterior.box_in_world());
    let was_carried = track.was_handled(now_ns, HANDLED_NS)
        || (!track.measured.is_cut && track.posterior.velocity_m_s().norm() > CARRIED_MIN_M_S);
    match [ahead, before] {
        [Place::Free, Place::Free]
            if was_carried && track.life.missed_for_ns(now_ns) < CARRIED_UNSEEN_NS =>
        {
            Place::Unknown
        }
        [Place::Free, Place::Free] => Place::Free,
        [Place::Hidden, _] | [_, Place::Hidden] => Place::Hidden,
        // What is carried out of the image is gone, what the camera turns away
        // from is not.
        [Place::OutOfView, _] if was_carried => Place::Unknown,
        [Place::OutOfView, _] => Place::OutOfView,
        _ => Place::Unknown,
    }
}

/// Pairs tracks whose place is empty with candidates elsewhere.
#[derive(Debug, Default)]
pub(crate) struct Search {
    tracks: Vec<usize>,
    candidates: Vec<usize>,
    costs: Vec<f64>,
    assignment: AssignmentBuffers,
    pairs: Vec<(usize, usize)>,
}

impl Search {
    /// Finds the cheapest pairs of believed tracks without a place and measured
    /// candidates without a track, within reach and alike.
    pub(crate) fn pair(
        &mut self,
        tracks: &[Track],
        places: &[Option<Place>],
        measured: &[Option<Measured>],
        now_ns: u64,
        config: &AssociationConfig,
    ) {
        self.pairs.clear();
        self.tracks.clear();
        self.candidates.clear();
        let is_sought = |i: &usize| {
            let may_have_gone = match places[*i] {
                Some(Place::Free) => true,
                Some(Place::Unknown) => tracks[*i].was_handled(now_ns, HANDLED_NS),
                _ => false,
            };
            may_have_gone && tracks[*i].phase() == TrackPhase::Confirmed
        };
        self.tracks.extend((0..tracks.len()).filter(is_sought));
        self.candidates
            .extend((0..measured.len()).filter(|i| is_offered(measured[*i].as_ref())));
        if self.tracks.is_empty() || self.candidates.is_empty() {
            return;
        }
        self.costs.clear();
        for &track in &self.tracks {
            for &candidate in &self.candidates {
                let cost = measured[candidate]
                    .as_ref()
                    .and_then(|measured| cost(&tracks[track], measured, now_ns, config));
                self.costs.push(cost.unwrap_or(f64::INFINITY));
            }
        }
        let most = 2.0 + config.volume_weight * config.volume_ratio_max.ln() + config.color_weight;
        let assigned = assign(
            &self.costs,
            self.candidates.len(),
            most,
            &mut self.assignment,
        );
        let pairs = self.tracks.iter().zip(assigned);
        self.pairs.extend(
            pairs.filter_map(|(track, column)| Some((*track, self.candidates[(*column)?]))),
        );
    }

    /// The pairs found last: a track and a candidate, by their places.
    pub(crate) fn pairs(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        self.pairs.clone().into_iter()
    }
}

/// Whether a measured candidate can be an object that has moved: a hand is none.
fn is_offered(measured: Option<&Measured>) -> bool {
    measured.is_some_and(|measured| !measured.is_limb)
}

fn cost(
    track: &Track,
    measured: &Measured,
    now_ns: u64,
    config: &AssociationConfig,
) -> Option<f64> {
    let unseen_s = track.life.missed_for_ns(now_ns) as f64 * 1e-9;
    let reach_m = (REACH_MIN_M + CARRIED_M_S * unseen_s).min(REACH_MAX_M);
    let from = track.posterior.box_in_world().centre();
    let distance_m = (measured.measurement.box_in_world().centre() - from).norm();
    let (was, is) = (&track.appearance, &measured.appearance);
    let is_alike = was.colors.similarity(&is.colors) >= SIMILARITY_MIN;
    if distance_m > reach_m || !is_alike {
        return None;
    }
    Some(distance_m / reach_m + look_cost(was, is, config)?)
}
