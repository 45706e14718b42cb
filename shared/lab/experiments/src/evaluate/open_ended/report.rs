//! Report of the open-ended evaluation.

use super::{picture, split_name};
use crate::arguments::OpenEndedArguments;
use crate::evaluate::recognition::DescriptionSettings;
use crate::evaluate::report_parts::{OmissionSummary, ReportFiles, ReportHeader};
use crate::evaluate::view_table::ViewTable;
use evaluation::novelty_score::NoveltyScore;
use evaluation::open_ended::{Metrics, MetricsSummary, OpenEndedRun, Protocol, StopReason};
use evaluation::recogniser::Answer;
use serde::Serialize;
use statistics::spread::MeanAndStd;

/// Report of an open-ended evaluation.
#[derive(Debug, Serialize)]
pub(super) struct OpenEndedReport {
    #[serde(flatten)]
    pub(super) header: ReportHeader,
    pub(super) runs: Vec<RunFigures>,
    pub(super) mean: Figures,
    pub(super) std: Figures,
    /// Open-set metrics over the questions of all runs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) open_set: Option<NoveltyScore>,
    pub(super) settings: Settings,
    #[serde(flatten)]
    pub(super) omissions: OmissionSummary,
    pub(super) timing: Timing,
    #[serde(flatten)]
    pub(super) files: ReportFiles,
}

/// Metrics of an open-ended run as in the published table.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Figures {
    pub(super) qci: Option<f64>,
    pub(super) tlc: Option<f64>,
    pub(super) aic: Option<f64>,
    pub(super) gca: Option<f64>,
    pub(super) apa: Option<f64>,
}

/// Metrics of one open-ended run.
#[derive(Debug, Serialize)]
pub(super) struct RunFigures {
    pub(super) seed: u64,
    #[serde(flatten)]
    pub(super) metrics: Metrics,
    pub(super) corrections: u32,
    pub(super) stop: &'static str,
    pub(super) picture: String,
}

/// Settings of the open-ended protocol.
#[derive(Debug, Serialize)]
pub(super) struct Settings {
    #[serde(flatten)]
    pub(super) description: DescriptionSettings,
    pub(super) protocol: &'static str,
    pub(super) tau: f64,
    views_at_start: usize,
    window: usize,
    stall_limit: u32,
    open_set_share: f64,
    n_runs: u64,
    seed: u64,
}

/// Durations on one thread; the only values that vary between repetitions.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Timing {
    pub(super) describe_ms: f64,
    pub(super) ask_ms: f64,
}

impl OpenEndedReport {
    /// Report of open-ended runs, ordered by seed.
    pub(super) fn of(
        arguments: &OpenEndedArguments,
        protocol: &Protocol,
        views: &ViewTable,
        runs: &[OpenEndedRun],
        ask_ms: f64,
    ) -> Self {
        let metrics: Vec<Metrics> = runs.iter().map(OpenEndedRun::metrics).collect();
        let summary = MetricsSummary::of(&metrics);
        Self {
            header: ReportHeader::new(arguments.lessons.dataset.display().to_string(), views),
            runs: runs.iter().map(RunFigures::of).collect(),
            mean: Figures::of(&summary, |spread| Some(spread.mean)),
            std: Figures::of(&summary, |spread| spread.std),
            open_set: novelty(runs),
            settings: Settings::of(arguments, protocol),
            omissions: views.into(),
            timing: Timing {
                describe_ms: views.describe_ms,
                ask_ms,
            },
            files: ReportFiles::in_folder(&arguments.lessons.out, "open-ended.json"),
        }
    }
}

impl Figures {
    fn of(summary: &MetricsSummary, value: fn(&MeanAndStd) -> Option<f64>) -> Self {
        let of = |spread: &Option<MeanAndStd>| spread.as_ref().and_then(value);
        Self {
            qci: of(&summary.qci),
            tlc: of(&summary.tlc),
            aic: of(&summary.aic),
            gca: of(&summary.gca),
            apa: of(&summary.apa),
        }
    }
}

impl RunFigures {
    fn of(run: &OpenEndedRun) -> Self {
        Self {
            seed: run.seed,
            metrics: run.metrics(),
            corrections: run.n_corrections(),
            stop: match run.stop {
                StopReason::AllLearned => "all-learned",
                StopReason::Stalled => "stalled",
                StopReason::LackOfData => "lack-of-data",
            },
            picture: picture(run.seed),
        }
    }
}

/// Open-set metrics of the questions of all runs.
fn novelty(runs: &[OpenEndedRun]) -> Option<NoveltyScore> {
    let answers = |is_open_set: bool| -> Vec<Answer> {
        let of_runs = runs.iter().flat_map(|run| run.answers(is_open_set));
        of_runs.collect()
    };
    let known_probability_min = pipeline::Config::KNOWN_PROBABILITY_MIN;
    NoveltyScore::of(&answers(true), &answers(false), known_probability_min)
}

impl Settings {
    fn of(arguments: &OpenEndedArguments, protocol: &Protocol) -> Self {
        Self {
            description: DescriptionSettings::of(&arguments.description),
            protocol: split_name(protocol.split),
            tau: protocol.tau,
            views_at_start: protocol.n_views_at_start,
            window: protocol.window,
            stall_limit: protocol.stall_limit,
            open_set_share: protocol.open_set_share,
            n_runs: arguments.runs,
            seed: arguments.lessons.seed,
        }
    }
}
