//! Allocation test: an unchanged observation allocates nothing.

use allocation_counter::CountingAllocator;
use working_memory::{
    BoxPose, RobotSighting, Sighting, WRITE_BUFFER_BYTES, WorldConfig, WorldModel,
};

#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

const SECOND: u64 = 1_000_000_000;

/// Number of allocations of this thread since its start.
fn n_allocations() -> u64 {
    CountingAllocator::counts_of_thread().0
}

fn sighting(track_id: u64, wobble_m: f64, now_ns: u64) -> Sighting<'static> {
    Sighting {
        track_id,
        state: "tracked",
        label: Some("mug"),
        is_probable: false,
        place: BoxPose {
            position_m: [track_id as f64 + wobble_m, 0.0, 0.7],
            orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
            size_m: [0.1; 3],
        },
        surface: None,
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
        write_buffer_bytes: WRITE_BUFFER_BYTES,
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
