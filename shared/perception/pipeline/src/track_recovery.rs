//! Recovery of tracks that were moved out of their association gate.

use crate::candidate_measurement::CandidateMeasurement;
use crate::track::Track;
use tracking::{
    AssignmentBuffers, AssociationConfig, DepthView, OcclusionState, TrackPhase, appearance_cost,
    assign,
};

/// Upper limit of the speed of a hand-carried object, metres a second. Chosen.
const CARRIED_SPEED_MAX_M_S: f64 = 0.8;

/// Smallest search radius, metres; it covers the shift of the box centre. Chosen.
const SEARCH_RADIUS_MIN_M: f64 = 0.08;

/// Largest search radius, metres. Chosen.
const SEARCH_RADIUS_MAX_M: f64 = 0.5;

/// Colour similarity required of a recovered track. Chosen.
const SIMILARITY_MIN: f64 = 0.75;

/// Speed above which an object counts as carried, metres a second. Chosen.
const CARRIED_SPEED_MIN_M_S: f64 = 0.1;

/// Time for which free space does not end a carried track, nanoseconds. Chosen.
const CARRIED_GRACE_NS: u64 = 300_000_000;

/// Time after hand contact in which an object may have been moved, nanoseconds. Chosen.
const HANDLED_NS: u64 = 1_000_000_000;

/// Occlusion state of a track without a candidate, tested at its predicted and at its
/// last measured box.
pub(crate) fn occlusion_of_unmatched(
    track: &Track,
    now_ns: u64,
    view: &DepthView<'_>,
) -> OcclusionState {
    let ahead = view.occlusion_of(&track.filter.box_in_world());
    let before = view.occlusion_of(&track.updated_filter.box_in_world());
    let was_carried = track.was_handled(now_ns, HANDLED_NS)
        || (!track.measured.is_truncated
            && track.updated_filter.velocity_m_s().norm() > CARRIED_SPEED_MIN_M_S);
    match [ahead, before] {
        [OcclusionState::Empty, OcclusionState::Empty]
            if was_carried && track.lifecycle.time_since_seen_ns(now_ns) < CARRIED_GRACE_NS =>
        {
            OcclusionState::Unknown
        }
        [OcclusionState::Empty, OcclusionState::Empty] => OcclusionState::Empty,
        [OcclusionState::Occluded, _] | [_, OcclusionState::Occluded] => OcclusionState::Occluded,
        // An object carried out of the image is gone; one that the camera turned away
        // from is not.
        [OcclusionState::OutOfView, _] if was_carried => OcclusionState::Unknown,
        [OcclusionState::OutOfView, _] => OcclusionState::OutOfView,
        _ => OcclusionState::Unknown,
    }
}

/// Matcher of tracks in free space with candidates elsewhere.
#[derive(Debug, Default)]
pub(crate) struct TrackRecovery {
    tracks: Vec<usize>,
    candidates: Vec<usize>,
    costs: Vec<f64>,
    assignment: AssignmentBuffers,
    pairs: Vec<(usize, usize)>,
}

impl TrackRecovery {
    /// Assigns unmatched confirmed tracks to unmatched candidates within the search
    /// radius and of similar appearance, at minimum cost.
    pub(crate) fn match_candidates(
        &mut self,
        tracks: &[Track],
        occlusions: &[Option<OcclusionState>],
        measured: &[Option<CandidateMeasurement>],
        now_ns: u64,
        config: &AssociationConfig,
    ) {
        self.pairs.clear();
        self.tracks.clear();
        self.candidates.clear();
        let is_recoverable = |i: &usize| {
            let may_have_gone = match occlusions[*i] {
                Some(OcclusionState::Empty) => true,
                Some(OcclusionState::Unknown) => tracks[*i].was_handled(now_ns, HANDLED_NS),
                _ => false,
            };
            may_have_gone && tracks[*i].phase() == TrackPhase::Confirmed
        };
        self.tracks.extend((0..tracks.len()).filter(is_recoverable));
        self.candidates
            .extend((0..measured.len()).filter(|i| is_eligible(measured[*i].as_ref())));
        if self.tracks.is_empty() || self.candidates.is_empty() {
            return;
        }
        self.costs.clear();
        for &track in &self.tracks {
            for &candidate in &self.candidates {
                let cost = measured[candidate]
                    .as_ref()
                    .and_then(|measured| pair_cost(&tracks[track], measured, now_ns, config));
                self.costs.push(cost.unwrap_or(f64::INFINITY));
            }
        }
        let unassigned_cost =
            2.0 + config.volume_weight * config.volume_ratio_max.ln() + config.color_weight;
        let assigned = assign(
            &self.costs,
            self.candidates.len(),
            unassigned_cost,
            &mut self.assignment,
        );
        let pairs = self.tracks.iter().zip(assigned);
        self.pairs.extend(
            pairs.filter_map(|(track, column)| Some((*track, self.candidates[(*column)?]))),
        );
    }

    /// Index pairs (track, candidate) of the last call of `match_candidates`.
    pub(crate) fn pairs(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        self.pairs.clone().into_iter()
    }
}

/// True if a candidate may be a moved object, not a hand.
fn is_eligible(measured: Option<&CandidateMeasurement>) -> bool {
    measured.is_some_and(|measured| !measured.overlaps_body)
}

/// Cost of a recovered pair: distance relative to the search radius plus appearance
/// cost; `None` outside the gates.
fn pair_cost(
    track: &Track,
    measured: &CandidateMeasurement,
    now_ns: u64,
    config: &AssociationConfig,
) -> Option<f64> {
    let unseen_s = track.lifecycle.time_since_seen_ns(now_ns) as f64 * 1e-9;
    let search_radius_m =
        (SEARCH_RADIUS_MIN_M + CARRIED_SPEED_MAX_M_S * unseen_s).min(SEARCH_RADIUS_MAX_M);
    let from = track.updated_filter.box_in_world().centre();
    let distance_m = (measured.measurement.box_in_world().centre() - from).norm();
    let (was, is) = (&track.appearance, &measured.appearance);
    let is_alike = was.colors.similarity(&is.colors) >= SIMILARITY_MIN;
    if distance_m > search_radius_m || !is_alike {
        return None;
    }
    Some(distance_m / search_radius_m + appearance_cost(was, is, config)?)
}
