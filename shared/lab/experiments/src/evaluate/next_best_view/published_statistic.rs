//! Published statistic of the prediction (Kasaei et al. 2018, figure 8): standard deviation and
//! mean squared error over the ten best predictions of each view, beside the errors over all.

use super::captured_view::CapturedView;
use super::entropy_prediction::{self, PredictedPairs, PredictionScore};
use super::prediction_source::PredictionSource;
use plot::box_plot::BoxGroup;
use serde::Serialize;
use statistics::spread::MeanAndStd;

/// Number of predictions of a view that are kept (Kasaei et al. 2018).
const N_BEST: usize = 10;
/// Source whose predictions are drawn: it knows no truth.
pub(super) const DRAWN: PredictionSource = PredictionSource::Registered;

/// Figures of the paper for a kind of scene.
#[derive(Debug, Clone, Copy)]
pub(super) struct PaperFigures {
    /// Standard deviation over the ten best predictions.
    pub(super) sd: f64,
    /// Mean squared error over the ten best predictions, in a unit that is not given.
    pub(super) mse: f64,
}

/// Statistic of the predictions from one source of hypotheses.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub(super) struct SourceStatistic {
    /// Standard deviation of the ten best predictions of a view, mean of the views, bit.
    pub(super) best_ten_sd: f64,
    /// Mean squared error of the ten best predictions, mean of the views, bit squared.
    pub(super) best_ten_mse: f64,
    /// Errors over all pairs of a current view and a candidate.
    #[serde(flatten)]
    pub(super) score: PredictionScore,
}

/// Statistic of one scene.
#[derive(Debug)]
pub(super) struct SceneStatistic {
    pub(super) n_objects: usize,
    pub(super) n_views: usize,
    pub(super) sources: Vec<(PredictionSource, SourceStatistic)>,
    /// Views with their best predictions from the source that is drawn.
    pub(super) drawn: Vec<BoxGroup>,
}

impl SceneStatistic {
    /// Statistic of the predictions from every view of a scene.
    pub(super) fn of(views: &[CapturedView]) -> Self {
        let (mut sources, mut drawn) = (Vec::new(), Vec::new());
        for source in PredictionSource::ALL {
            let predicted = entropy_prediction::of_all(views, source);
            let references = reference_views(&predicted);
            let statistic = SourceStatistic {
                best_ten_sd: mean(&references, |view| spread(&view.values)),
                best_ten_mse: mean(&references, mse),
                score: entropy_prediction::score(&predicted),
            };
            sources.push((source, statistic));
            if source == DRAWN {
                drawn = references;
            }
        }
        Self {
            n_objects: views.first().map_or(0, |view| view.visible_shares.len()),
            n_views: views.len(),
            sources,
            drawn,
        }
    }
}

/// Mean squared error of the best predictions of a view.
fn mse(view: &BoxGroup) -> f64 {
    let squares = view.values.iter();
    let squares = squares.map(|best| (best - view.reference).powi(2));
    squares.sum::<f64>() / view.values.len().max(1) as f64
}

/// The ten best predictions of each view, from the predictions of each current view for all
/// others in their order.
fn reference_views(predicted: &[PredictedPairs]) -> Vec<BoxGroup> {
    let reference = |candidate: usize| {
        let of_current = predicted.iter().enumerate().filter_map(|(current, pairs)| {
            // A view does not predict itself.
            let index = match candidate.cmp(&current) {
                std::cmp::Ordering::Less => candidate,
                std::cmp::Ordering::Equal => return None,
                std::cmp::Ordering::Greater => candidate - 1,
            };
            pairs.get(index).copied()
        });
        let mut pairs: Vec<(f64, f64)> = of_current.collect();
        pairs.sort_by(|a, b| (a.0 - a.1).abs().total_cmp(&(b.0 - b.1).abs()));
        BoxGroup {
            reference: pairs.first().map_or(0.0, |pair| pair.1),
            values: pairs.iter().take(N_BEST).map(|pair| pair.0).collect(),
        }
    };
    (0..predicted.len()).map(reference).collect()
}

fn mean(views: &[BoxGroup], value: impl Fn(&BoxGroup) -> f64) -> f64 {
    views.iter().map(value).sum::<f64>() / views.len().max(1) as f64
}

/// Standard deviation of a sample; 0 for fewer than two values.
pub(super) fn spread(values: &[f64]) -> f64 {
    let deviation = MeanAndStd::of(values).and_then(|spread| spread.std);
    deviation.unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn best_predictions_of_a_view_come_from_all_others() {
        // Entropies of the views 1, 2 and 3; current view c predicts view v as v + 10 c.
        let truth = [1.0, 2.0, 3.0];
        let from = |current: usize| {
            let others = (0..3).filter(|candidate| *candidate != current);
            others
                .map(|candidate| (truth[candidate] + 10.0 * current as f64, truth[candidate]))
                .collect()
        };
        let views = reference_views(&[from(0), from(1), from(2)]);
        let best: Vec<Vec<f64>> = views.iter().map(|view| view.values.clone()).collect();
        assert_eq!(best, [[11.0, 21.0], [2.0, 22.0], [3.0, 13.0]]);
        let entropies: Vec<f64> = views.iter().map(|view| view.reference).collect();
        assert_eq!(entropies, truth);
        assert_eq!(mse(&views[0]), 250.0);
    }

    #[test]
    fn only_the_ten_nearest_predictions_count() {
        // 30 current views, of which the error is 0.1 times their number.
        let from = |current: usize| -> PredictedPairs {
            let others = (0..30).filter(|candidate| *candidate != current);
            others.map(|_| (2.0 + 0.1 * current as f64, 2.0)).collect()
        };
        let predicted: Vec<PredictedPairs> = (0..30).map(from).collect();
        let views = reference_views(&predicted);
        // Those of views 0 to 9, without the view itself.
        let greatest = |view: &BoxGroup| view.values.iter().copied().fold(0.0, f64::max);
        assert!((greatest(&views[20]) - 2.9).abs() < 1e-12);
        assert!((greatest(&views[4]) - 3.0).abs() < 1e-12);
        assert!(views.iter().all(|view| view.values.len() == 10));
        // 0 to 9 have a deviation of the square root of 55 / 6.
        assert!((spread(&views[20].values) - 0.1 * (55.0_f64 / 6.0).sqrt()).abs() < 1e-12);
        assert!((mse(&views[20]) - 0.01 * 28.5).abs() < 1e-12);
    }

    #[test]
    fn spread_of_a_single_value_is_zero() {
        assert_eq!((spread(&[]), spread(&[3.0])), (0.0, 0.0));
        assert!((spread(&[1.0, 3.0]) - 2.0_f64.sqrt()).abs() < 1e-12);
    }
}
