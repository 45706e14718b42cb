//! Local kernel ridge regression: weights of the nearest stored views.
//!
//! Nothing is trained ahead. A question is answered by regression on the stored views
//! around it, so that a lesson counts at once, a forgotten view leaves no trace, and the
//! order of teaching is irrelevant.
//!
//! *Source*: local learning is that of Bottou and Vapnik, "Local learning algorithms",
//! Neural Computation 4, 1992.

use super::view_table::ViewTable;
use crate::calibration::{Calibration, DescriptorSymmetries};
use crate::nearest_categories::ScoredView;
use nalgebra::{DMatrix, DVector, DVectorView};

/// Number of imaginary views of the background class. Chosen.
const N_BACKGROUND_VIEWS: usize = 4;

/// Regression on the neighbours of a description, in their order.
#[derive(Debug)]
pub(super) struct LocalRegression {
    /// Weights of the neighbours.
    pub(super) weights: DVector<f64>,
    /// Squared distances of the description to the neighbours or to their mirror images.
    pub(super) squared_distances: Vec<f32>,
}

/// Ridge regression on the neighbours of a description: weights `(K + r I)⁻¹ k`, where
/// `k` is the kernel between description and neighbours, `K` among the neighbours and
/// `r` the ridge. The sum over the neighbours of a category is the regression of its
/// indicator: about one for an object like them, about zero far from them.
///
/// The kernel is `exp(-d / width)` with the least distance over the axis hypotheses and their
/// mirror images. Four imaginary views of a background class, at the distance of unrelated objects
/// from everything, take part, so that a memory with few views does not claim whatever is not quite
/// unlike them.
///
/// *Complexity*: cubic in the neighbours.
pub(super) fn local_regression(
    description: &[f32],
    neighbours: &[ScoredView],
    table: &ViewTable,
    calibration: &Calibration,
) -> LocalRegression {
    let n = neighbours.len();
    let kernel =
        |squared: f32| (-f64::from(squared.max(0.0).sqrt() / calibration.kernel_width)).exp();
    let stored: Vec<&[f32]> = neighbours
        .iter()
        .map(|view| table.descriptor(view.row))
        .collect();
    let distances = SquaredDistances::new(&stored, description, calibration);
    let to_neighbours = neighbours.iter().enumerate();
    let squared_distances: Vec<f32> = to_neighbours
        .map(|(j, neighbour)| neighbour.score.min(distances.between(n, j).max(0.0)))
        .collect();
    let n_all = n + N_BACKGROUND_VIEWS;
    let background = kernel(calibration.background_distance.powi(2));
    let mut gram = DMatrix::from_element(n_all, n_all, background);
    gram.fill_diagonal(1.0 + f64::from(calibration.ridge));
    for j in 0..n {
        for i in j + 1..n {
            let value = kernel(distances.between(i, j));
            gram[(i, j)] = value;
            gram[(j, i)] = value;
        }
    }
    let of_question = squared_distances.iter().map(|squared| kernel(*squared));
    let of_question = of_question.chain(std::iter::repeat_n(background, N_BACKGROUND_VIEWS));
    let weights = solve(gram, &DVector::from_iterator(n_all, of_question));
    LocalRegression {
        weights: weights.rows(0, n).into_owned(),
        squared_distances,
    }
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

/// Squared distances among stored views and a description, the least over the axis hypotheses of
/// the second view and their mirror images.
///
/// A half turn and the mirror image only change signs of values, so the product of two views
/// follows in all four cases from the products over four classes of values: those that neither
/// changes, that one of them changes, and that both change.
struct SquaredDistances {
    /// Products over each sign class: of view `i` with turn `t` of view `j` in column
    /// `j * n_turns + t`.
    products: [DMatrix<f32>; 4],
    n_turns: usize,
    /// Squared lengths of the views, the description last.
    squared_lengths: Vec<f32>,
}

impl SquaredDistances {
    fn new(stored: &[&[f32]], description: &[f32], calibration: &Calibration) -> Self {
        let symmetries = &calibration.symmetries;
        let turns: Vec<Vec<f32>> = stored
            .iter()
            .flat_map(|view| (symmetries.turns_of)(view))
            .collect();
        let turns: Vec<&[f32]> = turns.iter().map(Vec::as_slice).collect();
        let views: Vec<&[f32]> = stored.iter().copied().chain([description]).collect();
        let products = sign_classes(description.len(), symmetries)
            .map(|places| columns_of(&places, &views).transpose() * columns_of(&places, &turns));
        Self {
            products,
            n_turns: turns.len() / stored.len().max(1),
            squared_lengths: views.iter().map(|view| squared_length(view)).collect(),
        }
    }

    /// Squared distance of view `i` to stored view `j`; the description is behind the stored views.
    fn between(&self, i: usize, j: usize) -> f32 {
        let columns = j * self.n_turns..(j + 1) * self.n_turns;
        let products = columns.map(|column| {
            let of_class = |class: &DMatrix<f32>| class[(i, column)];
            let [even, half_turn_odd, mirror_odd, both_odd] =
                self.products.each_ref().map(of_class);
            let unturned = even + half_turn_odd + (mirror_odd + both_odd).abs();
            let turned = even - half_turn_odd + (mirror_odd - both_odd).abs();
            unturned.max(turned)
        });
        let greatest = products.fold(f32::NEG_INFINITY, f32::max);
        self.squared_lengths[i] + self.squared_lengths[j] - 2.0 * greatest
    }
}

/// Places of the values that neither a half turn nor the mirror image changes, that the half turn
/// changes, that the mirror image changes, and that both change.
fn sign_classes(dimension: usize, symmetries: &DescriptorSymmetries) -> [Vec<usize>; 4] {
    let is_set = |is_odd: &[bool], place| is_odd.get(place).copied().unwrap_or(false);
    let half_turn = (symmetries.half_turn_odd_values)();
    let mirror = (symmetries.mirror_odd_values)();
    let mut classes: [Vec<usize>; 4] = Default::default();
    for place in 0..dimension {
        let class = usize::from(is_set(half_turn, place)) + 2 * usize::from(is_set(mirror, place));
        classes[class].push(place);
    }
    classes
}

/// Matrix with some values of each view as a column.
fn columns_of(places: &[usize], views: &[&[f32]]) -> DMatrix<f32> {
    let mut values = Vec::with_capacity(places.len() * views.len());
    for view in views {
        values.extend(places.iter().map(|&place| view[place]));
    }
    DMatrix::from_vec(places.len(), views.len(), values)
}

fn squared_length(values: &[f32]) -> f32 {
    DVectorView::from_slice(values, values.len()).norm_squared()
}

#[cfg(test)]
mod tests {
    use super::super::view_table::IndexedView;
    use super::*;
    use crate::{CategoryName, MemoryTerm, Metric, ViewId};

    const CALIBRATION: Calibration = Calibration {
        symmetries: DescriptorSymmetries {
            half_turn_odd_values: || &[true, true, true],
            mirror_odd_values: || &[false, true],
            ..DescriptorSymmetries::NONE
        },
        learned_metric: None,
        kernel_width: 1.5,
        ridge: 0.1,
        // Without a background.
        background_distance: f32::INFINITY,
        spread_prior: 1.0,
        score_weight: MemoryTerm::constant(8.0),
        unknown_bias: MemoryTerm::constant(4.0),
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
        let regression = local_regression(&question, &neighbours, &table, &CALIBRATION);
        let weights = regression.weights;
        // Turned by half, and mirrored by the sign of the second value.
        let distance = |a: &[f32; 3], b: &[f32; 3]| {
            let to = |turn: f32, mirror: f32| {
                let turned = [turn * b[0], turn * mirror * b[1], turn * b[2]];
                Metric::Euclidean.distance(a, &turned).unwrap()
            };
            [to(1.0, 1.0), to(1.0, -1.0), to(-1.0, 1.0), to(-1.0, -1.0)]
                .into_iter()
                .fold(f32::INFINITY, f32::min)
        };
        let kernel = |d: f32| f64::from(-d / 1.5).exp();
        for (i, view) in views.iter().enumerate() {
            let row = views.iter().enumerate().map(|(j, other)| {
                let diagonal = if i == j { 0.1 } else { 0.0 };
                (kernel(distance(view, other)) + diagonal) * weights[j]
            });
            let nearest = distance(&question, view);
            assert!((row.sum::<f64>() - kernel(nearest)).abs() < 1e-5, "{i}");
            let squared = regression.squared_distances[i];
            assert!((squared.sqrt() - nearest).abs() < 1e-5, "{i}: {squared}");
        }
    }

    #[test]
    fn a_view_stored_twice_shares_its_weight() {
        let views = [[1.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
        let (neighbours, table) = neighbours(&views[0], &views);
        let weights = local_regression(&views[0], &neighbours, &table, &CALIBRATION).weights;
        assert!((weights[0] - weights[1]).abs() < 1e-6);
        assert!((weights.sum() - 1.0 / 1.05).abs() < 1e-3, "{weights}");
    }
}
