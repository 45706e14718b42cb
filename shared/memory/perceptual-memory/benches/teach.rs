//! Benchmarks: latency of teaching with one and 64 callers, loading of a snapshot, and opening.
//!
//! Uses the folder for temporary files; set `TMPDIR` to measure another disk.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{SystemTime, UNIX_EPOCH};

use divan::Bencher;
use divan::counter::ItemsCount;
use geometry::OrientedBox;
use learning::{CategoryName, ViewId};
use nalgebra::{Isometry3, Vector3};
use perceptual_memory::{
    CapturedView, Mutation, MutationId, PerceptualMemory, Requester, StoreChange, StoreConfig,
    StoreHandle, StoreThread, StoredDescriptor, Target,
};
use tempfile::TempDir;

/// Length of a GOOD descriptor with fifteen bins a side.
const DESCRIPTOR_VALUES: usize = 675;
/// Size of a key view's point cloud on a voxel grid, bytes; sixteen per point.
const CLOUD_BYTES: usize = 16 * 1000;
const N_CALLERS: usize = 64;

fn main() {
    divan::main();
}

fn wall_clock() -> u64 {
    SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .map_or(0, |now| now.as_nanos() as u64)
}

fn mutation(change: StoreChange) -> Mutation {
    static NEXT_ID: AtomicU64 = AtomicU64::new(1);
    let id = MutationId(NEXT_ID.fetch_add(1, Ordering::Relaxed) as u128);
    Mutation {
        id,
        author: "bench".to_owned(),
        requester: Requester::default(),
        wall_ns: wall_clock(),
        change,
    }
}

fn view(track_id: u64, view_id: u32, cloud_bytes: usize) -> CapturedView {
    let values = (0..DESCRIPTOR_VALUES).map(|i| (i as u64 * track_id % 97) as f32 / 97.0);
    CapturedView {
        id: ViewId { track_id, view_id },
        descriptor: StoredDescriptor {
            kind: "good-published-15".to_owned(),
            values: values.collect(),
        },
        box_in_world: OrientedBox {
            frame_from_box: Isometry3::identity(),
            half_sides_m: Vector3::repeat(0.05),
        },
        captured_ns: wall_clock(),
        frame_sequence: track_id,
        source: "bench".to_owned(),
        mean_rgb: None,
        points: (cloud_bytes > 0).then(|| vec![view_id as u8; cloud_bytes]),
    }
}

fn teach(track_id: u64, n: u64) -> Mutation {
    let category = CategoryName::new(&format!("category {n}")).expect("a name");
    let target = Target::Track(track_id);
    mutation(StoreChange::Correct { target, category })
}

/// Store with one labelled view of each of `n_tracks`.
fn filled(n_tracks: u64, cloud_bytes: usize) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let (thread, handle) = start(&folder);
    for first in (1..=n_tracks).step_by(128) {
        let tracks = first..=(first + 127).min(n_tracks);
        let views = tracks
            .clone()
            .map(|track| view(track, 0, cloud_bytes))
            .collect();
        let is_done = |answer: Result<_, perceptual_memory::Error>| assert!(answer.is_ok());
        handle.mutate(mutation(StoreChange::StoreViews(views)), is_done);
        for track in tracks {
            handle.mutate(teach(track, track % 50), is_done);
        }
        // A read sees all that was asked for before it: here it only waits.
        handle.read_and_wait(|_| Ok(())).expect("a store");
    }
    thread.stop().expect("stopped");
    folder
}

fn start(folder: &TempDir) -> (StoreThread, StoreHandle) {
    let config = StoreConfig {
        folder: folder.path().to_owned(),
        queue_capacity: 1024,
        limits: perceptual_memory::RetentionLimits::default(),
        write_buffer_bytes: perceptual_memory::WRITE_BUFFER_BYTES,
        wall_clock,
        on_reopened: Box::new(|_| {}),
        on_notice: Box::new(|_| {}),
    };
    let (thread, handle, _) = StoreThread::start(config).expect("a store");
    handle
        .lease_track_ids_and_wait(perceptual_memory::MAX_LEASE)
        .expect("a lease");
    (thread, handle)
}

#[divan::bench(sample_count = 500, sample_size = 1)]
fn teach_one_caller(bencher: Bencher) {
    let folder = filled(100, CLOUD_BYTES);
    let (_thread, handle) = start(&folder);
    let mut n = 0;
    bencher.bench_local(|| {
        n += 1;
        handle
            .mutate_and_wait(teach(1 + n % 100, 100 + n))
            .expect("taught")
    });
}

#[divan::bench(sample_count = 500, sample_size = 1)]
fn store_key_view_one_caller(bencher: Bencher) {
    let folder = filled(100, CLOUD_BYTES);
    let (_thread, handle) = start(&folder);
    let mut n = 0;
    bencher.bench_local(|| {
        n += 1;
        let views = vec![view(1000, n, CLOUD_BYTES)];
        handle
            .mutate_and_wait(mutation(StoreChange::StoreViews(views)))
            .expect("stored")
    });
}

/// Teaching by 64 concurrent callers, ten times each.
#[divan::bench(sample_count = 20, sample_size = 1)]
fn teach_64_callers(bencher: Bencher) {
    const N_EACH: u64 = 10;
    let folder = filled(100, CLOUD_BYTES);
    let (_thread, handle) = start(&folder);
    let next = AtomicU64::new(0);
    bencher
        .counter(ItemsCount::new(N_CALLERS as u64 * N_EACH))
        .bench_local(|| {
            std::thread::scope(|scope| {
                for _ in 0..N_CALLERS {
                    scope.spawn(|| {
                        for _ in 0..N_EACH {
                            let n = next.fetch_add(1, Ordering::Relaxed);
                            handle
                                .mutate_and_wait(teach(1 + n % 100, 100 + n))
                                .expect("taught");
                        }
                    });
                }
            });
        });
}

#[divan::bench(args = [1_000, 100_000], sample_count = 3, sample_size = 1)]
fn load_snapshot(bencher: Bencher, n_views: u64) {
    let folder = filled(n_views, 0);
    let (mut memory, _) = PerceptualMemory::open(folder.path(), 1).expect("a store");
    bencher.counter(ItemsCount::new(n_views)).bench_local(|| {
        let (mut cursor, mut n_loaded) = (None, 0);
        loop {
            let page = memory.snapshot(cursor, 1 << 20).expect("a page");
            n_loaded += page.views.len();
            cursor = page.next;
            if cursor.is_none() {
                break;
            }
        }
        assert_eq!(n_loaded as u64, n_views);
    });
}

#[divan::bench(args = [1_000, 100_000], sample_count = 3, sample_size = 1)]
fn open(bencher: Bencher, n_views: u64) {
    let folder = filled(n_views, 0);
    bencher.bench_local(|| PerceptualMemory::open(folder.path(), 1).expect("a store"));
}
