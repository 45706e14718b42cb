//! Gallery of lost tracks for re-identification by appearance.

use crate::track::Track;
use std::collections::VecDeque;
use tracking::CoarseAppearance;

/// Smallest number of described views of a track that enters the gallery. Chosen.
const N_VIEWS_MIN: u32 = 3;

/// Capacity of the gallery; the oldest entry is replaced. Chosen.
const CAPACITY: usize = 32;

/// Retention time of a lost track, nanoseconds (10 minutes). Chosen.
const RETENTION_NS: u64 = 600_000_000_000;

/// Colour similarity (Bhattacharyya coefficient) required for re-identification. Chosen.
const SIMILARITY_MIN: f64 = 0.88;

/// Lead in colour similarity over the second-best lost track that re-identification
/// requires. Chosen.
const SIMILARITY_MARGIN_MIN: f64 = 0.03;

/// Largest volume ratio of re-identified objects. Chosen.
const VOLUME_RATIO_MAX: f64 = 1.6;

/// Gallery entry of a lost track.
#[derive(Debug, Clone, Copy, PartialEq)]
struct LostTrack {
    /// Id of the first track of the object.
    track_id: u64,
    since_ns: u64,
    appearance: CoarseAppearance,
}

/// Gallery of lost tracks, oldest first.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct LostTrackGallery(VecDeque<LostTrack>);

impl LostTrackGallery {
    /// Adds a track that has ended, if it was described well enough.
    pub(crate) fn insert(&mut self, track: &Track, now_ns: u64) {
        if track.n_views < N_VIEWS_MIN || track.appearance.is_truncated {
            return;
        }
        if self.0.len() >= CAPACITY {
            self.0.pop_front();
        }
        self.0.push_back(LostTrack {
            track_id: track.reidentified_as.unwrap_or(track.id),
            since_ns: now_ns,
            appearance: track.appearance,
        });
    }

    /// Re-identifies an object by appearance and removes it from the gallery. `None`
    /// when no lost track, or more than one, looks alike.
    pub(crate) fn reidentify(&mut self, appearance: &CoarseAppearance, now_ns: u64) -> Option<u64> {
        self.0
            .retain(|lost| now_ns.saturating_sub(lost.since_ns) <= RETENTION_NS);
        if appearance.is_truncated {
            return None;
        }
        let alike = |lost: &LostTrack| {
            let ratio = (appearance.volume_m3 / lost.appearance.volume_m3)
                .ln()
                .abs();
            let is_sized = ratio <= VOLUME_RATIO_MAX.ln();
            let similarity = appearance.colors.similarity(&lost.appearance.colors);
            if is_sized { similarity } else { 0.0 }
        };
        let mut similarities: Vec<(usize, f64)> = self.0.iter().map(alike).enumerate().collect();
        similarities.sort_by(|a, b| b.1.total_cmp(&a.1));
        let (best, similarity) = *similarities.first()?;
        let next = similarities
            .get(1)
            .map_or(0.0, |(_, similarity)| *similarity);
        let is_clear = similarity >= SIMILARITY_MIN && similarity - next >= SIMILARITY_MARGIN_MIN;
        if !is_clear {
            return None;
        }
        self.0.remove(best).map(|lost| lost.track_id)
    }

    /// Removes all lost tracks from the gallery.
    pub(crate) fn clear(&mut self) {
        self.0.clear();
    }
}
