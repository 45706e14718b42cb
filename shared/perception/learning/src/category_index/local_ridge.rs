//! Local kernel ridge regression: weights of the nearest stored views.
//!
//! Nothing is trained ahead. A question is answered by regression on the stored views
//! around it, so that a lesson counts at once, a forgotten view leaves no trace, and the
//! order of teaching is irrelevant.
//!
//! *Source*: local learning is that of Bottou and Vapnik, "Local learning algorithms",
//! Neural Computation 4, 1992.

use super::view_table::ViewTable;
use crate::Calibration;
use crate::nearest_categories::ScoredView;
use nalgebra::{DMatrix, DVector};

/// Number of imaginary views of the background class. Chosen.
const N_BACKGROUND_VIEWS: usize = 4;

/// Weights of the neighbours of a description, in their order: `(K + r I)⁻¹ k`, where
/// `k` is the kernel between description and neighbours, `K` among the neighbours and
/// `r` the ridge. The sum over the neighbours of a category is the regression of its
/// indicator: about one for an object like them, about zero far from them.
///
/// The kernel is `exp(-d / width)` with the least distance over the axis hypotheses. Four
/// imaginary views of a background class, at the distance of unrelated objects from everything,
/// take part, so that a memory with few views does not claim whatever is not quite unlike them.
///
/// *Complexity*: cubic in the neighbours.
pub(super) fn ridge_weights(
    neighbours: &[ScoredView],
    table: &ViewTable,
    calibration: &Calibration,
) -> DVector<f64> {
    let n = neighbours.len();
    let kernel =
        |squared: f32| (-f64::from(squared.max(0.0).sqrt() / calibration.kernel_width)).exp();
    let squared_distance = squared_distances(neighbours, table, calibration);
    let n_all = n + N_BACKGROUND_VIEWS;
    let background = kernel(calibration.background_distance.powi(2));
    let mut gram = DMatrix::from_element(n_all, n_all, background);
    gram.fill_diagonal(1.0 + f64::from(calibration.ridge));
    for j in 0..n {
        for i in j + 1..n {
            let value = kernel(squared_distance(i, j));
            gram[(i, j)] = value;
            gram[(j, i)] = value;
        }
    }
    let of_question = neighbours.iter().map(|neighbour| kernel(neighbour.score));
    let of_question = of_question.chain(std::iter::repeat_n(background, N_BACKGROUND_VIEWS));
    let weights = solve(gram, &DVector::from_iterator(n_all, of_question));
    weights.rows(0, n).into_owned()
}

/// Solution of a symmetric system. The least distance over hypotheses makes a kernel that may be
/// indefinite by a little, where the Cholesky decomposition fails.
fn solve(gram: DMatrix<f64>, of_question: &DVector<f64>) -> DVector<f64> {
    if let Some(decomposed) = gram.clone().cholesky() {
        return decomposed.solve(of_question);
    }
    let nothing = || DVector::zeros(of_question.len());
    gram.lu().solve(of_question).unwrap_or_else(nothing)
}

/// Squared distance of two stored views by their places among the neighbours, the least over the
/// axis hypotheses of the second.
fn squared_distances(
    neighbours: &[ScoredView],
    table: &ViewTable,
    calibration: &Calibration,
) -> impl Fn(usize, usize) -> f32 + use<> {
    let stored = neighbours.iter().map(|view| table.descriptor(view.row));
    let stored: Vec<&[f32]> = stored.collect();
    let dimension = stored.first().map_or(0, |view| view.len());
    let turned: Vec<Vec<f32>> = stored
        .iter()
        .flat_map(|view| (calibration.axis_hypotheses_of)(view))
        .collect();
    let n_hypotheses = turned.len() / stored.len().max(1);
    let values = stored.iter().flat_map(|view| view.iter().copied());
    let rows = DMatrix::from_row_iterator(stored.len(), dimension, values);
    let values = turned.iter().flatten().copied();
    let products = rows * DMatrix::from_iterator(dimension, turned.len(), values);
    let squared_lengths: Vec<f32> = stored.iter().map(|view| squared_length(view)).collect();
    move |i, j| {
        let products = (0..n_hypotheses).map(|h| products[(i, j * n_hypotheses + h)]);
        let greatest = products.fold(f32::NEG_INFINITY, f32::max);
        squared_lengths[i] + squared_lengths[j] - 2.0 * greatest
    }
}

fn squared_length(values: &[f32]) -> f32 {
    values.iter().map(|value| value * value).sum()
}

#[cfg(test)]
mod tests {
    use super::super::view_table::IndexedView;
    use super::*;
    use crate::{CategoryName, Metric, ViewId};

    const CALIBRATION: Calibration = Calibration {
        axis_hypotheses_of: |stored| vec![stored.to_vec(), stored.iter().map(|x| -x).collect()],
        kernel_width: 1.5,
        ridge: 0.1,
        // Without a background.
        background_distance: f32::INFINITY,
        spread_prior: 1.0,
        score_weight: 8.0,
        unknown_bias: 4.0,
        unknown_slope: 2.5,
    };

    fn neighbours(question: &[f32], views: &[[f32; 3]]) -> (Vec<ScoredView>, ViewTable) {
        let mut table = ViewTable::new(3, false);
        let mut neighbours = Vec::new();
        for (row, view) in views.iter().enumerate() {
            let id = ViewId {
                track_id: row as u64,
                view_id: 0,
            };
            let indexed = IndexedView {
                id,
                name: CategoryName::new("mug").unwrap(),
                category: 1,
            };
            table.push(indexed, view);
            let distance = Metric::Euclidean.distance(question, view).unwrap();
            neighbours.push(ScoredView {
                score: distance * distance,
                view: id,
                category: 1,
                row,
            });
        }
        (neighbours, table)
    }

    #[test]
    fn weights_solve_the_ridge_system() {
        let views = [[1.0, 0.2, 0.0], [0.9, -0.1, 0.3], [-1.0, 0.1, 0.1]];
        let question = [0.95, 0.0, 0.1];
        let (neighbours, table) = neighbours(&question, &views);
        let weights = ridge_weights(&neighbours, &table, &CALIBRATION);
        let distance = |a: &[f32; 3], b: &[f32; 3]| {
            let to = |sign: f32| {
                let turned = b.map(|x| sign * x);
                Metric::Euclidean.distance(a, &turned).unwrap()
            };
            to(1.0).min(to(-1.0))
        };
        let kernel = |d: f32| f64::from(-d / 1.5).exp();
        for (i, view) in views.iter().enumerate() {
            let row = views.iter().enumerate().map(|(j, other)| {
                let diagonal = if i == j { 0.1 } else { 0.0 };
                (kernel(distance(view, other)) + diagonal) * weights[j]
            });
            let expected = kernel(Metric::Euclidean.distance(&question, view).unwrap());
            assert!((row.sum::<f64>() - expected).abs() < 1e-5, "{i}");
        }
    }

    #[test]
    fn a_view_stored_twice_shares_its_weight() {
        let views = [[1.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
        let (neighbours, table) = neighbours(&views[0], &views);
        let weights = ridge_weights(&neighbours, &table, &CALIBRATION);
        assert!((weights[0] - weights[1]).abs() < 1e-6);
        assert!((weights.sum() - 1.0 / 1.05).abs() < 1e-3, "{weights}");
    }
}
