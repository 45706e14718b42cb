//! Edge network: a multilayer perceptron for the log odds that two neighbouring cells are of two
//! objects.

use super::edge_features::{BLOCK, EdgeBlock, N_EDGE_FEATURES};
use super::trained_network::NETWORK;

/// Number of hidden units.
pub(super) const N_HIDDEN: usize = 16;

/// Weights of the network: a hidden layer of rectified linear units, then a linear one.
#[derive(Debug)]
pub(super) struct EdgeNetwork {
    /// Bias of each hidden unit, and its weight for each feature.
    pub(super) hidden: [(f32, [f32; N_EDGE_FEATURES]); N_HIDDEN],
    /// Bias of the output, and its weight for each hidden unit.
    pub(super) output: (f32, [f32; N_HIDDEN]),
}

impl EdgeNetwork {
    /// Log odds of a block of edges.
    #[inline]
    fn log_odds(&self, features: &EdgeBlock) -> [f32; BLOCK] {
        let (bias, weights) = &self.output;
        let mut log_odds = [*bias; BLOCK];
        for ((bias, inputs), weight) in self.hidden.iter().zip(weights) {
            let mut unit = [*bias; BLOCK];
            for (input, feature) in inputs.iter().zip(features) {
                for (unit, feature) in unit.iter_mut().zip(feature) {
                    *unit += input * feature;
                }
            }
            for (log_odds, unit) in log_odds.iter_mut().zip(unit) {
                *log_odds += weight * unit.max(0.0);
            }
        }
        log_odds
    }
}

/// Log odds that the cells of each edge of a block are of two objects.
#[inline]
pub(super) fn log_odds(features: &EdgeBlock) -> [f32; BLOCK] {
    NETWORK.log_odds(features)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn output_is_the_weighted_sum_of_the_rectified_units() {
        let mut network = EdgeNetwork {
            hidden: [(0.0, [0.0; N_EDGE_FEATURES]); N_HIDDEN],
            output: (0.5, [0.0; N_HIDDEN]),
        };
        network.hidden[0] = (
            -1.0,
            std::array::from_fn(|i| if i == 2 { 2.0 } else { 0.0 }),
        );
        network.output.1[0] = 3.0;
        let mut features = [[0.0; BLOCK]; N_EDGE_FEATURES];
        features[2] = std::array::from_fn(|i| i as f32);
        let log_odds = network.log_odds(&features);
        assert_eq!(log_odds[..3], [0.5, 3.5, 9.5]);
    }

    #[test]
    fn trained_weights_are_finite() {
        let (bias, weights) = &NETWORK.output;
        let hidden = NETWORK.hidden.iter();
        let hidden = hidden.flat_map(|(bias, weights)| [bias].into_iter().chain(weights));
        assert!(hidden.chain([bias]).chain(weights).all(|w| w.is_finite()));
    }
}
