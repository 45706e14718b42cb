//! Prediction of the entropy of every view from every other one, against the truth.

use super::captured_view::CapturedView;
use super::prediction_source::PredictionSource;
use serde::Serialize;
use statistics::correlation::spearman;

/// Number of the best views among which a choice is a hit.
const N_TOP: usize = 10;

/// Errors of predicted entropies over all pairs of a current view and a candidate.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub(super) struct PredictionScore {
    /// Mean absolute error, bit.
    pub(super) mae: f64,
    /// Root mean square error, bit.
    pub(super) rmse: f64,
    /// Mean of prediction less truth, bit.
    pub(super) bias: f64,
    /// Mean over the current views of the rank correlation over the candidates.
    pub(super) spearman_rho: f64,
    /// Mean entropy of the best candidate less that of the chosen one, bit.
    pub(super) regret: f64,
    /// The same for a candidate at random.
    pub(super) random_regret: f64,
    /// Share of choices among the ten best candidates.
    pub(super) top_ten_share: f64,
}

impl PredictionScore {
    /// Mean of scores; the root mean square error by its squares.
    pub(super) fn mean(scores: &[Self]) -> Self {
        let n = scores.len().max(1) as f64;
        let mean = |value: fn(&Self) -> f64| scores.iter().map(value).sum::<f64>() / n;
        Self {
            mae: mean(|score| score.mae),
            rmse: mean(|score| score.rmse * score.rmse).sqrt(),
            bias: mean(|score| score.bias),
            spearman_rho: mean(|score| score.spearman_rho),
            regret: mean(|score| score.regret),
            random_regret: mean(|score| score.random_regret),
            top_ten_share: mean(|score| score.top_ten_share),
        }
    }

    /// Regret, and that of a candidate at random, as text.
    pub(super) fn regrets(&self) -> String {
        format!("{:.3} ({:.3})", self.regret, self.random_regret)
    }
}

/// Predicted and true entropy of the candidates of one current view.
pub(super) type PredictedPairs = Vec<(f64, f64)>;

/// Predictions from every view of a scene, each as one list of pairs.
pub(super) fn of_all(views: &[CapturedView], source: PredictionSource) -> Vec<PredictedPairs> {
    let of_current = |(current, view): (usize, &CapturedView)| {
        let predicted = view.plans.predicted[source as usize].iter().zip(views);
        let others = predicted
            .enumerate()
            .filter(|(candidate, _)| *candidate != current);
        others
            .map(|(_, (predicted, view))| (*predicted, view.entropy))
            .collect()
    };
    views.iter().enumerate().map(of_current).collect()
}

/// Score of the predictions of a scene.
pub(super) fn score(predictions: &[PredictedPairs]) -> PredictionScore {
    let scores: Vec<PredictionScore> = predictions.iter().map(|pairs| score_of(pairs)).collect();
    PredictionScore::mean(&scores)
}

fn score_of(pairs: &[(f64, f64)]) -> PredictionScore {
    let n = pairs.len().max(1) as f64;
    let mean = |value: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(value).sum::<f64>() / n;
    let chosen = pairs.iter().max_by(|a, b| a.0.total_cmp(&b.0));
    let chosen = chosen.map_or(0.0, |pair| pair.1);
    let best = pairs.iter().map(|pair| pair.1).fold(0.0, f64::max);
    let n_better = pairs.iter().filter(|pair| pair.1 > chosen).count();
    PredictionScore {
        mae: mean(&|(predicted, truth)| (predicted - truth).abs()),
        rmse: mean(&|(predicted, truth)| (predicted - truth).powi(2)).sqrt(),
        bias: mean(&|(predicted, truth)| predicted - truth),
        spearman_rho: spearman(pairs).unwrap_or(0.0),
        regret: best - chosen,
        random_regret: best - mean(&|pair| pair.1),
        top_ten_share: f64::from(u8::from(n_better < N_TOP)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn score_tells_errors_bias_and_regret() {
        // The prediction prefers the second best view, and is 0.1 too large elsewhere.
        let pairs = vec![(1.1, 1.0), (2.1, 2.0), (3.1, 3.0), (3.5, 2.5)];
        let score = score(&[pairs]);
        assert!((score.mae - 0.325).abs() < 1e-12 && (score.bias - 0.325).abs() < 1e-12);
        assert!((score.rmse - (1.03_f64 / 4.0).sqrt()).abs() < 1e-12);
        assert!((score.regret - 0.5).abs() < 1e-12);
        assert!((score.random_regret - 0.875).abs() < 1e-12);
        assert!((score.spearman_rho - 0.8).abs() < 1e-12);
        assert_eq!(score.top_ten_share, 1.0);
    }
}
