//! Test fixtures: views, names, mutations, stores.

use geometry::OrientedBox;
use learning::{CategoryName, ViewId};
use nalgebra::{Isometry3, Vector3};
use perceptual_memory::{
    CapturedView, Error, Mutation, MutationId, MutationReceipt, OpenReport, PerceptualMemory,
    Requester, StoreChange, StoreRefusal, StoredDescriptor, StoredView, Target,
};
use tempfile::TempDir;

/// Wall-clock time of the tests, distinct from every other number.
pub(crate) const NOW_NS: u64 = 1_700_000_000_000_000_000;

pub(crate) fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

pub(crate) fn open(folder: &TempDir) -> (PerceptualMemory, OpenReport) {
    PerceptualMemory::open(folder.path(), NOW_NS).expect("the store opens")
}

pub(crate) fn name(text: &str) -> CategoryName {
    CategoryName::new(text).expect("a category's name")
}

pub(crate) fn key(track_id: u64, view_id: u32) -> ViewId {
    ViewId { track_id, view_id }
}

/// View whose content depends only on its id and `content`.
pub(crate) fn view(track_id: u64, view_id: u32, content: u32) -> CapturedView {
    let seed = track_id as f64 + 0.25 * view_id as f64 + 100.0 * content as f64;
    CapturedView {
        id: key(track_id, view_id),
        descriptor: StoredDescriptor {
            kind: "good-published-15".to_owned(),
            values: (0..75).map(|i| (seed as f32 + i as f32).sin()).collect(),
        },
        box_in_world: OrientedBox {
            frame_from_box: Isometry3::new(
                Vector3::new(seed, -0.0, 1.0 / 3.0),
                Vector3::new(0.1, seed.cos(), -1.3),
            ),
            half_sides_m: Vector3::new(0.05, 0.0, 0.125),
        },
        captured_ns: u64::MAX - view_id as u64,
        frame_sequence: track_id ^ 7,
        source: "camera-\u{e9}".to_owned(),
        mean_rgb: (content > 0).then_some([content as u8, 2, 3]),
        points: (view_id.is_multiple_of(2))
            .then(|| vec![content as u8; 16 * (view_id as usize + 1)]),
    }
}

pub(crate) fn mutation(id: u128, change: StoreChange) -> Mutation {
    Mutation {
        id: MutationId(id),
        author: "anna".to_owned(),
        requester: Requester::administrator(1000),
        wall_ns: NOW_NS + id as u64,
        change,
    }
}

pub(crate) fn store(id: u128, views: Vec<CapturedView>) -> Mutation {
    mutation(id, StoreChange::StoreViews(views))
}

pub(crate) fn teach(id: u128, track_id: u64, category: &str) -> Mutation {
    mutation(
        id,
        StoreChange::Teach {
            track_id,
            category: name(category),
        },
    )
}

pub(crate) fn correct(id: u128, track_id: u64, category: &str) -> Mutation {
    mutation(
        id,
        StoreChange::Correct {
            target: Target::Track(track_id),
            category: name(category),
        },
    )
}

pub(crate) fn forget(id: u128, category: &str) -> Mutation {
    mutation(id, StoreChange::Forget(Target::Category(name(category))))
}

pub(crate) fn undo(id: u128, sequence: u64) -> Mutation {
    let sequence = Some(sequence);
    mutation(id, StoreChange::Undo { sequence })
}

/// Expected answer to a granted mutation.
pub(crate) fn answer(sequence: u64, n_views: u64) -> MutationReceipt {
    MutationReceipt {
        sequence,
        n_views,
        contradiction: None,
    }
}

/// Label of a stored view.
pub(crate) fn name_of(stored: &StoredView) -> Option<&str> {
    stored.standing.category().map(CategoryName::as_str)
}

/// Applies mutations that must be granted, leasing track-ids for them.
pub(crate) fn apply(memory: &mut PerceptualMemory, mutations: &[Mutation]) -> Vec<MutationReceipt> {
    let mut apply = |mutation: &Mutation| {
        lease_tracks_of(memory, mutation);
        memory.apply(mutation).expect("a granted mutation")
    };
    mutations.iter().map(&mut apply).collect()
}

/// Leases track-ids up to the last one under which the mutation stores a view.
pub(crate) fn lease_tracks_of(memory: &mut PerceptualMemory, mutation: &Mutation) {
    let StoreChange::StoreViews(views) = &mutation.change else {
        return;
    };
    let last = views.iter().map(|view| view.id.track_id).max().unwrap_or(0);
    let next = memory.stats().expect("the folder is listed").next_track_id;
    if next <= last {
        memory
            .lease_track_ids(last + 1 - next)
            .expect("a granted lease");
    }
}

/// Extracts the refusal from an error.
pub(crate) fn refusal<T: std::fmt::Debug>(result: Result<T, Error>) -> StoreRefusal {
    match result {
        Err(Error::Refused(refusal)) => refusal,
        other => panic!("expected a refusal, got {other:?}"),
    }
}

/// Violated teaching rule inside a refusal.
pub(crate) fn lesson<T: std::fmt::Debug>(result: Result<T, Error>) -> learning::TeachingError {
    match refusal(result) {
        StoreRefusal::Teaching(refusal) => refusal,
        other => panic!("expected a teaching refusal, got {other:?}"),
    }
}

/// Name and number of views of each category.
pub(crate) fn counts(memory: &PerceptualMemory) -> Vec<(String, u64)> {
    let summaries = memory.categories();
    summaries
        .iter()
        .map(|c| (c.name.as_str().to_owned(), c.n_views))
        .collect()
}

/// Temporary folder in RAM if possible, for tests that do not depend on the disk.
pub(crate) fn fast_folder() -> TempDir {
    tempfile::tempdir_in("/dev/shm").unwrap_or_else(|_| folder())
}
