//! Benchmark of nearest-view search with the appearance descriptor: one object in its
//! four axis hypotheses against 1 000 to 100 000 taught views, and the cost of teaching,
//! of cloning, of teaching while a clone is held, and of a whole category.
//!
//! The views show generated objects, or those in the folder named by `TABULA_VIEWS`, in
//! the Washington layout, augmented to the required number. The query objects are not
//! among the taught views.

mod views;

use description::LearnedMetric;
use divan::{Bencher, black_box};
use learning::{
    Calibration, CategoryIndex, CategoryName, DescriptorMap, DescriptorSymmetries, MemoryTerm,
    Metric, TrackEvidence, ViewId, ViewUse,
};
use std::sync::OnceLock;
use views::{N_AXIS_HYPOTHESES, View, views};

/// Number of taught views of the largest index.
const N_VIEWS: usize = 100_000;

/// One view in this number is a query and not taught.
const ONE_ASKED_OF: usize = 50;

type AxisHypotheses = [Vec<f32>; N_AXIS_HYPOTHESES];

fn main() {
    divan::main();
}

/// All views of the benchmark, described once.
fn all() -> &'static [View] {
    static VIEWS: OnceLock<Vec<View>> = OnceLock::new();
    VIEWS.get_or_init(|| views(N_VIEWS + N_VIEWS / ONE_ASKED_OF))
}

/// Calibration like that of the live system.
fn calibration() -> Calibration {
    Calibration {
        symmetries: DescriptorSymmetries {
            turns_of: |mapped| vec![mapped.to_vec(), LearnedMetric::quarter_turn(mapped)],
            half_turn_odd_values: LearnedMetric::half_turn_odd_values,
            mirror_odd_values: LearnedMetric::mirror_odd_values,
        },
        learned_metric: Some(DescriptorMap {
            dimension: LearnedMetric::DIMENSION,
            map: LearnedMetric::map,
        }),
        kernel_width: 2.5,
        ridge: 0.03,
        background_distance: 2.2,
        spread_prior: 0.75,
        score_weight: MemoryTerm::constant(8.0),
        unknown_bias: MemoryTerm::constant(4.0),
        unknown_slope: 2.5,
    }
}

fn id(number: usize) -> ViewId {
    ViewId {
        track_id: number as u64,
        view_id: 0,
    }
}

/// Index with an evenly strided subset of the views, and the queries.
fn taught(n_views: usize) -> (CategoryIndex, Vec<&'static AxisHypotheses>) {
    let index = CategoryIndex::new(views::DIMENSION, Metric::Euclidean);
    let mut index = index.with_calibration(calibration());
    let is_asked = |&(number, _): &(usize, &View)| number % ONE_ASKED_OF == 7;
    let (asked, stored): (Vec<_>, Vec<_>) = all().iter().enumerate().partition(is_asked);
    for (number, view) in stored.iter().step_by(N_VIEWS / n_views) {
        let name = CategoryName::new(&view.category).expect("the name is valid");
        index
            .insert(id(*number), &name, &view.queries[0])
            .expect("the descriptor is valid");
    }
    (index, asked.iter().map(|(_, view)| &view.queries).collect())
}

#[divan::bench(args = [1000, 10_000, 100_000], sample_count = 500, sample_size = 1)]
fn recognise(bencher: Bencher<'_, '_>, n_views: usize) {
    let (index, asked) = taught(n_views);
    let mut asked = asked.into_iter().cycle();
    bencher
        .with_inputs(|| asked.next())
        .bench_local_values(|queries| {
            queries.map(|queries| index.recognise_any(black_box(queries), 1.0))
        });
}

/// Recognition of twenty objects at rest, frame by frame.
#[divan::bench(args = [1000, 10_000, 100_000], sample_count = 500, sample_size = 1)]
fn recognise_track(bencher: Bencher<'_, '_>, n_views: usize) {
    let (index, asked) = taught(n_views);
    let seen = asked.into_iter().take(20);
    let mut objects: Vec<_> = seen
        .map(|queries| (queries, TrackEvidence::default()))
        .collect();
    for (queries, track) in &mut objects {
        let _ = index.recognise_track(*queries, ViewUse::KeyView, 1.0, track);
    }
    let mut next = 0;
    bencher.bench_local(|| {
        next = (next + 1) % objects.len();
        let (queries, track) = &mut objects[next];
        index
            .recognise_track(black_box(*queries), ViewUse::Whole, 1.0, track)
            .map(|answer| answer.distance)
    });
}

#[divan::bench(args = [1000, 100_000])]
fn clone(bencher: Bencher<'_, '_>, n_views: usize) {
    let (index, _) = taught(n_views);
    bencher.bench_local(|| black_box(&index).clone());
}

/// Teaches and forgets one view, without or with a fresh clone that shares all memory.
#[divan::bench(args = [false, true])]
fn teach_and_forget(bencher: Bencher<'_, '_>, has_clone: bool) {
    let (mut index, asked) = taught(10_000);
    let name = CategoryName::new("another").expect("the name is valid");
    let new = id(usize::MAX);
    let mut clone = None;
    bencher.bench_local(|| {
        if has_clone {
            clone = Some(index.clone());
        }
        let inserted = index.insert(new, &name, black_box(&asked[0][0]));
        (inserted, index.remove_view(new))
    });
    drop(clone);
}

/// Teaches a whole category in one batch and forgets it in another.
#[divan::bench(args = [1000, 8000], sample_count = 5, sample_size = 1)]
fn teach_and_forget_category(bencher: Bencher<'_, '_>, n_views: usize) {
    let (mut index, _) = taught(1000);
    let name = CategoryName::new("another").expect("the name is valid");
    let views = &all()[..n_views];
    let new = |number: usize| id(usize::MAX - number);
    bencher.bench_local(|| {
        let mut batch = index.batch();
        let inserted: Vec<_> = views
            .iter()
            .enumerate()
            .map(|(number, view)| batch.insert(new(number), &name, &view.queries[0]))
            .collect();
        drop(batch);
        let mut batch = index.batch();
        for number in 0..n_views {
            batch.remove_view(new(number));
        }
        drop(batch);
        inserted
    });
}
