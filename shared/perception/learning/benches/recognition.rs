//! Benchmark of recognition: one query against 1 000 and 10 000 taught views of GOOD
//! with 15 bins, in 20 categories, and one pair in each metric. The descriptors are
//! sparse like those of GOOD.

use divan::{Bencher, black_box};
use learning::{CategoryIndex, CategoryName, Metric, ViewId};

const DIMENSION: usize = 675;

fn main() {
    divan::main();
}

/// Synthetic histogram with a peak in each of three parts; position and width depend on
/// the category and less on the view.
fn descriptor(category: u64, view: u64) -> Vec<f32> {
    let noise = |i: u64| ((view * 131 + i) as f64 * 0.618_034).fract();
    let mut values: Vec<f32> = (0..DIMENSION as u64)
        .map(|i| {
            let (row, column) = ((i % 225) / 15, i % 15);
            let centre = 4.0 + (category * (1 + i / 225) % 20) as f64 / 3.0;
            let away = (row as f64 - centre).hypot(column as f64 - 7.0);
            ((1.0 - away / 5.0).max(0.0) * (0.5 + noise(i))) as f32
        })
        .collect();
    for part in values.chunks_mut(225) {
        let sum: f32 = part.iter().sum();
        for value in part {
            *value /= sum;
        }
    }
    values
}

fn index(n_views: u64, metric: Metric) -> CategoryIndex {
    let mut index = CategoryIndex::new(DIMENSION, metric);
    for view in 0..n_views {
        let category = view % 20;
        let name = CategoryName::new(&format!("category {category}")).expect("the name is valid");
        let id = ViewId {
            track_id: view,
            view_id: 0,
        };
        index
            .insert(id, &name, &descriptor(category, view))
            .expect("the descriptor is valid");
    }
    index
}

fn query(bencher: Bencher<'_, '_>, n_views: u64, metric: Metric) {
    let index = index(n_views, metric);
    let query = descriptor(7, n_views + 1);
    bencher.bench_local(|| index.recognise(black_box(&query), 0.75));
}

#[divan::bench(args = [1000, 10_000])]
fn half_chi_squared_root(bencher: Bencher<'_, '_>, n_views: u64) {
    query(bencher, n_views, Metric::HalfChiSquaredRoot);
}

#[divan::bench(args = [1000, 10_000])]
fn manhattan(bencher: Bencher<'_, '_>, n_views: u64) {
    query(bencher, n_views, Metric::Manhattan);
}

/// Exhaustive comparison without early termination.
#[divan::bench(args = [1000])]
fn all_pairs_half_chi_squared_root(bencher: Bencher<'_, '_>, n_views: u64) {
    let stored: Vec<Vec<f32>> = (0..n_views)
        .map(|view| descriptor(view % 20, view))
        .collect();
    let query = descriptor(7, n_views + 1);
    bencher.bench_local(|| {
        let distance =
            |view: &Vec<f32>| Metric::HalfChiSquaredRoot.distance(black_box(&query), view);
        stored
            .iter()
            .filter_map(|view| distance(view).ok())
            .fold(f32::INFINITY, f32::min)
    });
}

/// Benchmark of the distance of one pair of descriptors.
#[divan::bench(args = Metric::ALL)]
fn pair(bencher: Bencher<'_, '_>, metric: Metric) {
    let (a, b) = (descriptor(3, 1), descriptor(4, 2));
    bencher.bench_local(|| metric.distance(black_box(&a), black_box(&b)));
}
