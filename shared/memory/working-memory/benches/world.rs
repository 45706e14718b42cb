//! Benchmarks of the world model: unchanged observation, query over 50,000 facts, opening, and
//! memory use.

use divan::{AllocProfiler, Bencher};
use tempfile::TempDir;
use working_memory::{
    BoxPose, FactQuery, Region, Sighting, WorkingMemory, WorldConfig, WorldModel,
};

#[global_allocator]
static ALLOCATOR: AllocProfiler = AllocProfiler::system();

const SECOND: u64 = 1_000_000_000;
const N_FACTS: u64 = 50_000;
const N_OBJECTS: u64 = 5;

fn main() {
    divan::main();
}

fn config() -> WorldConfig {
    WorldConfig {
        move_min_m: 0.02,
        turn_min_rad: 0.5,
        keep_ns: 7 * 86_400 * SECOND,
        n_kept_most: N_FACTS as usize,
        seen_period_ns: 10 * SECOND,
        write_buffer_bytes: working_memory::WRITE_BUFFER_BYTES,
    }
}

fn look(model: &mut WorldModel, step: u64) {
    let now_ns = SECOND * (1 + step);
    let seen = (0..N_OBJECTS).map(|track_id| Sighting {
        track_id,
        state: "tracked",
        label: Some("mug"),
        is_probable: false,
        place: BoxPose {
            position_m: [0.1 * track_id as f64, 0.05 * (step % 10) as f64, 0.7],
            orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
            size_m: [0.1; 3],
        },
        surface: None,
        first_seen_ns: SECOND,
        last_seen_ns: now_ns,
    });
    model.observe(seen, true, now_ns);
}

/// Model with 50,000 facts about moved objects.
fn filled() -> WorldModel {
    let mut model = WorldModel::new(config());
    for step in 0..N_FACTS / N_OBJECTS {
        look(&mut model, step);
    }
    model
}

#[divan::bench]
fn look_at_what_rests(bencher: Bencher<'_, '_>) {
    let mut model = filled();
    bencher.bench_local(|| look(&mut model, 19));
}

#[divan::bench]
fn ask_for_a_page_by_name_and_place(bencher: Bencher<'_, '_>) {
    let model = filled();
    let query = FactQuery {
        subject: None,
        label: Some("mug".to_owned()),
        region: Some(Region::Ball {
            centre_m: [0.2, 0.1, 0.7],
            radius_m: 0.02,
        }),
        window: None,
        before: None,
        n_most: 500,
    };
    bencher.bench_local(|| model.facts(&query));
}

#[divan::bench]
fn fill_a_model(bencher: Bencher<'_, '_>) {
    bencher.bench_local(filled);
}

#[divan::bench]
fn open_from_disk(bencher: Bencher<'_, '_>) {
    let Ok(folder) = TempDir::new() else { return };
    if let Ok((mut memory, _, _)) = WorkingMemory::open(folder.path(), config(), SECOND) {
        let written = memory.write_changes(&mut filled());
        assert!(written.is_ok());
    }
    bencher.bench_local(|| WorkingMemory::open(folder.path(), config(), SECOND).is_ok());
}
