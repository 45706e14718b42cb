//! Benchmark: waiting times of a teacher and a reader, alone, while another caller stores point
//! clouds as fast as it can, and while the store is compacted.
//!
//! Prints the 50th and 99th percentile and the maximum, milliseconds. The write latency of the disk
//! itself is that of the teacher alone.
//!
//! Uses the folder for temporary files; set `TMPDIR` to measure another disk.

#![expect(clippy::print_stdout, reason = "prints its table")]

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use geometry::OrientedBox;
use learning::{CategoryName, ViewId};
use nalgebra::{Isometry3, Vector3};
use perceptual_memory::{
    CapturedView, MAX_LEASE, Mutation, MutationId, PerceptualMemory, Requester, RetentionLimits,
    StoreChange, StoreConfig, StoreHandle, StoreThread, StoredDescriptor, Target,
    WRITE_BUFFER_BYTES,
};

/// Length of a GOOD descriptor with fifteen bins a side.
const DESCRIPTOR_VALUES: usize = 675;
/// Size of a key view's point cloud, bytes.
const CLOUD_BYTES: usize = 30_000;
/// Views stored by one mutation.
const VIEWS_PER_MUTATION: u32 = 8;
/// Tracks that are taught and read.
const N_TRACKS: u64 = 200;
/// Time between two requests of teacher and reader.
const PAUSE: Duration = Duration::from_millis(3);
/// Duration of each phase.
const PHASE: Duration = Duration::from_secs(15);

fn main() {
    let folder = tempfile::tempdir().expect("a folder");
    let (thread, handle) = start(folder.path());
    for track in 1..=N_TRACKS {
        store(&handle, track, 0..1);
    }
    println!("{:<24}{:>8}{:>8}{:>8}{:>8}", "", "n", "p50", "p99", "max");
    measure("alone", &handle, || {
        std::thread::sleep(Duration::from_millis(100));
    });
    let next = AtomicU64::new(N_TRACKS + 1);
    measure("storing clouds", &handle, || {
        let track = next.fetch_add(1, Ordering::Relaxed);
        store(&handle, track, 0..VIEWS_PER_MUTATION);
    });
    let n_stored = (next.load(Ordering::Relaxed) - N_TRACKS - 1) * VIEWS_PER_MUTATION as u64;
    println!("stored {n_stored} clouds of {CLOUD_BYTES} bytes");
    let step = AtomicU64::new(0);
    measure("compacting", &handle, || {
        let step =
            step.fetch_add(1, Ordering::Relaxed) as usize % PerceptualMemory::N_COMPACT_STEPS;
        let compacted = handle.compact_and_wait(step);
        compacted.expect("compacted");
    });
    println!("compacted {} steps", step.into_inner());
    thread.stop().expect("stopped");
}

/// Repeats `work` for a phase while teacher and reader ask.
fn measure(name: &str, handle: &StoreHandle, work: impl Fn() + Sync) {
    let is_over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let teacher = scope.spawn(|| {
            waits(&is_over, |n| {
                let category = CategoryName::new(&format!("category {n}")).expect("a name");
                let target = Target::Track(1 + n % N_TRACKS);
                let change = StoreChange::Correct { target, category };
                handle.mutate_and_wait(mutation(change)).expect("taught");
            })
        });
        let reader = scope.spawn(|| {
            waits(&is_over, |n| {
                let track = 1 + n * 7 % N_TRACKS;
                let views = handle.read_and_wait(move |memory| memory.views_of_track(track));
                assert_eq!(views.expect("read").len(), 1);
            })
        });
        let began = Instant::now();
        while began.elapsed() < PHASE {
            work();
        }
        is_over.store(true, Ordering::Relaxed);
        for (who, thread) in [("teacher", teacher), ("reader", reader)] {
            print(&format!("{name}, {who}"), thread.join().expect("no panic"));
        }
    });
}

/// Waiting times of a caller that asks again and again.
fn waits(is_over: &AtomicBool, ask: impl Fn(u64)) -> Vec<Duration> {
    let mut waits = Vec::new();
    while !is_over.load(Ordering::Relaxed) {
        let asked = Instant::now();
        ask(waits.len() as u64);
        waits.push(asked.elapsed());
        std::thread::sleep(PAUSE);
    }
    waits
}

fn print(name: &str, mut waits: Vec<Duration>) {
    waits.sort_unstable();
    let n = waits.len();
    let at = |share: f64| waits[((n - 1) as f64 * share) as usize].as_secs_f64() * 1e3;
    println!(
        "{name:<24}{n:>8}{:>8.1}{:>8.1}{:>8.1}",
        at(0.5),
        at(0.99),
        at(1.0)
    );
}

fn wall_clock() -> u64 {
    let now = SystemTime::now().duration_since(UNIX_EPOCH);
    now.map_or(0, |now| now.as_nanos() as u64)
}

fn mutation(change: StoreChange) -> Mutation {
    Mutation {
        id: MutationId::random().expect("random bytes"),
        author: "bench".to_owned(),
        requester: Requester::default(),
        wall_ns: wall_clock(),
        change,
    }
}

fn store(handle: &StoreHandle, track_id: u64, view_ids: std::ops::Range<u32>) {
    let views = view_ids.map(|view_id| view(track_id, view_id)).collect();
    let stored = handle.mutate_and_wait(mutation(StoreChange::StoreViews(views)));
    stored.expect("stored");
}

/// View whose content no other view has.
fn view(track_id: u64, view_id: u32) -> CapturedView {
    let seed = track_id << 8 | view_id as u64;
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut byte = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state as u8
    };
    CapturedView {
        id: ViewId { track_id, view_id },
        descriptor: StoredDescriptor {
            kind: "good-published-15".to_owned(),
            values: (0..DESCRIPTOR_VALUES).map(|_| byte() as f32).collect(),
        },
        box_in_world: OrientedBox {
            frame_from_box: Isometry3::identity(),
            half_sides_m: Vector3::repeat(0.05),
        },
        captured_ns: wall_clock(),
        frame_sequence: seed,
        source: "bench".to_owned(),
        mean_rgb: None,
        points: Some((0..CLOUD_BYTES).map(|_| byte()).collect()),
    }
}

fn start(folder: &std::path::Path) -> (StoreThread, StoreHandle) {
    let config = StoreConfig {
        folder: folder.to_owned(),
        queue_capacity: 1024,
        limits: RetentionLimits::default(),
        write_buffer_bytes: WRITE_BUFFER_BYTES,
        wall_clock,
        on_reopened: Box::new(|report| println!("reopened: {report:?}")),
        on_notice: Box::new(|notice| println!("{notice}")),
    };
    let (thread, handle, _) = StoreThread::start(config).expect("a store");
    handle.lease_track_ids_and_wait(MAX_LEASE).expect("a lease");
    (thread, handle)
}
