//! Report of registration.

use super::trials::{Trial, ViewPair};
use crate::arguments::RegistrationArguments;
use serde::Serialize;
use statistics::bootstrap::Estimate;
use statistics::percentiles::Percentiles;

/// Report of registration.
#[derive(Debug, Serialize)]
pub(super) struct RegistrationReport {
    pub(super) seed: u64,
    /// Random directions of each rotation with each translation.
    pub(super) n_starts: u32,
    /// Angle between the simulated views, degrees; `None` for pairs from files.
    pub(super) angle_deg: Option<f64>,
    /// Mean success of the pairs with its 95 % interval over them.
    pub(super) success: Option<Estimate>,
    pub(super) pairs: Vec<PairReport>,
}

/// Figures of one pair of views.
#[derive(Debug, Serialize)]
pub(super) struct PairReport {
    pub(super) name: String,
    pub(super) n_target_points: usize,
    pub(super) n_source_points: usize,
    pub(super) n_trials: usize,
    pub(super) n_success: usize,
    /// Share of successful trials with its 95 % interval.
    pub(super) success: Option<Estimate>,
    /// Medians over all trials.
    pub(super) rotation_error_deg: f64,
    pub(super) translation_error_mm: f64,
    pub(super) ms: f64,
    /// Number of trials in which the surfaces hardly constrained a rotation.
    pub(super) n_rotation_weak: usize,
}

impl PairReport {
    /// Figures of the trials of a pair.
    pub(super) fn of(pair: &ViewPair, trials: &[Trial], seed: u64) -> Self {
        let successes: Vec<Option<f64>> = trials
            .iter()
            .map(|trial| Some(f64::from(u8::from(trial.is_success()))))
            .collect();
        let median = |value: fn(&Trial) -> f64| {
            let percentiles = Percentiles::of(trials.iter().map(value).collect());
            percentiles.map_or(f64::NAN, |percentiles| percentiles.p50)
        };
        Self {
            name: pair.name.clone(),
            n_target_points: pair.target.len(),
            n_source_points: pair.source.len(),
            n_trials: trials.len(),
            n_success: trials.iter().filter(|trial| trial.is_success()).count(),
            success: Estimate::mean(&successes, seed),
            rotation_error_deg: median(|trial| trial.rotation_error_deg),
            translation_error_mm: median(|trial| trial.translation_error_mm),
            ms: median(|trial| trial.ms),
            n_rotation_weak: trials.iter().filter(|trial| trial.is_rotation_weak).count(),
        }
    }
}

impl RegistrationReport {
    /// Report of the figures of all pairs.
    pub(super) fn of(arguments: &RegistrationArguments, pairs: Vec<PairReport>) -> Self {
        let successes: Vec<Option<f64>> = pairs
            .iter()
            .map(|pair| pair.success.map(|success| success.value))
            .collect();
        Self {
            seed: arguments.seed,
            n_starts: arguments.starts,
            angle_deg: arguments.pairs.is_none().then_some(arguments.angle),
            success: Estimate::mean(&successes, arguments.seed),
            pairs,
        }
    }
}
