//! Gradient-boosted decision trees for two classes (Friedman 2001), trained level by level
//! on histograms of the features.

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
}

/// Complete binary decision tree.
#[derive(Debug, Clone, PartialEq)]
pub struct BoostedTree {
    /// Feature and threshold of each inner node, breadth first; a greater value goes right.
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

/// Training examples: rows of features with their class.
#[derive(Debug, Clone, Copy)]
pub struct Examples<'a> {
    /// Features, row by row.
    pub features: &'a [f32],
    /// Number of features of a row.
    pub n_features: usize,
    /// Class of each row.
    pub labels: &'a [bool],
}

/// Greatest number of bins of a feature.
const N_BINS: usize = 128;

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
    fn of(examples: &Examples<'_>) -> Self {
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
fn quantile_thresholds(examples: &Examples<'_>, feature: usize) -> Vec<f32> {
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
        examples: &Examples<'_>,
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
            let (tree, leaf_of) = grow_tree(&binned, &derivatives, config);
            for (log_odds, leaf) in log_odds.iter_mut().zip(leaf_of) {
                *log_odds += tree.leaves[leaf];
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
        let mut node = 0;
        while let Some(&(feature, threshold)) = self.splits.get(node) {
            node = 2 * node + 1 + usize::from(features[feature] > threshold);
        }
        self.leaves[node - self.splits.len()]
    }
}

/// Grow one tree level by level; returns it with the leaf of each row.
fn grow_tree(
    binned: &BinnedFeatures,
    derivatives: &[Derivatives],
    config: &BoostingConfig,
) -> (BoostedTree, Vec<usize>) {
    let mut splits = Vec::new();
    let mut node_of = vec![0_usize; derivatives.len()];
    for level in 0..config.depth {
        let n_nodes = 1 << level;
        let histograms = histograms(binned, derivatives, &node_of, n_nodes);
        let size = binned.n_features * N_BINS;
        let chosen: Vec<Option<(usize, usize)>> = (0..n_nodes)
            .map(|node| best_split(&histograms[node * size..(node + 1) * size], binned, config))
            .collect();
        splits.extend(chosen.iter().map(|split| match *split {
            Some((feature, bin)) => (feature, binned.thresholds[feature][bin]),
            None => (0, f32::MAX),
        }));
        for (row, node) in node_of.iter_mut().enumerate() {
            let is_right = chosen[*node].is_some_and(|(feature, bin)| {
                usize::from(binned.bins[row * binned.n_features + feature]) > bin
            });
            *node = 2 * *node + usize::from(is_right);
        }
    }
    let mut sums = vec![Derivatives::default(); 1 << config.depth];
    for (row, &leaf) in node_of.iter().enumerate() {
        sums[leaf].add(derivatives[row]);
    }
    let value =
        |sum: &Derivatives| -config.learning_rate * sum.gradient / (sum.hessian + config.lambda);
    let leaves = sums.iter().map(value).collect();
    (BoostedTree { splits, leaves }, node_of)
}

/// Derivatives by node, feature and bin.
fn histograms(
    binned: &BinnedFeatures,
    derivatives: &[Derivatives],
    node_of: &[usize],
    n_nodes: usize,
) -> Vec<Derivatives> {
    let n_features = binned.n_features;
    let mut histograms = vec![Derivatives::default(); n_nodes * n_features * N_BINS];
    for ((bins, &own), &node) in binned
        .bins
        .chunks_exact(n_features)
        .zip(derivatives)
        .zip(node_of)
    {
        for (feature, &bin) in bins.iter().enumerate() {
            histograms[(node * n_features + feature) * N_BINS + usize::from(bin)].add(own);
        }
    }
    histograms
}

/// Feature and last left bin of the split with the greatest gain; `None` without a gain.
fn best_split(
    histogram: &[Derivatives],
    binned: &BinnedFeatures,
    config: &BoostingConfig,
) -> Option<(usize, usize)> {
    let mut best = None;
    let mut greatest = 1e-6;
    for feature in 0..binned.n_features {
        let bins = &histogram[feature * N_BINS..(feature + 1) * N_BINS];
        let mut all = Derivatives::default();
        for bin in bins {
            all.add(*bin);
        }
        let mut left = Derivatives::default();
        for (bin, own) in bins
            .iter()
            .enumerate()
            .take(binned.thresholds[feature].len())
        {
            left.add(*own);
            let right = all.without(left);
            if left.hessian < config.hessian_min || right.hessian < config.hessian_min {
                continue;
            }
            let gain =
                left.gain(config.lambda) + right.gain(config.lambda) - all.gain(config.lambda);
            if gain > greatest {
                greatest = gain;
                best = Some((feature, bin));
            }
        }
    }
    best
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
        let examples = Examples {
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
        let examples = Examples {
            features: &features,
            n_features: 1,
            labels: &labels,
        };
        let model = BoostedTrees::train(&examples, &CONFIG, |_| ());
        assert!((model.log_odds(&[1.0]) - (1.0_f64 / 3.0).ln()).abs() < 0.05);
    }
}
