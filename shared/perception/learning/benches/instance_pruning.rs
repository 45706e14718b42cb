//! Benchmark of instance pruning: removal of a tenth, and of nearly all views of a
//! category.

use divan::{Bencher, black_box};
use learning::redundant_views;

/// Length of a benchmarked descriptor, values.
const DIMENSION: usize = 309;

/// Number of views of the category.
const N_VIEWS: usize = 2000;

fn main() {
    divan::main();
}

/// Test views clustered around 50 centres.
fn views() -> Vec<Vec<f32>> {
    let wave = |seed: usize, i: usize| ((seed * 131 + i * i) as f64 * 0.618_034).fract();
    let value = |view: usize, i: usize| wave(view % 50, i) + 0.3 * wave(1000 + view, i);
    let view = |view| (0..DIMENSION).map(|i| value(view, i) as f32).collect();
    (0..N_VIEWS).map(view).collect()
}

#[divan::bench(args = [N_VIEWS / 10, N_VIEWS - 50])]
fn sparing(bencher: Bencher, n_to_drop: usize) {
    let views = views();
    bencher.bench(|| redundant_views(black_box(&views), n_to_drop));
}
