//! The figures of `tabula evaluate ablation` as a document.

use super::super::object_views::ViewTable;
use super::{Played, REFERENCE};
use crate::arguments::AblationArguments;
use evaluation::open_ended::{Metrics, Protocol};
use serde::Serialize;
use statistics::bootstrap::{Estimate, N_RESAMPLES};

/// All figures.
#[derive(Debug, Serialize)]
pub(super) struct Document {
    version: &'static str,
    dataset: String,
    pub(super) n_categories: usize,
    pub(super) n_views: usize,
    pub(super) variants: Vec<VariantFigures>,
    pub(super) settings: Settings,
    n_left_out: usize,
    pub(super) left_out: Vec<String>,
    pub(super) page: String,
    pub(super) file: String,
}

/// One variant: means over its runs, with their intervals.
#[derive(Debug, Serialize)]
pub(super) struct VariantFigures {
    pub(super) name: &'static str,
    pub(super) qci: Option<Interval>,
    pub(super) tlc: Option<Interval>,
    pub(super) aic: Option<Interval>,
    pub(super) gca: Option<Interval>,
    pub(super) apa: Option<Interval>,
    /// Its GCA less that of the reference with the same seed; null of the reference.
    pub(super) gca_difference: Option<Interval>,
    /// Its share of wrong answers over that of the reference; null of the reference, and
    /// when that one is never wrong.
    pub(super) error_ratio: Option<Interval>,
    runs: Vec<RunFigures>,
}

/// A figure, and between which bounds it lies with 95 %.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Interval {
    pub(super) value: f64,
    pub(super) low: f64,
    pub(super) high: f64,
}

/// One run.
#[derive(Debug, Serialize)]
struct RunFigures {
    seed: u64,
    qci: u32,
    tlc: u32,
    aic: f64,
    gca: f64,
    apa: Option<f64>,
}

/// How the figures were made.
#[derive(Debug, Serialize)]
pub(super) struct Settings {
    pub(super) reference: &'static str,
    pub(super) protocol: &'static str,
    pub(super) tau: f64,
    pub(super) n_runs: u64,
    pub(super) seed: u64,
    /// Of GOOD.
    bins: usize,
    views_max: Option<u32>,
    confidence: f64,
    pub(super) n_resamples: usize,
}

impl Document {
    pub(super) fn of(
        arguments: &AblationArguments,
        protocol: &Protocol,
        views: &ViewTable,
        played: &[Played],
    ) -> Self {
        let reference = played.iter().find(|played| played.variant == REFERENCE);
        let reference = reference.map_or(&[][..], |played| &played.runs);
        let path = |name: &str| arguments.out.join(name).display().to_string();
        let figures = |played| VariantFigures::of(played, reference, arguments.seed);
        Self {
            version: env!("CARGO_PKG_VERSION"),
            dataset: arguments.dataset.display().to_string(),
            n_categories: views.categories.len(),
            n_views: views.labels.len(),
            variants: played.iter().map(figures).collect(),
            settings: Settings {
                reference: REFERENCE.name(),
                protocol: arguments.protocol.name(),
                tau: protocol.tau,
                n_runs: arguments.runs,
                seed: arguments.seed,
                bins: arguments.bins,
                views_max: arguments.views_max,
                confidence: 0.95,
                n_resamples: N_RESAMPLES,
            },
            n_left_out: views.left_out.n,
            left_out: views.left_out.sentences(),
            page: path("index.html"),
            file: path("ablation.json"),
        }
    }
}

impl VariantFigures {
    fn of(played: &Played, reference: &[Metrics], seed: u64) -> Self {
        let mean = |value: fn(&Metrics) -> Option<f64>| {
            let values: Vec<_> = played.runs.iter().map(value).collect();
            Estimate::mean(&values, seed).map(Interval::from)
        };
        let errors = |runs: &[Metrics]| runs.iter().map(|run| 1.0 - run.gca).collect::<Vec<_>>();
        let (of_reference, own) = (errors(reference), errors(&played.runs));
        let is_other = played.variant != REFERENCE;
        // One error less is as much accuracy more.
        let difference = Estimate::paired_difference(&own, &of_reference, seed);
        let ratio = Estimate::paired_ratio(&of_reference, &own, seed);
        let of_others = |estimate: Option<Estimate>| estimate.filter(|_| is_other);
        let runs = (seed..).zip(&played.runs);
        Self {
            name: played.variant.name(),
            qci: mean(|run| Some(run.qci.into())),
            tlc: mean(|run| Some(run.tlc.into())),
            aic: mean(|run| Some(run.aic)),
            gca: mean(|run| Some(run.gca)),
            apa: mean(|run| run.apa),
            gca_difference: of_others(difference).map(Interval::from),
            error_ratio: of_others(ratio).map(Interval::from),
            runs: runs.map(|(seed, run)| RunFigures::of(seed, run)).collect(),
        }
    }
}

impl RunFigures {
    fn of(seed: u64, run: &Metrics) -> Self {
        let Metrics {
            qci,
            tlc,
            aic,
            gca,
            apa,
        } = *run;
        Self {
            seed,
            qci,
            tlc,
            aic,
            gca,
            apa,
        }
    }
}

impl From<Estimate> for Interval {
    fn from(Estimate { value, low, high }: Estimate) -> Self {
        Self { value, low, high }
    }
}

impl From<Interval> for Estimate {
    fn from(Interval { value, low, high }: Interval) -> Self {
        Self { value, low, high }
    }
}
