//! Workload of an ageing memory: a random series of the changes that a robot and its teachers make.

use super::DAY_NS;
use geometry::OrientedBox;
use learning::{CategoryName, InvalidCategoryName, ViewId};
use nalgebra::{Isometry3, Vector3};
use perceptual_memory::{
    CapturedView, DocumentKey, DocumentKind, MemoryDocument, Mutation, MutationId, StoreChange,
    StoredDescriptor, Target,
};
use random::Random;
use std::collections::VecDeque;

/// Simulated time of the first change, nanoseconds since 1970.
pub(super) const START_NS: u64 = 1_700_000_000_000_000_000;
/// Simulated time between two changes: twenty a minute.
pub(super) const CHANGE_PERIOD_NS: u64 = 3_000_000_000;

/// Number of recent tracks that teachers refer to.
const N_RECENT_TRACKS: usize = 256;
/// Length of a descriptor; a short one, since its length does not affect what ages.
const DESCRIPTOR_VALUES: usize = 8;
const N_DOCUMENTS: usize = 20;

/// Random series of changes; the same seed gives the same series.
pub(super) struct Workload {
    random: Random,
    categories: Vec<CategoryName>,
    next_track_id: u64,
    end_track_id: u64,
    recent: VecDeque<u64>,
    n_mutations: u128,
    next_purge_ns: u64,
}

impl Workload {
    pub(super) fn new(seed: u64, n_categories: u32) -> Result<Self, InvalidCategoryName> {
        let name = |n| CategoryName::new(&format!("category {n}"));
        Ok(Self {
            random: Random::from_seed(seed),
            categories: (0..n_categories).map(name).collect::<Result<_, _>>()?,
            next_track_id: 0,
            end_track_id: 0,
            recent: VecDeque::new(),
            n_mutations: 0,
            next_purge_ns: START_NS + DAY_NS,
        })
    }

    /// Number of leased track-ids that no view has yet.
    pub(super) fn n_leased(&self) -> u64 {
        self.end_track_id - self.next_track_id
    }

    /// Takes a lease of track-ids; ids that are left of the one before are skipped.
    pub(super) fn lease(&mut self, first: u64, count: u64) {
        (self.next_track_id, self.end_track_id) = (first, first + count);
    }

    /// Next change: mostly a new view, else a lesson, a correction, a forgetting, an undo, or a
    /// document.
    pub(super) fn next(&mut self, wall_ns: u64) -> Mutation {
        let track_id = self.recent_track();
        let change = match (self.random.below(100), track_id) {
            (80..92, Some(track_id)) => StoreChange::Teach {
                track_id,
                category: self.category(),
            },
            (92..96, Some(track_id)) => StoreChange::Correct {
                target: Target::Track(track_id),
                category: self.category(),
            },
            (96..98, Some(track_id)) => StoreChange::Forget(Target::Track(track_id)),
            (98, Some(_)) => StoreChange::Undo { sequence: None },
            (99, _) => self.document(),
            _ => StoreChange::StoreViews(vec![self.view(wall_ns)]),
        };
        self.mutation("anna", wall_ns, change)
    }

    /// `true` once a simulated day, when purges are due.
    pub(super) fn is_purge_due(&mut self, wall_ns: u64) -> bool {
        let is_due = wall_ns >= self.next_purge_ns;
        if is_due {
            self.next_purge_ns = wall_ns + DAY_NS;
        }
        is_due
    }

    /// Change that the robot makes itself.
    pub(super) fn upkeep(&mut self, wall_ns: u64, change: StoreChange) -> Mutation {
        self.mutation("upkeep", wall_ns, change)
    }

    fn mutation(&mut self, author: &str, wall_ns: u64, change: StoreChange) -> Mutation {
        self.n_mutations += 1;
        Mutation {
            id: MutationId(self.n_mutations),
            author: author.to_owned(),
            requester: perceptual_memory::Requester::default(),
            wall_ns,
            change,
        }
    }

    fn recent_track(&mut self) -> Option<u64> {
        let n_recent = self.recent.len();
        if n_recent == 0 {
            return None;
        }
        let idx = self.random.below(n_recent);
        self.recent.get(idx).copied()
    }

    fn category(&mut self) -> CategoryName {
        let idx = self.random.below(self.categories.len());
        self.categories[idx].clone()
    }

    fn view(&mut self, wall_ns: u64) -> CapturedView {
        let track_id = self.next_track_id;
        self.next_track_id += 1;
        if self.recent.len() == N_RECENT_TRACKS {
            self.recent.pop_front();
        }
        self.recent.push_back(track_id);
        let values = (0..DESCRIPTOR_VALUES).map(|_| self.random.unit_f32());
        CapturedView {
            id: ViewId {
                track_id,
                view_id: 0,
            },
            descriptor: StoredDescriptor {
                kind: "ageing".to_owned(),
                values: values.collect(),
            },
            box_in_world: OrientedBox {
                frame_from_box: Isometry3::identity(),
                half_sides_m: Vector3::repeat(0.05),
            },
            captured_ns: wall_ns,
            frame_sequence: track_id,
            source: "ageing".to_owned(),
            mean_rgb: Some([1, 2, 3]),
            points: None,
        }
    }

    fn document(&mut self) -> StoreChange {
        StoreChange::PutDocument(MemoryDocument {
            key: DocumentKey {
                kind: DocumentKind::TaskKnowledge,
                name: format!("document {}", self.random.below(N_DOCUMENTS)).into(),
            },
            media_type: "text/plain".to_owned(),
            content: self.random.unit().to_string().into_bytes(),
        })
    }
}
