//! Recovery of tracks that were moved out of their association gate.

use crate::candidate_measurement::CandidateMeasurement;
use crate::track::{MOVED_AFTER_HANDLED_NS, Track};
use tracking::{
    AssignmentBuffers, AssociationConfig, DepthView, OcclusionState, appearance_cost, assign,
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

/// Occlusion state of a track without a candidate, tested at its predicted and at its
/// last measured box.
pub(crate) fn occlusion_of_unmatched(
    track: &Track,
    now_ns: u64,
    view: &DepthView<'_>,
) -> OcclusionState {
    let ahead = view.occlusion_of(&track.filter.box_in_world());
    let before = view.occlusion_of(&track.updated_filter.box_in_world());
    let was_carried = track.was_handled(now_ns, MOVED_AFTER_HANDLED_NS)
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
    costs: Vec<f64>,
    assignment: AssignmentBuffers,
}

impl TrackRecovery {
    /// Assigns unmatched tracks to unmatched candidates within the search
    /// radius and of similar appearance, at minimum cost: the candidate of each track; none at
    /// all without tracks to recover.
    pub(crate) fn match_candidates(
        &mut self,
        tracks: &[Track],
        measured: &[Option<CandidateMeasurement>],
        now_ns: u64,
        config: &AssociationConfig,
    ) -> &[Option<usize>] {
        if !tracks.iter().any(|track| is_recoverable(track, now_ns)) {
            return &[];
        }
        self.costs.clear();
        for track in tracks {
            let is_recoverable = is_recoverable(track, now_ns);
            let cost = |measured: &Option<CandidateMeasurement>| {
                let measured = measured
                    .as_ref()
                    .filter(|one| !one.overlaps_body && is_recoverable);
                pair_cost(track, measured?, now_ns, config)
            };
            let costs = measured.iter().map(cost);
            self.costs
                .extend(costs.map(|cost| cost.unwrap_or(f64::INFINITY)));
        }
        let unassigned_cost =
            2.0 + config.volume_weight * config.volume_ratio_max.ln() + config.color_weight;
        let n_columns = measured.len();
        assign(
            &self.costs,
            n_columns,
            unassigned_cost,
            &mut self.assignment,
        )
    }
}

/// True if the object of an unmatched track may have gone elsewhere.
fn is_recoverable(track: &Track, now_ns: u64) -> bool {
    match track.unmatched {
        Some(OcclusionState::Empty) => true,
        Some(OcclusionState::Unknown) => track.was_handled(now_ns, MOVED_AFTER_HANDLED_NS),
        _ => false,
    }
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
