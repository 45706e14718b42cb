//! Allocation tests: an unchanged observation allocates nothing, and reads leave nothing in memory.

use allocation_counter::CountingAllocator;
use geometry::OrientedBox;
use learning::ViewId;
use nalgebra::{Isometry3, Vector3};
use store::working::{BoxPose, RobotSighting, Sighting, WorldConfig, WorldModel};
use store::{CapturedView, Mutation, MutationId, PerceptualMemory, StoreChange, StoredDescriptor};

#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

/// Number of allocations of this thread.
fn n_allocations() -> u64 {
    CountingAllocator::counts_of_thread().0
}

const SECOND: u64 = 1_000_000_000;

fn sighting(track_id: u64, wobble_m: f64, now_ns: u64) -> Sighting<'static> {
    Sighting {
        track_id,
        state: "tracked",
        label: Some("mug"),
        place: BoxPose {
            position_m: [track_id as f64 + wobble_m, 0.0, 0.7],
            orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
            size_m: [0.1; 3],
        },
        first_seen_ns: 0,
        last_seen_ns: now_ns,
    }
}

#[test]
fn unchanged_observation_allocates_nothing() {
    let mut model = WorldModel::new(WorldConfig {
        move_min_m: 0.02,
        turn_min_rad: 0.3,
        keep_ns: 1000 * SECOND,
        n_kept_most: 1000,
        seen_period_ns: 10 * SECOND,
        write_buffer_bytes: store::WRITE_BUFFER_BYTES,
    });
    let robot = RobotSighting {
        activity: "idle",
        outcome: None,
        command_id: 1,
        note: "",
        is_holding: false,
        opening_m: 0.1,
        joint_angles_rad: &[0.0; 6],
        position_m: [0.0; 3],
        orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
    };
    let mut look = |step: u64| {
        let now_ns = SECOND + step * SECOND / 4;
        let wobble_m = f64::from(u32::try_from(step % 5).unwrap()) * 1e-3;
        let seen = (1..=20).map(|track_id| sighting(track_id, wobble_m, now_ns));
        let before = n_allocations();
        model.observe(seen, true, now_ns);
        model.observe_robot(&robot, now_ns);
        while model.expire(now_ns) {}
        n_allocations() - before
    };
    assert!(look(0) > 0, "the first look is news");
    for step in 1..30 {
        assert_eq!(look(step), 0, "step {step}");
    }
}

/// View with a point cloud whose bytes depend on the track.
fn view_with_cloud(track_id: u64, n_bytes: usize) -> CapturedView {
    CapturedView {
        id: ViewId {
            track_id,
            view_id: 0,
        },
        descriptor: StoredDescriptor {
            kind: "test".to_owned(),
            values: vec![0.5; 10],
        },
        box_in_world: OrientedBox {
            frame_from_box: Isometry3::identity(),
            half_sides_m: Vector3::repeat(0.05),
        },
        captured_ns: SECOND,
        frame_sequence: track_id,
        source: "test".to_owned(),
        mean_rgb: None,
        points: Some(vec![track_id as u8; n_bytes]),
    }
}

#[test]
fn read_content_is_not_kept_in_memory() {
    const N_TRACKS: u64 = 200;
    const CLOUD_BYTES: usize = 64_000;
    let folder = tempfile::tempdir().unwrap();
    let (mut memory, _) = PerceptualMemory::open(folder.path(), 1).unwrap();
    for track_id in 1..=N_TRACKS {
        memory.lease_track_ids(1).unwrap();
        let stored = memory.apply(&Mutation {
            id: MutationId(u128::from(track_id)),
            author: "anna".to_owned(),
            wall_ns: track_id,
            change: StoreChange::StoreViews(vec![view_with_cloud(track_id, CLOUD_BYTES)]),
        });
        stored.unwrap();
    }
    memory.close().unwrap();
    let (mut memory, _) = PerceptualMemory::open(folder.path(), 2).unwrap();
    let before = CountingAllocator::live_bytes_of_thread();
    let mut n_read = 0;
    for track_id in 1..=N_TRACKS {
        let views = memory.views_of_track(track_id).unwrap();
        n_read += views[0].view.points.as_ref().unwrap().len();
    }
    assert_eq!(n_read, N_TRACKS as usize * CLOUD_BYTES);
    let kept = CountingAllocator::live_bytes_of_thread() - before;
    assert!(kept < n_read as i64 / 5, "{kept} of {n_read} bytes kept");
}
