//! Gradient-boosted oblivious decision trees for two classes, trained level by level on
//! histograms of the features (Friedman 2002; Prokhorenkova et al. 2018).
//!
//! All nodes of a level of an oblivious tree compare the same feature with the same threshold, so
//! that a tree of depth n is n comparisons and one table.

use crate::labelled_rows::LabelledRows;
use random::Random;
use rayon::iter::ParallelIterator;
use rayon::slice::ParallelSlice;

/// Settings of the training.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoostingConfig {
    /// Number of trees.
    pub n_trees: usize,
    /// Depth of each tree: number of comparisons.
    pub depth: usize,
    /// Learning rate, 0 to 1: the share of a tree's optimal values that is added.
    pub learning_rate: f64,
    /// L2 regularisation of the leaves.
    pub lambda: f64,
    /// Least sum of the second derivatives in a leaf; a quarter of its number of examples
    /// at most.
    pub hessian_min: f64,
    /// Share of the rows, drawn anew, on which a tree is grown, 0 to 1.
    pub subsample: f64,
    /// Seed of the draws.
    pub seed: u64,
}

/// Oblivious decision tree.
#[derive(Debug, Clone, PartialEq)]
pub struct BoostedTree {
    /// Feature and threshold of each level, from the root on; a greater value goes right.
    pub splits: Vec<(usize, f32)>,
    /// Log odds of the leaves, from left to right.
    pub leaves: Vec<f64>,
}

/// Sum of trees that predicts log odds.
#[derive(Debug, Clone, PartialEq)]
pub struct BoostedTrees {
    /// Log odds without any tree.
    pub constant: f64,
    /// Trees in the order of their training.
    pub trees: Vec<BoostedTree>,
}

/// Greatest number of bins of a feature.
const N_BINS: usize = 128;

/// Number of parts in which rows are summed.
const N_PARTS: usize = 8;

/// Sums of first and second derivatives of the loss.
#[derive(Debug, Clone, Copy, Default)]
struct Derivatives {
    gradient: f64,
    hessian: f64,
}

impl Derivatives {
    fn add(&mut self, other: Self) {
        self.gradient += other.gradient;
        self.hessian += other.hessian;
    }

    fn without(self, other: Self) -> Self {
        Self {
            gradient: self.gradient - other.gradient,
            hessian: self.hessian - other.hessian,
        }
    }

    /// Decrease of the loss by the optimal value of a leaf.
    fn gain(self, lambda: f64) -> f64 {
        self.gradient * self.gradient / (self.hessian + lambda)
    }
}

/// Features in bins of about equal counts.
struct BinnedFeatures {
    n_features: usize,
    /// Upper bound of each bin but the last, per feature.
    thresholds: Vec<Vec<f32>>,
    /// Bin of each value, row by row.
    bins: Vec<u8>,
}

impl BinnedFeatures {
    fn of(examples: &LabelledRows<'_>) -> Self {
        let n_features = examples.n_features;
        let thresholds: Vec<Vec<f32>> = (0..n_features)
            .map(|feature| quantile_thresholds(examples, feature))
            .collect();
        let bins = examples.features.iter().enumerate().map(|(i, value)| {
            thresholds[i % n_features].partition_point(|threshold| threshold < value) as u8
        });
        Self {
            n_features,
            bins: bins.collect(),
            thresholds,
        }
    }
}

/// Distinct quantiles of a feature, ascending.
fn quantile_thresholds(examples: &LabelledRows<'_>, feature: usize) -> Vec<f32> {
    let values = examples.features.iter().skip(feature);
    let mut values: Vec<f32> = values.step_by(examples.n_features).copied().collect();
    values.sort_by(f32::total_cmp);
    let n = values.len();
    let mut thresholds: Vec<f32> = (1..N_BINS)
        .filter_map(|bin| values.get(bin * n / N_BINS).copied())
        .collect();
    thresholds.dedup();
    // Above the greatest value nothing is left to part.
    if thresholds.last() == values.last() {
        thresholds.pop();
    }
    thresholds
}

impl BoostedTrees {
    /// Train trees on examples by Newton steps on the logistic loss; `after_tree` is called
    /// with the trees so far after each one.
    ///
    /// # Panics
    /// When the number of features is not that of the rows times the number of labels.
    pub fn train(
        examples: &LabelledRows<'_>,
        config: &BoostingConfig,
        mut after_tree: impl FnMut(&Self),
    ) -> Self {
        let n = examples.labels.len();
        assert_eq!(examples.features.len(), n * examples.n_features);
        let n_true = examples.labels.iter().filter(|&&label| label).count();
        let odds = (n_true as f64 + 1.0) / ((n - n_true) as f64 + 1.0);
        let mut model = Self {
            constant: odds.ln(),
            trees: Vec::new(),
        };
        let binned = BinnedFeatures::of(examples);
        let mut log_odds = vec![model.constant; n];
        let mut random = Random::from_seed(config.seed);
        for _ in 0..config.n_trees {
            let derivatives: Vec<Derivatives> = log_odds
                .iter()
                .zip(examples.labels)
                .map(|(log_odds, &label)| {
                    let probability = 1.0 / (1.0 + (-log_odds).exp());
                    Derivatives {
                        gradient: probability - f64::from(u8::from(label)),
                        hessian: (probability * (1.0 - probability)).max(1e-9),
                    }
                })
                .collect();
            let rows: Vec<u32> = (0..n as u32)
                .filter(|_| random.unit() < config.subsample)
                .collect();
            let (tree, leaf_of) = grow_tree(&binned, &derivatives, &rows, config);
            for (log_odds, leaf) in log_odds.iter_mut().zip(leaf_of) {
                *log_odds += tree.leaves[usize::from(leaf)];
            }
            model.trees.push(tree);
            after_tree(&model);
        }
        model
    }

    /// Log odds of a row of features.
    pub fn log_odds(&self, features: &[f32]) -> f64 {
        let of_trees = self.trees.iter().map(|tree| tree.log_odds(features));
        self.constant + of_trees.sum::<f64>()
    }
}

impl BoostedTree {
    /// Log odds that the tree adds for a row of features.
    pub fn log_odds(&self, features: &[f32]) -> f64 {
        let splits = self.splits.iter();
        let leaf = splits.fold(0, |leaf, &(feature, threshold)| {
            2 * leaf + usize::from(features[feature] > threshold)
        });
        self.leaves[leaf]
    }
}

/// Grow one tree level by level on some rows; returns it with the leaf of each row.
fn grow_tree(
    binned: &BinnedFeatures,
    derivatives: &[Derivatives],
    rows: &[u32],
    config: &BoostingConfig,
) -> (BoostedTree, Vec<u16>) {
    let mut splits = Vec::new();
    let mut node_of = vec![0_u16; derivatives.len()];
    for level in 0..config.depth {
        let histograms = histograms(binned, derivatives, rows, &node_of, 1 << level);
        let split = best_split(&histograms, binned, config);
        splits.push(match split {
            Some((feature, bin)) => (feature, binned.thresholds[feature][bin]),
            None => (0, f32::MAX),
        });
        for (row, node) in node_of.iter_mut().enumerate() {
            let is_right = split.is_some_and(|(feature, bin)| {
                usize::from(binned.bins[row * binned.n_features + feature]) > bin
            });
            *node = 2 * *node + u16::from(is_right);
        }
    }
    let mut sums = vec![Derivatives::default(); 1 << config.depth];
    for &row in rows {
        sums[usize::from(node_of[row as usize])].add(derivatives[row as usize]);
    }
    let value =
        |sum: &Derivatives| -config.learning_rate * sum.gradient / (sum.hessian + config.lambda);
    let leaves = sums.iter().map(value).collect();
    (BoostedTree { splits, leaves }, node_of)
}

/// Derivatives by node, feature and bin.
///
/// The rows are summed in a fixed number of parts, on all cores, so that the result does not depend
/// on the number of cores.
fn histograms(
    binned: &BinnedFeatures,
    derivatives: &[Derivatives],
    rows: &[u32],
    node_of: &[u16],
    n_nodes: usize,
) -> Vec<Derivatives> {
    let parts: Vec<Vec<Derivatives>> = rows
        .par_chunks(rows.len().div_ceil(N_PARTS).max(1))
        .map(|rows| histograms_of_part(binned, derivatives, rows, node_of, n_nodes))
        .collect();
    let mut sum = vec![Derivatives::default(); n_nodes * binned.n_features * N_BINS];
    for part in parts {
        for (sum, own) in sum.iter_mut().zip(part) {
            sum.add(own);
        }
    }
    sum
}

/// Derivatives by node, feature and bin of some rows.
fn histograms_of_part(
    binned: &BinnedFeatures,
    derivatives: &[Derivatives],
    rows: &[u32],
    node_of: &[u16],
    n_nodes: usize,
) -> Vec<Derivatives> {
    let n_features = binned.n_features;
    let mut histograms = vec![Derivatives::default(); n_nodes * n_features * N_BINS];
    for &row in rows {
        let row = row as usize;
        let own = derivatives[row];
        let node = usize::from(node_of[row]);
        let bins = &binned.bins[row * n_features..(row + 1) * n_features];
        for (feature, &bin) in bins.iter().enumerate() {
            histograms[(node * n_features + feature) * N_BINS + usize::from(bin)].add(own);
        }
    }
    histograms
}

/// Feature and last left bin of the split with the greatest gain, summed over all nodes of the
/// level; `None` without a gain.
fn best_split(
    histograms: &[Derivatives],
    binned: &BinnedFeatures,
    config: &BoostingConfig,
) -> Option<(usize, usize)> {
    let mut best = None;
    let mut greatest = 1e-6;
    for feature in 0..binned.n_features {
        let mut gains = [0.0; N_BINS];
        for node in histograms.chunks_exact(binned.n_features * N_BINS) {
            let bins = &node[feature * N_BINS..(feature + 1) * N_BINS];
            add_gains(bins, config, &mut gains);
        }
        for (bin, &gain) in gains
            .iter()
            .enumerate()
            .take(binned.thresholds[feature].len())
        {
            if gain > greatest {
                greatest = gain;
                best = Some((feature, bin));
            }
        }
    }
    best
}

/// Add the gain of a split behind each bin of a node.
fn add_gains(bins: &[Derivatives], config: &BoostingConfig, gains: &mut [f64; N_BINS]) {
    let mut all = Derivatives::default();
    for bin in bins {
        all.add(*bin);
    }
    let whole = all.gain(config.lambda);
    let mut left = Derivatives::default();
    for (own, gain) in bins.iter().zip(gains) {
        left.add(*own);
        let right = all.without(left);
        if left.hessian >= config.hessian_min && right.hessian >= config.hessian_min {
            *gain += left.gain(config.lambda) + right.gain(config.lambda) - whole;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONFIG: BoostingConfig = BoostingConfig {
        n_trees: 60,
        depth: 3,
        learning_rate: 0.2,
        lambda: 1.0,
        hessian_min: 1.0,
        subsample: 1.0,
        seed: 1,
    };

    /// Rows of three pseudo-random features, labelled by a rule of the first two.
    fn rows(n: usize, shift: usize) -> (Vec<f32>, Vec<bool>) {
        let value = |i: usize| ((i * 7919 + 104_729) % 10_007) as f32 / 10_007.0;
        let features: Vec<f32> = (0..3 * n).map(|i| value(i + 3 * shift)).collect();
        let is_true = |row: &[f32]| (row[0] > 0.5) != (row[1] > 0.3);
        let labels = features.chunks_exact(3).map(is_true).collect();
        (features, labels)
    }

    #[test]
    fn an_interaction_of_features_is_learned() {
        let (features, labels) = rows(2_000, 0);
        let examples = LabelledRows {
            features: &features,
            n_features: 3,
            labels: &labels,
        };
        let model = BoostedTrees::train(&examples, &CONFIG, |_| ());
        let (unseen, truths) = rows(500, 2_500);
        let right = unseen
            .chunks_exact(3)
            .zip(&truths)
            .filter(|(row, truth)| (model.log_odds(row) > 0.0) == **truth);
        assert!(right.count() > 485);
    }

    #[test]
    fn equal_rows_have_the_log_odds_of_their_shares() {
        let features = vec![1.0_f32; 400];
        let labels: Vec<bool> = (0..400).map(|i| i % 4 == 0).collect();
        let examples = LabelledRows {
            features: &features,
            n_features: 1,
            labels: &labels,
        };
        let model = BoostedTrees::train(&examples, &CONFIG, |_| ());
        assert!((model.log_odds(&[1.0]) - (1.0_f64 / 3.0).ln()).abs() < 0.05);
    }
}
