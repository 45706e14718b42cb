//! Duplicate tracks: two tracks of one object, of which one ends.
//!
//! Two rigid objects do not fill the same space. Tracks whose boxes overlap are therefore one
//! object until they part, unless both are seen whole, as a spoon in a mug is. The evidence
//! adds up over frames, because one bad measurement may shift a box.

use crate::track::Track;
use tracking::{ArrivalPrior, OcclusionState, fraction_inside};

/// Fraction of an unmatched track's box inside another track's measurement above which the
/// two may be duplicates. Chosen.
const CONTAINED_FRACTION_MIN: f64 = 0.8;

/// Volume ratio of the containing measurement to the contained track that a duplicate
/// requires. Chosen.
const CONTAINER_VOLUME_RATIO_MIN: f64 = 0.9;

/// Fraction of the smaller box inside the larger one above which two tracks fill the same
/// space: more of it is shared than not.
const OVERLAP_FRACTION_MIN: f64 = 0.5;

/// Volume ratio of the last measurement to the box of a track below which it was seen in
/// part: most of its box was measured as something else.
const FRAGMENT_VOLUME_RATIO_MAX: f64 = 0.5;

/// Volume ratio of two duplicates below which the smaller one is the fragment of the other;
/// above it the sizes say nothing, and the older track keeps its id.
const SIMILAR_VOLUME_RATIO_MIN: f64 = 0.5;

/// Number of frames as a duplicate, less those as a thing of its own, after which a track ends.
/// Chosen.
const N_FRAMES_DUPLICATE_MAX: u32 = 3;

/// As [`N_FRAMES_DUPLICATE_MAX`], in a scene at rest, whose frames repeat one another: the time
/// that a new track takes there. Chosen.
const N_FRAMES_DUPLICATE_MAX_AT_REST: u32 = 107;

/// Evidence of a frame on two tracks whose boxes overlap, in ascending order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum DuplicateEvidence {
    /// Both were seen, each as a thing of its own.
    Against,
    /// It says nothing of them.
    Neither,
    /// One of them is a fragment of the other, or hidden in it.
    For,
}

/// Ends the tracks that were repeatedly found to be duplicates of others.
pub(crate) fn end_duplicates(tracks: &mut [Track], prior: ArrivalPrior) {
    let n_frames_max = match prior {
        ArrivalPrior::Even => N_FRAMES_DUPLICATE_MAX,
        ArrivalPrior::SceneAtRest => N_FRAMES_DUPLICATE_MAX_AT_REST,
    };
    for i in 0..tracks.len() {
        let evidence = (0..tracks.len())
            .filter(|other| *other != i)
            .filter_map(|other| duplicate_evidence(&tracks[i], &tracks[other]))
            .max();
        let track = &mut tracks[i];
        track.n_frames_duplicate = match evidence {
            Some(DuplicateEvidence::For) => track.n_frames_duplicate + 1,
            Some(DuplicateEvidence::Neither) => track.n_frames_duplicate,
            Some(DuplicateEvidence::Against) => track.n_frames_duplicate.saturating_sub(1),
            None => 0,
        };
        if track.n_frames_duplicate >= n_frames_max {
            track.lifecycle = track.lifecycle.terminated();
            track.unmatched = None;
        }
    }
}

/// Evidence of a frame that the first track is a duplicate of the second; `None` when they have
/// parted.
fn duplicate_evidence(track: &Track, other: &Track) -> Option<DuplicateEvidence> {
    let [own, its] = [track, other].map(Track::box_in_world);
    let (small, large) = if own.volume_m3() < its.volume_m3() {
        (&own, &its)
    } else {
        (&its, &own)
    };
    if !small.bounding_spheres_meet(large, 0.0)
        || fraction_inside(small, large) < OVERLAP_FRACTION_MIN
    {
        return None;
    }
    let seen = other.measured.measurement.box_in_world();
    let is_hidden_in = track.unmatched == Some(OcclusionState::Unknown)
        && other.unmatched.is_none()
        && seen.volume_m3() >= own.volume_m3() * CONTAINER_VOLUME_RATIO_MIN
        && fraction_inside(&own, seen) >= CONTAINED_FRACTION_MIN;
    let are_fragments = is_lesser(track, other)
        && (track.unmatched.is_none() || other.unmatched.is_none())
        && (is_fragment(track) || is_fragment(other));
    Some(if is_hidden_in || are_fragments {
        DuplicateEvidence::For
    } else if track.unmatched.is_none() && other.unmatched.is_none() {
        DuplicateEvidence::Against
    } else {
        DuplicateEvidence::Neither
    })
}

/// True if the first of two duplicates is the one to end.
fn is_lesser(track: &Track, other: &Track) -> bool {
    let [own_m3, its_m3] = [track, other].map(|track| track.box_in_world().volume_m3());
    if own_m3.min(its_m3) < SIMILAR_VOLUME_RATIO_MIN * own_m3.max(its_m3) {
        own_m3 < its_m3
    } else {
        track.id > other.id
    }
}

/// True if the last measurement of a track was only a part of its box.
fn is_fragment(track: &Track) -> bool {
    let seen = track.measured.measurement.box_in_world();
    seen.volume_m3() < FRAGMENT_VOLUME_RATIO_MAX * track.box_in_world().volume_m3()
}
