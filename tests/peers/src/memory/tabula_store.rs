//! `shared/memory/perceptual-memory`; the only file here that knows its interface.

use std::ops::Range;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;
use std::time::Instant;

use geometry::OrientedBox;
use learning::{CategoryName, ViewId};
use nalgebra::{Isometry3, Vector3};
use perceptual_memory::{
    StoreChange, StoredDescriptor, Mutation, MutationId, PerceptualMemory, StoreConfig, StoreHandle,
    StoreThread, CapturedView,
};

use crate::figures::Run;
use crate::plan::{Beside, CLOUD_BYTES, Plan, Scenario, Step, VIEWS_PER_TRACK};

/// Values of a descriptor.
const DESCRIPTOR_VALUES: u64 = 309;
/// Bytes of descriptors in one page of the snapshot.
const PAGE_BYTES: usize = 1 << 20;
/// Views of a track in a store that is loaded, and tracks stored together there.
const LOADED_VIEWS_PER_TRACK: u32 = 10;
const LOADED_TRACKS_PER_STEP: usize = 20;

pub fn open(folder: &Path) -> PerceptualMemory {
    PerceptualMemory::open(folder, 1).expect("a store").0
}

/// Makes one step alone.
pub fn apply(memory: &mut PerceptualMemory, plan: &Plan, step: usize) {
    memory.apply(&mutation(plan, step)).expect("a change");
}

fn mutation(plan: &Plan, index: usize) -> Mutation {
    let change = match plan.step(index) {
        Step::StoreTracks(tracks) => store_tracks(tracks, VIEWS_PER_TRACK, 0),
        Step::Teach(track_id) => teach(track_id),
        Step::StoreView { track_id, view_id } => {
            StoreChange::StoreViews(vec![view(track_id, view_id, CLOUD_BYTES)])
        }
    };
    numbered(index, change)
}

/// With an id that is spread as those that clients draw, and the same in each run.
fn numbered(index: usize, change: StoreChange) -> Mutation {
    let spread = |n: u64| (n + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let high = spread(index as u64);
    Mutation {
        id: MutationId((high as u128) << 64 | spread(high) as u128),
        author: "anna".to_owned(),
        wall_ns: 1_700_000_000_000_000_000 + index as u64,
        change,
    }
}

fn store_tracks(tracks: Range<u64>, views_per_track: u32, cloud_bytes: usize) -> StoreChange {
    let views = |track| (0..views_per_track).map(move |n| view(track, n, cloud_bytes));
    StoreChange::StoreViews(tracks.flat_map(views).collect())
}

fn teach(track_id: u64) -> StoreChange {
    let category = CategoryName::new(&format!("category {}", track_id % 50)).expect("a name");
    StoreChange::Teach { track_id, category }
}

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

fn start(folder: &Path) -> (StoreThread, StoreHandle) {
    let config = StoreConfig {
        folder: folder.to_owned(),
        queue_capacity: 1024,
        limits: perceptual_memory::RetentionLimits::default(),
        write_buffer_bytes: perceptual_memory::WRITE_BUFFER_BYTES,
        wall_clock: || 1,
        on_reopened: Box::new(|_| panic!("the store had to be opened again")),
    };
    let (thread, handle, _) = StoreThread::start(config).expect("a store");
    (thread, handle)
}

/// Makes the steps without timing them.
pub fn prefill(folder: &Path, plan: &Plan) {
    let (thread, handle) = start(folder);
    for step in plan.prefill() {
        mutate(&handle, mutation(plan, step));
    }
    thread.stop().expect("stopped");
}

/// Nanoseconds of the change.
fn mutate(handle: &StoreHandle, mutation: Mutation) -> u64 {
    let begin = Instant::now();
    handle.mutate_and_wait(mutation).expect("a change");
    begin.elapsed().as_nanos() as u64
}

/// Has a compaction of everything made and waits for it.
fn compact(handle: &StoreHandle) -> bool {
    (0..PerceptualMemory::N_COMPACT_STEPS).all(|step| {
        let compacted = handle.read_and_wait(move |memory| memory.compact_step(step));
        compacted.is_ok()
    })
}

/// Times the scenario; nothing when the store does not offer what it is about.
pub fn run(folder: &Path, plan: &Plan, scenario: &Scenario) -> Option<Run> {
    let all = |steps: &Range<usize>| -> Vec<Mutation> {
        steps.clone().map(|step| mutation(plan, step)).collect()
    };
    let mutations = all(&scenario.steps);
    let busy = match &scenario.beside {
        Beside::Views(steps, _) => all(steps),
        _ => Vec::new(),
    };
    let (thread, handle) = start(folder);
    let begin = Instant::now();
    let latencies_ns = match &scenario.beside {
        Beside::Nothing => Some(mutate_all(&handle, &mutations, scenario.n_callers)),
        Beside::Views(_, n_callers) => while_busy(&handle, &mutations, || {
            mutate_all(&handle, &busy, *n_callers);
            true
        }),
        Beside::Compaction => while_busy(&handle, &mutations, || compact(&handle)),
    };
    let elapsed = begin.elapsed();
    thread.stop().expect("stopped");
    Some(Run::new(elapsed, latencies_ns?))
}

/// Makes all changes from so many threads; nanoseconds of each.
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
        let latencies = callers.into_iter().map(|c| c.join().expect("a caller"));
        latencies.flatten().collect()
    })
}

/// Makes changes for as long as `busy` runs; nothing when that says it did not.
fn while_busy(
    handle: &StoreHandle,
    mutations: &[Mutation],
    busy: impl FnOnce() -> bool + Send,
) -> Option<Vec<u64>> {
    let is_over = AtomicBool::new(false);
    thread::scope(|scope| {
        let other = scope.spawn(|| {
            let was_busy = busy();
            is_over.store(true, Ordering::Relaxed);
            was_busy
        });
        let mut latencies_ns = Vec::new();
        for mutation in mutations {
            if is_over.load(Ordering::Relaxed) {
                break;
            }
            latencies_ns.push(mutate(handle, mutation.clone()));
        }
        other.join().expect("the other").then_some(latencies_ns)
    })
}

/// Makes a store of so many labelled views.
pub fn fill(folder: &Path, n_views: usize, cloud_bytes: usize) {
    let (thread, handle) = start(folder);
    let n_tracks = n_views / LOADED_VIEWS_PER_TRACK as usize;
    let is_done = |answer: Result<_, perceptual_memory::Error>| assert!(answer.is_ok());
    let mut next_id = 0..;
    let mut change = |change| {
        let index = next_id.next().expect("a number");
        handle.mutate(numbered(index, change), is_done);
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
        // A read sees all that was asked for before it: here it only waits.
        handle.read_and_wait(|_| Ok(())).expect("a store");
    }
    thread.stop().expect("stopped");
}

/// Opens the store and keeps all labelled views; milliseconds until it was open,
/// and the views.
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
