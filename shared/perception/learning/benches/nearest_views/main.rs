//! One object, in its four readings, against 1 000 to 100 000 taught views of our
//! own descriptor; and what teaching, cloning and teaching beside a clone cost.
//!
//! The views are of generated objects, or of those in the folder that the variable
//! `TABULA_VIEWS` names, in the Washington layout, with points disturbed as often as
//! the number needs. The objects that are asked for are not among the taught views.

mod views;

use divan::{Bencher, black_box};
use learning::{CategoryIndex, CategoryName, Metric, Vicinity, ViewId};
use std::sync::OnceLock;
use views::{N_READINGS, View, views};

/// Taught views of the largest index.
const N_VIEWS: usize = 100_000;
/// Of so many views one is asked for and not taught.
const ONE_ASKED_OF: usize = 50;

type Readings = [Vec<f32>; N_READINGS];

fn main() {
    divan::main();
}

/// All views, described once.
fn all() -> &'static [View] {
    static VIEWS: OnceLock<Vec<View>> = OnceLock::new();
    VIEWS.get_or_init(|| views(N_VIEWS + N_VIEWS / ONE_ASKED_OF))
}

fn id(number: usize) -> ViewId {
    ViewId {
        track_id: number as u64,
        view_id: 0,
    }
}

/// An index with every so-many-th view taught, in order, and objects to ask for.
fn taught(n_views: usize) -> (CategoryIndex, Vec<&'static Readings>) {
    let mut index = CategoryIndex::new(views::DIMENSION, Metric::Euclidean);
    let is_asked = |&(number, _): &(usize, &View)| number % ONE_ASKED_OF == 7;
    let (asked, stored): (Vec<_>, Vec<_>) = all().iter().enumerate().partition(is_asked);
    for (number, view) in stored.iter().step_by(N_VIEWS / n_views) {
        let name = CategoryName::new(&view.category).expect("the name is valid");
        index
            .insert(id(*number), &name, &view.readings[0])
            .expect("the descriptor is valid");
    }
    (
        index,
        asked.iter().map(|(_, view)| &view.readings).collect(),
    )
}

#[divan::bench(args = [1000, 10_000, 100_000], sample_count = 500, sample_size = 1)]
fn recognise(bencher: Bencher<'_, '_>, n_views: usize) {
    let (index, asked) = taught(n_views);
    let mut asked = asked.into_iter().cycle();
    bencher
        .with_inputs(|| asked.next())
        .bench_local_values(|readings| {
            readings.map(|readings| index.recognise_any(black_box(readings), 1.0))
        });
}

/// Objects of which each is seen again and again, as it stands still.
#[divan::bench(args = [1000, 10_000, 100_000], sample_count = 500, sample_size = 1)]
fn recognise_again(bencher: Bencher<'_, '_>, n_views: usize) {
    let (index, asked) = taught(n_views);
    let seen = asked.into_iter().take(20);
    let mut objects: Vec<_> = seen
        .map(|readings| (readings, Vicinity::default()))
        .collect();
    for (readings, vicinity) in &mut objects {
        let _ = index.recognise_again(*readings, 1.0, vicinity);
    }
    let mut next = 0;
    bencher.bench_local(|| {
        next = (next + 1) % objects.len();
        let (readings, vicinity) = &mut objects[next];
        index.recognise_again(black_box(*readings), 1.0, vicinity)
    });
}

#[divan::bench(args = [1000, 100_000])]
fn clone(bencher: Bencher<'_, '_>, n_views: usize) {
    let (index, _) = taught(n_views);
    bencher.bench_local(|| black_box(&index).clone());
}

/// Teaches one more view and forgets it; in the second case beside a fresh clone
/// that holds all memory.
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
