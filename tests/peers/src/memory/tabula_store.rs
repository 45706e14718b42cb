//! The store of tabula under test: adapter from workload steps to its mutations.

use std::ops::Range;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;
use std::time::Instant;

use geometry::OrientedBox;
use learning::{CategoryName, ViewId};
use nalgebra::{Isometry3, Vector3};
use perceptual_memory::{
    CapturedView, MAX_LEASE, Mutation, MutationId, PerceptualMemory, Requester, StoreChange, StoreConfig,
    StoreHandle, StoreThread, StoredDescriptor,
};

use crate::timing::MutationTiming;
use crate::workload::{
    BackgroundLoad, CLOUD_BYTES, Scenario, VIEWS_PER_TRACK, Workload, WorkloadStep,
};

/// Length of a descriptor, in values.
const DESCRIPTOR_VALUES: u64 = 309;
/// Size of a snapshot page, in bytes of descriptors.
const PAGE_BYTES: usize = 1 << 20;
/// Views per track in the loading benchmark.
const LOADED_VIEWS_PER_TRACK: u32 = 10;
/// Tracks stored by one mutation in the loading benchmark.
const LOADED_TRACKS_PER_STEP: usize = 20;

/// Opens a new store without its thread and leases the track-ids of the workload.
pub fn open_new(folder: &Path) -> PerceptualMemory {
    let mut memory = open(folder);
    memory.lease_track_ids(MAX_LEASE).expect("a lease");
    memory
}

/// Opens the store without its thread.
fn open(folder: &Path) -> PerceptualMemory {
    PerceptualMemory::open(folder, 1).expect("a store").0
}

/// Applies one step of the workload synchronously.
pub fn apply(memory: &mut PerceptualMemory, workload: &Workload, step: usize) {
    memory.apply(&mutation(workload, step)).expect("a change");
}

/// Mutation of one step of the workload.
fn mutation(workload: &Workload, index: usize) -> Mutation {
    let change = match workload.step(index) {
        WorkloadStep::StoreTracks(tracks) => store_tracks(tracks, VIEWS_PER_TRACK, 0),
        WorkloadStep::Teach(track_id) => teach(track_id),
        WorkloadStep::StoreView { track_id, view_id } => {
            StoreChange::StoreViews(vec![view(track_id, view_id, CLOUD_BYTES)])
        }
    };
    mutation_with_id(index, change)
}

/// Mutation with a reproducible id that is spread like the random ids of clients.
fn mutation_with_id(index: usize, change: StoreChange) -> Mutation {
    let spread = |n: u64| (n + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let high = spread(index as u64);
    Mutation {
        id: MutationId((high as u128) << 64 | spread(high) as u128),
        author: "anna".to_owned(),
        requester: Requester::default(),
        wall_ns: 1_700_000_000_000_000_000 + index as u64,
        change,
    }
}

/// Change that stores the views of some tracks.
fn store_tracks(tracks: Range<u64>, views_per_track: u32, cloud_bytes: usize) -> StoreChange {
    let views = |track| (0..views_per_track).map(move |n| view(track, n, cloud_bytes));
    StoreChange::StoreViews(tracks.flat_map(views).collect())
}

/// Change that labels a track with one of 50 categories.
fn teach(track_id: u64) -> StoreChange {
    let category = CategoryName::new(&format!("category {}", track_id % 50)).expect("a name");
    StoreChange::Teach { track_id, category }
}

/// Synthetic view with a pseudo-random descriptor and a cloud of `cloud_bytes` (0: none).
fn view(track_id: u64, view_id: u32, cloud_bytes: usize) -> CapturedView {
    let noise = |i: u64| ((i + track_id * 31 + view_id as u64).wrapping_mul(0x9e37_79b9)) >> 7;
    CapturedView {
        id: ViewId { track_id, view_id },
        descriptor: StoredDescriptor {
            kind: "good-published-15".to_owned(),
            values: (0..DESCRIPTOR_VALUES).map(|i| noise(i) as f32).collect(),
        },
        box_in_world: OrientedBox {
            frame_from_box: Isometry3::identity(),
            half_sides_m: Vector3::repeat(0.05),
        },
        captured_ns: 1_700_000_000_000_000_000 + track_id,
        frame_sequence: track_id,
        source: "kinect".to_owned(),
        mean_rgb: None,
        points: (cloud_bytes > 0)
            .then(|| (0..cloud_bytes as u64).map(|i| noise(i) as u8).collect()),
    }
}

/// Starts the store thread on a new folder and leases the track-ids of the workload.
fn start_new(folder: &Path) -> (StoreThread, StoreHandle) {
    let (thread, handle) = start(folder);
    handle.lease_track_ids_and_wait(MAX_LEASE).expect("a lease");
    (thread, handle)
}

/// Starts the store thread on a folder.
fn start(folder: &Path) -> (StoreThread, StoreHandle) {
    let config = StoreConfig {
        folder: folder.to_owned(),
        queue_capacity: 1024,
        limits: perceptual_memory::RetentionLimits::default(),
        write_buffer_bytes: perceptual_memory::WRITE_BUFFER_BYTES,
        wall_clock: || 1,
        on_reopened: Box::new(|_| panic!("the store was reopened after a fault")),
        on_notice: Box::new(|notice| panic!("{notice}")),
    };
    let (thread, handle, _) = StoreThread::start(config).expect("a store");
    (thread, handle)
}

/// Applies the untimed steps that precede all scenarios.
pub fn prefill(folder: &Path, workload: &Workload) {
    let (thread, handle) = start_new(folder);
    for step in workload.prefill() {
        mutate(&handle, mutation(workload, step));
    }
    thread.stop().expect("a clean stop");
}

/// Applies a mutation durably and returns its latency, nanoseconds.
fn mutate(handle: &StoreHandle, mutation: Mutation) -> u64 {
    let begin = Instant::now();
    handle.mutate_and_wait(mutation).expect("a change");
    begin.elapsed().as_nanos() as u64
}

/// Full compaction of the database; `true` if every step succeeded.
fn compact(handle: &StoreHandle) -> bool {
    (0..PerceptualMemory::N_COMPACT_STEPS).all(|step| {
        let compacted = handle.compact_and_wait(step);
        compacted.is_ok()
    })
}

/// Times a scenario; `None` if the store does not support its background load.
pub fn run(folder: &Path, workload: &Workload, scenario: &Scenario) -> Option<MutationTiming> {
    let all = |steps: &Range<usize>| -> Vec<Mutation> {
        steps.clone().map(|step| mutation(workload, step)).collect()
    };
    let mutations = all(&scenario.steps);
    let background = match &scenario.background {
        BackgroundLoad::Views(steps, _) => all(steps),
        _ => Vec::new(),
    };
    let (thread, handle) = start(folder);
    let begin = Instant::now();
    let latencies_ns = match &scenario.background {
        BackgroundLoad::Nothing => Some(mutate_all(&handle, &mutations, scenario.n_callers)),
        BackgroundLoad::Views(_, n_callers) => mutate_during(&handle, &mutations, || {
            mutate_all(&handle, &background, *n_callers);
            true
        }),
        BackgroundLoad::Compaction => mutate_during(&handle, &mutations, || compact(&handle)),
    };
    let elapsed = begin.elapsed();
    thread.stop().expect("a clean stop");
    Some(MutationTiming::new(elapsed, latencies_ns?))
}

/// Applies all mutations from `n_callers` threads and returns their latencies, nanoseconds.
fn mutate_all(handle: &StoreHandle, mutations: &[Mutation], n_callers: usize) -> Vec<u64> {
    let next = AtomicUsize::new(0);
    let caller = || {
        let mut latencies_ns = Vec::new();
        while let Some(mutation) = mutations.get(next.fetch_add(1, Ordering::Relaxed)) {
            latencies_ns.push(mutate(handle, mutation.clone()));
        }
        latencies_ns
    };
    thread::scope(|scope| {
        let callers: Vec<_> = (0..n_callers).map(|_| scope.spawn(caller)).collect();
        let latencies = callers
            .into_iter()
            .map(|c| c.join().expect("a caller without panic"));
        latencies.flatten().collect()
    })
}

/// Applies mutations while a background load runs, and returns their latencies, nanoseconds.
///
/// `None` if the load reports that it did not run.
fn mutate_during(
    handle: &StoreHandle,
    mutations: &[Mutation],
    load: impl FnOnce() -> bool + Send,
) -> Option<Vec<u64>> {
    let is_over = AtomicBool::new(false);
    thread::scope(|scope| {
        let background = scope.spawn(|| {
            let has_run = load();
            is_over.store(true, Ordering::Relaxed);
            has_run
        });
        let mut latencies_ns = Vec::new();
        for mutation in mutations {
            if is_over.load(Ordering::Relaxed) {
                break;
            }
            latencies_ns.push(mutate(handle, mutation.clone()));
        }
        background
            .join()
            .expect("a load without panic")
            .then_some(latencies_ns)
    })
}

/// Fills a new store with `n_views` labelled views.
pub fn fill(folder: &Path, n_views: usize, cloud_bytes: usize) {
    let (thread, handle) = start_new(folder);
    let n_tracks = n_views / LOADED_VIEWS_PER_TRACK as usize;
    let is_done = |answer: Result<_, perceptual_memory::Error>| assert!(answer.is_ok());
    let mut next_id = 0..;
    let mut change = |change| {
        let index = next_id.next().expect("an endless range");
        handle.mutate(mutation_with_id(index, change), is_done);
    };
    for first in (1..=n_tracks).step_by(LOADED_TRACKS_PER_STEP) {
        let end = (first + LOADED_TRACKS_PER_STEP).min(n_tracks + 1);
        let tracks = first as u64..end as u64;
        change(store_tracks(
            tracks.clone(),
            LOADED_VIEWS_PER_TRACK,
            cloud_bytes,
        ));
        tracks.for_each(|track| change(teach(track)));
        // A read runs after all earlier requests, so it is a barrier here.
        handle.read_and_wait(|_| Ok(())).expect("a store");
    }
    thread.stop().expect("a clean stop");
}

/// Loads all labelled views; returns the opening time in milliseconds, the loaded data to keep
/// alive, and the number of views.
pub fn load(folder: &Path) -> (f64, impl Sized, usize) {
    let begin = Instant::now();
    let mut memory = open(folder);
    let opening_ms = begin.elapsed().as_secs_f64() * 1e3;
    let (mut views, mut cursor) = (Vec::new(), None);
    loop {
        let page = memory.snapshot(cursor, PAGE_BYTES).expect("a page");
        views.extend(page.views);
        cursor = page.next;
        if cursor.is_none() {
            break;
        }
    }
    let n_views = views.len();
    (opening_ms, (memory, views), n_views)
}
