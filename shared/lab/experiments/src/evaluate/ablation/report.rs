//! Report of the ablation study.

use super::{REFERENCE, VariantRuns};
use crate::arguments::AblationArguments;
use crate::evaluate::open_ended::split_name;
use crate::evaluate::report_parts::{OmissionSummary, ReportFiles, ReportHeader};
use crate::evaluate::view_table::ViewTable;
use evaluation::open_ended::{Metrics, Protocol};
use serde::Serialize;
use statistics::bootstrap::{Estimate, N_RESAMPLES};

/// Report of an ablation study.
#[derive(Debug, Serialize)]
pub(super) struct AblationReport {
    #[serde(flatten)]
    pub(super) header: ReportHeader,
    pub(super) variants: Vec<VariantFigures>,
    pub(super) settings: Settings,
    #[serde(flatten)]
    pub(super) omissions: OmissionSummary,
    #[serde(flatten)]
    pub(super) files: ReportFiles,
}

/// Metrics of one variant: means over its runs with 95 % bootstrap intervals.
#[derive(Debug, Serialize)]
pub(super) struct VariantFigures {
    pub(super) name: &'static str,
    pub(super) qci: Option<Estimate>,
    pub(super) tlc: Option<Estimate>,
    pub(super) aic: Option<Estimate>,
    pub(super) gca: Option<Estimate>,
    pub(super) apa: Option<Estimate>,
    /// Paired difference of GCA to the reference; null for the reference.
    pub(super) gca_difference: Option<Estimate>,
    /// Paired ratio of error rates to the reference; null for the reference, and if the reference
    /// is never wrong.
    pub(super) error_ratio: Option<Estimate>,
    runs: Vec<RunFigures>,
}

/// Metrics of one run of a variant.
#[derive(Debug, Serialize)]
struct RunFigures {
    seed: u64,
    #[serde(flatten)]
    metrics: Metrics,
}

/// Settings of the ablation study.
#[derive(Debug, Serialize)]
pub(super) struct Settings {
    pub(super) reference: &'static str,
    pub(super) protocol: &'static str,
    pub(super) tau: f64,
    pub(super) n_runs: u64,
    pub(super) seed: u64,
    /// Number of bins of GOOD along each side.
    bins: usize,
    views_max: Option<u32>,
    confidence: f64,
    pub(super) n_resamples: usize,
}

impl AblationReport {
    pub(super) fn of(
        arguments: &AblationArguments,
        protocol: &Protocol,
        views: &ViewTable,
        played: &[VariantRuns],
    ) -> Self {
        let reference = played.iter().find(|played| played.variant == REFERENCE);
        let reference = reference.map_or(&[][..], |played| &played.runs);
        let figures = |played| VariantFigures::of(played, reference, arguments.lessons.seed);
        Self {
            header: ReportHeader::new(arguments.lessons.dataset.display().to_string(), views),
            variants: played.iter().map(figures).collect(),
            settings: Settings {
                reference: REFERENCE.word(),
                protocol: split_name(protocol.split),
                tau: protocol.tau,
                n_runs: arguments.runs,
                seed: arguments.lessons.seed,
                bins: arguments.bins,
                views_max: arguments.views_max,
                confidence: 0.95,
                n_resamples: N_RESAMPLES,
            },
            omissions: views.into(),
            files: ReportFiles::in_folder(&arguments.lessons.out, "ablation.json"),
        }
    }
}

impl VariantFigures {
    fn of(played: &VariantRuns, reference: &[Metrics], seed: u64) -> Self {
        let mean = |value: fn(&Metrics) -> Option<f64>| {
            let values: Vec<_> = played.runs.iter().map(value).collect();
            Estimate::mean(&values, seed)
        };
        let errors = |runs: &[Metrics]| runs.iter().map(|run| 1.0 - run.gca).collect::<Vec<_>>();
        let (of_reference, own) = (errors(reference), errors(&played.runs));
        let is_other = played.variant != REFERENCE;
        // The difference of accuracies is the negative difference of error rates.
        let difference = Estimate::paired_difference(&own, &of_reference, seed);
        let ratio = Estimate::paired_ratio(&of_reference, &own, seed);
        let of_others = |estimate: Option<Estimate>| estimate.filter(|_| is_other);
        let runs = (seed..).zip(&played.runs);
        Self {
            name: played.variant.word(),
            qci: mean(|run| Some(run.qci.into())),
            tlc: mean(|run| Some(run.tlc.into())),
            aic: mean(|run| Some(run.aic)),
            gca: mean(|run| Some(run.gca)),
            apa: mean(|run| run.apa),
            gca_difference: of_others(difference),
            error_ratio: of_others(ratio),
            runs: runs
                .map(|(seed, &metrics)| RunFigures { seed, metrics })
                .collect(),
        }
    }
}
