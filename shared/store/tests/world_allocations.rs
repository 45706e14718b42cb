//! Looking at a world in which nothing changes allocates nothing.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use store::working::{Place, RobotSighting, Sighting, WorldConfig, WorldModel};

thread_local! {
    static N_ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

struct Counting;

#[expect(unsafe_code, reason = "an allocator can not be written without")]
// SAFETY: everything is handed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        N_ALLOCATIONS.with(|n| n.set(n.get() + 1));
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the pointer comes from `System.alloc` above.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, new_size: usize) -> *mut u8 {
        N_ALLOCATIONS.with(|n| n.set(n.get() + 1));
        // SAFETY: the pointer comes from `System.alloc` above.
        unsafe { System.realloc(pointer, layout, new_size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

const SECOND: u64 = 1_000_000_000;

fn sighting(track_id: u64, wobble_m: f64, now_ns: u64) -> Sighting<'static> {
    Sighting {
        track_id,
        state: "tracked",
        label: Some("mug"),
        place: Place {
            position_m: [track_id as f64 + wobble_m, 0.0, 0.7],
            orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
            size_m: [0.1; 3],
        },
        first_seen_ns: 0,
        last_seen_ns: now_ns,
    }
}

#[test]
fn a_world_at_rest_allocates_nothing() {
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
        let before = N_ALLOCATIONS.get();
        model.observe(seen, true, now_ns);
        model.observe_robot(&robot, now_ns);
        while model.expire(now_ns) {}
        N_ALLOCATIONS.get() - before
    };
    assert!(look(0) > 0, "the first look is news");
    for step in 1..30 {
        assert_eq!(look(step), 0, "step {step}");
    }
}
