//! Objects that have gone, and may come back.

use crate::track::Track;
use std::collections::VecDeque;
use tracking::Appearance;

/// An object described less often was hardly seen.
const N_VIEWS_MIN: u32 = 3;

/// As many are remembered.
const N_MAX: usize = 32;

/// For this long.
const REMEMBERED_NS: u64 = 600_000_000_000;

/// What comes back has colours at least as like as this, ...
const SIMILARITY_MIN: f64 = 0.88;

/// ... likes no other one that has gone as much, to this difference, ...
const LEAD_MIN: f64 = 0.03;

/// ... and a box as large or small by this factor.
const VOLUME_RATIO_MAX: f64 = 1.6;

/// An object that has gone.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Gone {
    /// The first id it had.
    track_id: u64,
    since_ns: u64,
    appearance: Appearance,
}

/// The objects that have gone, the last one at the end.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Departed(VecDeque<Gone>);

impl Departed {
    /// Remembers an object whose track has ended, if it was seen well.
    pub(crate) fn remember(&mut self, track: &Track, now_ns: u64) {
        if track.n_views < N_VIEWS_MIN || track.appearance.is_cut {
            return;
        }
        if self.0.len() >= N_MAX {
            self.0.pop_front();
        }
        self.0.push_back(Gone {
            track_id: track.linked_to.unwrap_or(track.id),
            since_ns: now_ns,
            appearance: track.appearance,
        });
    }

    /// The id of the object that has come back with these looks, which is then no
    /// longer gone; `None` where none, or more than one, looks like it.
    pub(crate) fn claim(&mut self, looks: &Appearance, now_ns: u64) -> Option<u64> {
        self.0
            .retain(|gone| now_ns.saturating_sub(gone.since_ns) <= REMEMBERED_NS);
        if looks.is_cut {
            return None;
        }
        let alike = |gone: &Gone| {
            let ratio = (looks.volume_m3 / gone.appearance.volume_m3).ln().abs();
            let is_sized = ratio <= VOLUME_RATIO_MAX.ln();
            let similarity = looks.colors.similarity(&gone.appearance.colors);
            if is_sized { similarity } else { 0.0 }
        };
        let mut likeness: Vec<(usize, f64)> = self.0.iter().map(alike).enumerate().collect();
        likeness.sort_by(|a, b| b.1.total_cmp(&a.1));
        let (best, similarity) = *likeness.first()?;
        let next = likeness.get(1).map_or(0.0, |(_, similarity)| *similarity);
        let is_clear = similarity >= SIMILARITY_MIN && similarity - next >= LEAD_MIN;
        if !is_clear {
            return None;
        }
        self.0.remove(best).map(|gone| gone.track_id)
    }

    /// Forgets all.
    pub(crate) fn clear(&mut self) {
        self.0.clear();
    }
}
