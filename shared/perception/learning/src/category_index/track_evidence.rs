//! Evidence of a track: the different sides from which its object was seen.

use super::CategoryIndex;
use super::evidence::{Evidence, N_NEIGHBOURS};
use super::sketch::N_QUERIES_MAX;
use crate::nearest_categories::{NearestList, ScoredView};
use crate::nearest_neighbours::NearestNeighbours;
use crate::{Error, Metric, Recognition, UnknownRule, ViewId};
use std::cell::RefCell;
use std::sync::Arc;

/// Number of nearest views kept for a side; those beyond the neighbours of the regression
/// replace forgotten ones. Chosen.
const N_KEPT: usize = N_NEIGHBOURS + 32;

/// Maximum number of sides; the oldest is dropped. Chosen.
const N_SIDES_MAX: usize = 8;

/// Ratio of the change of a description to the distance of its nearest view below which
/// it is the same side. Chosen.
const CHANGE_RATIO_MAX: f32 = 0.5;

/// Change of a description below which it is the same side anyway, as long as the
/// category of its nearest view is the same. Chosen: two frames of an object at rest.
const CHANGE_MIN: f32 = 0.45;

/// Number of nearest views that are compared with a changed description.
const N_COMPARED: usize = 8;

/// Number of consecutive frames that show none of the known sides after which another side counts.
/// Chosen: six searches a second for a description that keeps changing, and none for one frame in
/// which detection cuts the object otherwise.
const SEARCH_PERIOD: u32 = 5;

/// Number of frames for which a side that is none of the lasting ones counts after it was last
/// seen: half a second. Chosen: detection cuts a crowded object in one way, then in another.
const N_FRAMES_HELD: u32 = 15;

/// Score of a category below which a side contradicts it.
const CONTRADICTION_MAX: f32 = 0.1;

/// Number of consecutive frames of contradiction after which the earlier sides are
/// dropped: half a second.
const N_CONTRADICTIONS_MAX: u32 = 15;

thread_local! {
    /// Scratch memory of a thread: the view that it recognises, as it is compared.
    static COMPARED: RefCell<[Vec<f32>; N_QUERIES_MAX]> = RefCell::default();
}

/// Use of a view in [`CategoryIndex::recognise_track`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ViewUse {
    /// View of a part of the object, which counts only while there is no other.
    Partial,
    /// View of the whole object, which counts while it is seen, and for half a second after that.
    Whole,
    /// View of the whole object at rest, which counts from now on.
    KeyView,
}

/// Evidence of one track over the different sides of its object, with the answer read from it, for
/// [`CategoryIndex::recognise_track`]. It holds a few descriptors, no views of the index. Clones
/// share the sides copy-on-write.
#[derive(Debug, Clone, PartialEq)]
pub struct TrackEvidence {
    /// Different sides, oldest first.
    sides: Vec<Arc<Side>>,
    /// Another side, in view now or half a second ago.
    current: Option<Arc<Side>>,
    /// Number of consecutive frames that show none of the sides.
    n_frames_of_others: u32,
    /// Number of frames since the current side was seen.
    n_frames_unseen: u32,
    n_contradictions: u32,
    answer: Recognition,
    /// Revision of the index and rule that the answer was read with; `None` when the sides have
    /// changed since.
    read_with: Option<(u64, UnknownRule)>,
}

/// Description of one side with its nearest stored views.
#[derive(Debug, Clone, PartialEq)]
struct Side {
    /// Description in all axis hypotheses, in the space in which it is compared.
    queries: Vec<Vec<f32>>,
    /// Revision of the index that the nearest views are those of.
    revision: u64,
    /// Nearest views, nearest first: all with a score of less than `reach`.
    nearest: Vec<ScoredView>,
    reach: f32,
    evidence: Evidence,
    /// `true` if the view showed a part of the object only.
    is_partial: bool,
}

impl Default for TrackEvidence {
    fn default() -> Self {
        Self {
            sides: Vec::new(),
            current: None,
            n_frames_of_others: 0,
            n_frames_unseen: 0,
            n_contradictions: 0,
            answer: Recognition::of_nothing(),
            read_with: None,
        }
    }
}

impl TrackEvidence {
    /// Number of different sides that count.
    pub fn n_sides(&self) -> usize {
        self.sides.len() + usize::from(self.current.is_some())
    }

    /// Last answer read from the evidence.
    pub fn recognition(&self) -> &Recognition {
        &self.answer
    }

    /// Descriptions of the sides that count, in the space in which they are compared, each in all
    /// axis hypotheses, oldest side first.
    pub fn descriptions(&self) -> impl Iterator<Item = &[Vec<f32>]> {
        self.all().map(|side| side.queries.as_slice())
    }

    fn all(&self) -> impl Iterator<Item = &Arc<Side>> + Clone {
        self.sides.iter().chain(&self.current)
    }
}

impl CategoryIndex {
    /// Recognition of a tracked object from all of its sides that were seen: different
    /// sides count, equal ones do not.
    ///
    /// The answer is that of an exhaustive search for the descriptions of the sides, at a
    /// cost independent of the index size while the object shows the same side: after a
    /// change of the index only the changed views are compared. A side that was never seen counts
    /// after five frames; so a description that keeps changing is searched for in every fifth.
    ///
    /// A side that contradicts the answer of the others for half a second replaces them.
    /// Metrics without calibration are searched exhaustively, frame by frame.
    ///
    /// # Errors
    /// As for [`insert`](Self::insert); the evidence is unchanged then.
    pub fn recognise_track<'t>(
        &self,
        queries: &[impl AsRef<[f32]>],
        view_use: ViewUse,
        rule: impl Into<UnknownRule>,
        track: &'t mut TrackEvidence,
    ) -> Result<&'t Recognition, Error> {
        let rule = rule.into();
        if !self.is_regression() || queries.is_empty() || queries.len() > N_QUERIES_MAX {
            track.answer = self.recognise_any(queries, rule)?;
            return Ok(&track.answer);
        }
        let seen = COMPARED.with_borrow_mut(|compared| {
            let compared = &mut compared[..queries.len()];
            self.compare_into(queries, compared)?;
            self.follow_changes(track);
            Ok(self.look(compared, view_use, track))
        })?;
        if self.is_current(track, rule) && track.n_contradictions == 0 {
            return Ok(&track.answer);
        }
        self.read(rule, track);
        if let Some(seen) = seen
            && view_use != ViewUse::Partial
            && self.is_replaced(seen, rule, track)
        {
            self.read(rule, track);
        }
        Ok(&track.answer)
    }

    /// True if the answer of a track was read from this state of the index, by this rule.
    pub fn is_current(&self, track: &TrackEvidence, rule: UnknownRule) -> bool {
        track.read_with == Some((self.revision, rule))
    }

    /// Reads the same evidence against a changed index or by another rule, as
    /// [`recognise_sides`](Self::recognise_sides) of its descriptions would. Without a calibration
    /// there is no evidence, and the answer stays.
    ///
    /// *Complexity*: that of the changed views; of an exhaustive search for each side when the
    /// change log does not reach back.
    pub fn reread_track(&self, rule: UnknownRule, track: &mut TrackEvidence) {
        if self.is_regression() && !self.is_current(track, rule) {
            self.follow_changes(track);
            self.read(rule, track);
        }
    }

    fn read(&self, rule: UnknownRule, track: &mut TrackEvidence) {
        track.answer = self.decide(track.all().map(|side| &side.evidence), rule);
        track.read_with = Some((self.revision, rule));
    }

    /// Brings the sides of a track up to date with the index.
    fn follow_changes(&self, track: &mut TrackEvidence) {
        for side in track.sides.iter_mut().chain(&mut track.current) {
            if side.revision != self.revision {
                self.follow_changes_of(Arc::make_mut(side));
            }
        }
    }

    fn follow_changes_of(&self, side: &mut Side) {
        let before: Vec<ViewId> = side.neighbours().map(|near| near.view).collect();
        let Some(changes) = self.changes.since(side.revision) else {
            self.search_again(side);
            return;
        };
        let mut is_changed = false;
        for view in changes {
            side.nearest.retain(|near| near.view != view);
            is_changed |= before.contains(&view);
            if let Some(row) = self.rows.get(view) {
                let scored = self.scored(row, &side.queries);
                is_changed |= side.insert(scored);
            }
        }
        side.revision = self.revision;
        if side.nearest.len() < N_NEIGHBOURS && side.reach < f32::INFINITY {
            self.search_again(side);
            return;
        }
        // Rows move when other views are removed.
        side.nearest.retain_mut(|near| {
            let row = self.rows.get(near.view);
            near.row = row.unwrap_or(near.row);
            row.is_some()
        });
        if is_changed {
            side.evidence = self.evidence(side.description(), &side.nearest);
        }
    }

    fn search_again(&self, side: &mut Side) {
        *side = Side {
            is_partial: side.is_partial,
            ..self.side(&side.queries)
        };
    }

    /// Least score of a stored view over the queries.
    fn scored(&self, row: usize, queries: &[Vec<f32>]) -> ScoredView {
        let (view, stored) = (self.views.view(row), self.views.descriptor(row));
        let score = queries.iter().fold(f32::INFINITY, |least, query| {
            let score = self.metric.bounded_score(query, stored, least);
            score.unwrap_or(least)
        });
        ScoredView {
            score,
            view: view.id,
            category: view.category,
            row,
        }
    }

    /// Side of a description: an exhaustive search.
    fn side(&self, queries: &[Vec<f32>]) -> Side {
        let mut found = NearestNeighbours::new(N_KEPT);
        self.search_all(queries, &mut found);
        Side {
            revision: self.revision,
            reach: found.worst_score(),
            nearest: found.views().to_vec(),
            evidence: self.evidence(queries.first().map(Vec::as_slice), found.views()),
            is_partial: false,
            queries: queries.to_vec(),
        }
    }

    /// Finds the side that a view shows, and adds it to the track if it is new. Returns the place
    /// of the side among the sides of the track.
    fn look(
        &self,
        queries: &[Vec<f32>],
        view_use: ViewUse,
        track: &mut TrackEvidence,
    ) -> Option<usize> {
        track.n_frames_of_others = track.n_frames_of_others.saturating_add(1);
        track.n_frames_unseen = track.n_frames_unseen.saturating_add(1);
        let is_shown = |side: &Arc<Side>| self.is_same_side(side, queries);
        if let Some(place) = track.sides.iter().position(is_shown) {
            track.n_frames_of_others = 0;
            let is_outdated =
                |side: &mut Arc<Side>| side.is_partial || track.n_frames_unseen >= N_FRAMES_HELD;
            if track.current.take_if(is_outdated).is_some() {
                track.read_with = None;
            }
            return Some(place);
        }
        let is_current = track.current.as_ref().is_some_and(is_shown);
        if is_current {
            track.n_frames_of_others = 0;
            track.n_frames_unseen = 0;
        }
        let is_first = track.n_sides() == 0;
        // Parts count only as long as the whole was never seen.
        let has_part = track.current.as_ref().is_some_and(|side| side.is_partial);
        let is_partial = view_use == ViewUse::Partial;
        let is_wanted = !is_partial || (has_part && track.sides.is_empty());
        let is_urgent = view_use == ViewUse::KeyView || (has_part && !is_partial);
        let is_due = track.n_frames_of_others >= SEARCH_PERIOD || is_urgent;
        if is_first || (!is_current && is_wanted && is_due) {
            track.current = Some(Arc::new(Side {
                is_partial,
                ..self.side(queries)
            }));
            track.n_frames_of_others = 0;
            track.n_frames_unseen = 0;
            track.read_with = None;
        }
        if view_use == ViewUse::KeyView
            && let Some(side) = track.current.take()
        {
            if track.sides.len() == N_SIDES_MAX {
                track.sides.remove(0);
            }
            track.sides.push(side);
        }
        track.n_sides().checked_sub(1)
    }

    fn is_same_side(&self, side: &Side, queries: &[Vec<f32>]) -> bool {
        let Some(described) = side.queries.first() else {
            return false;
        };
        let change = least_score(queries, described);
        // Without any taught view every side may count later.
        let nearest = side.nearest.first().map_or(0.0, |near| near.score);
        if change <= CHANGE_RATIO_MAX * CHANGE_RATIO_MAX * nearest {
            return true;
        }
        let compared = side.nearest.iter().take(N_COMPARED);
        let now = compared.min_by(|a, b| {
            let score = |near: &ScoredView| least_score(queries, self.views.descriptor(near.row));
            score(a).total_cmp(&score(b))
        });
        let category = |near: &ScoredView| near.category;
        change <= CHANGE_MIN * CHANGE_MIN && now.map(category) == side.nearest.first().map(category)
    }

    /// Drops all sides but the one in view if that contradicts the answer for long: the object was
    /// exchanged. `true` if so.
    fn is_replaced(&self, seen: usize, rule: UnknownRule, track: &mut TrackEvidence) -> bool {
        let answer = &track.answer;
        let is_contradiction = track.all().nth(seen).is_some_and(|side| {
            let alone = self.decide(std::iter::once(&side.evidence), rule);
            let is_other = alone.label.is_some() && alone.label != answer.label;
            let top = answer.nearest[0].as_ref();
            is_other
                && top.is_some_and(|top| side.evidence.score(&top.category) < CONTRADICTION_MAX)
        });
        if !is_contradiction {
            track.n_contradictions = 0;
            return false;
        }
        track.n_contradictions += 1;
        if track.n_contradictions < N_CONTRADICTIONS_MAX {
            return false;
        }
        track.n_contradictions = 0;
        if seen < track.sides.len() {
            track.sides = vec![track.sides.swap_remove(seen)];
            track.current = None;
        } else {
            track.sides.clear();
        }
        true
    }
}

impl Side {
    /// Description in the first axis hypothesis.
    fn description(&self) -> Option<&[f32]> {
        self.queries.first().map(Vec::as_slice)
    }

    fn neighbours(&self) -> impl Iterator<Item = &ScoredView> {
        self.nearest.iter().take(N_NEIGHBOURS)
    }

    /// Inserts a view if it is near enough; `true` if it is a neighbour of the regression.
    fn insert(&mut self, scored: ScoredView) -> bool {
        if scored.score >= self.reach {
            return false;
        }
        let place = self.nearest.partition_point(|near| near.precedes(&scored));
        self.nearest.insert(place, scored);
        if self.nearest.len() > N_KEPT {
            self.nearest.truncate(N_KEPT);
            self.reach = self.nearest[N_KEPT - 1].score;
        }
        place < N_NEIGHBOURS
    }
}

/// Least squared distance of several queries to one descriptor.
fn least_score(queries: &[Vec<f32>], described: &[f32]) -> f32 {
    queries.iter().fold(f32::INFINITY, |least, query| {
        let score = Metric::Euclidean.bounded_score(query, described, least);
        score.unwrap_or(least)
    })
}

#[cfg(test)]
mod tests;
