//! Latency budget: limits that a report must keep.

use crate::duration_percentiles::DurationPercentiles;
use crate::report::{LatencyReport, by_stage_word};
use message::Stage;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Limits of one latency distribution, milliseconds; `None` is unlimited.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct LatencyLimits {
    p50_ms: Option<f64>,
    p90_ms: Option<f64>,
    p99_ms: Option<f64>,
    p999_ms: Option<f64>,
    max_ms: Option<f64>,
}

/// Budget limits of counts and shares over the whole run.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct TotalLimits {
    dropped_max: Option<u64>,
    not_captured_max: Option<u64>,
    cores_max: Option<f64>,
    measuring_share_max: Option<f64>,
}

/// Budget file as written (TOML).
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct RawBudget {
    total: TotalLimits,
    end_to_end: LatencyLimits,
    object_label: LatencyLimits,
    #[serde(deserialize_with = "by_stage_word")]
    stages: BTreeMap<String, LatencyLimits>,
}

/// Validated latency budget: limits per stage and percentile.
#[derive(Debug, Clone, PartialEq)]
pub struct Budget(RawBudget);

/// Error of a budget file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct InvalidBudget(String);

/// Figure of the report that exceeds its limit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BudgetViolation {
    /// Name of the figure, such as `end_to_end p99`.
    pub what: String,
    /// Measured value of the figure; milliseconds for durations.
    pub measured: f64,
    /// Budget limit that is exceeded.
    pub limit: f64,
}

impl LatencyLimits {
    fn named(&self) -> [Option<f64>; 5] {
        [
            self.p50_ms,
            self.p90_ms,
            self.p99_ms,
            self.p999_ms,
            self.max_ms,
        ]
    }
}

impl Budget {
    /// Parses and validates a budget file (TOML).
    ///
    /// # Errors
    /// If a key is unknown, a stage does not exist, or a limit is not a positive number.
    pub fn parse(text: &str) -> Result<Self, InvalidBudget> {
        let raw: RawBudget =
            toml::from_str(text).map_err(|error| InvalidBudget(error.to_string()))?;
        for word in raw.stages.keys() {
            if Stage::from_word(word).is_none() {
                return Err(no_stage(word));
            }
        }
        let all = raw
            .stages
            .values()
            .chain([&raw.end_to_end, &raw.object_label]);
        let times = all.flat_map(LatencyLimits::named).flatten();
        let shares = [raw.total.cores_max, raw.total.measuring_share_max];
        for limit in times.chain(shares.into_iter().flatten()) {
            if !(limit.is_finite() && limit > 0.0) {
                return Err(InvalidBudget(format!(
                    "a limit must be a positive number, not {limit}"
                )));
            }
        }
        Ok(Self(raw))
    }

    /// Figures over their limits. A stage with a limit but without samples is a violation:
    /// nothing shows that it keeps its limit.
    pub fn violations(&self, report: &LatencyReport) -> Vec<BudgetViolation> {
        let Self(raw) = self;
        let mut violations = over_totals(&raw.total, report);
        violations.extend(over("end_to_end", &raw.end_to_end, &report.end_to_end_ms));
        violations.extend(over(
            "object_label",
            &raw.object_label,
            &report.object_label_ms,
        ));
        for (word, limits) in &raw.stages {
            match report.stages.get(word) {
                Some(stage) => violations.extend(over(word, limits, &stage.ms)),
                None => violations.push(BudgetViolation {
                    what: format!("{word} was never passed"),
                    measured: 0.0,
                    limit: 0.0,
                }),
            }
        }
        violations
    }
}

fn no_stage(word: &str) -> InvalidBudget {
    let words: Vec<&str> = Stage::ALL.iter().map(|stage| stage.word()).collect();
    InvalidBudget(format!(
        "`{word}` is no stage; there are {}",
        words.join(", ")
    ))
}

fn over(
    what: &str,
    limits: &LatencyLimits,
    measured: &DurationPercentiles,
) -> Vec<BudgetViolation> {
    let named = DurationPercentiles::NAMED.iter().zip(limits.named());
    named
        .filter_map(|((name, get), limit)| {
            let (measured, limit) = (get(measured), limit?);
            (measured > limit).then(|| BudgetViolation {
                what: format!("{what} {name}"),
                measured,
                limit,
            })
        })
        .collect()
}

fn over_totals(totals: &TotalLimits, report: &LatencyReport) -> Vec<BudgetViolation> {
    let number = |limit: Option<u64>| limit.map(|limit| limit as f64);
    let figures = [
        (
            "dropped frames",
            number(totals.dropped_max),
            report.dropped as f64,
        ),
        (
            "instants without a frame of the source",
            number(totals.not_captured_max),
            report.not_captured as f64,
        ),
        (
            "cores of the daemon without the source",
            totals.cores_max,
            report.cores_without_source(),
        ),
        (
            "share of the measuring",
            totals.measuring_share_max,
            report.overhead.share_of_frame,
        ),
    ];
    figures
        .into_iter()
        .filter_map(|(what, limit, measured)| {
            let limit = limit?;
            (measured > limit).then(|| BudgetViolation {
                what: what.to_owned(),
                measured,
                limit,
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::StageReport;

    fn report() -> LatencyReport {
        let ms = DurationPercentiles {
            p50: 5.0,
            p90: 6.0,
            p99: 9.0,
            p999: 12.0,
            max: 20.0,
        };
        let detection = StageReport {
            ms,
            ..StageReport::default()
        };
        LatencyReport {
            dropped: 2,
            end_to_end_ms: ms,
            stages: [("detection".to_owned(), detection)].into(),
            ..LatencyReport::default()
        }
    }

    fn over(text: &str) -> Vec<String> {
        let violations = Budget::parse(text).unwrap().violations(&report());
        violations.into_iter().map(|excess| excess.what).collect()
    }

    #[test]
    fn violations_name_the_figure_over_its_limit() {
        assert_eq!(over(""), Vec::<String>::new());
        let text = "[end_to_end]\np50_ms = 8\np99_ms = 8.5\n[total]\ndropped_max = 0";
        assert_eq!(over(text), ["dropped frames", "end_to_end p99"]);
        let text = "[stages.detection]\nmax_ms = 20.0\np999_ms = 11.9";
        assert_eq!(over(text), ["detection p999"]);
        let text = "[stages.recognition]\np50_ms = 1";
        assert_eq!(over(text), ["recognition was never passed"]);
    }

    #[test]
    fn invalid_budgets_are_refused_with_the_rule() {
        for (text, word) in [
            ("[stages.detecton]\np50_ms = 1", "detecton"),
            ("[end_to_end]\np95_ms = 1", "p95_ms"),
            ("[end_to_end]\np50_ms = -1", "positive"),
            ("[end_to_end]\np50_ms = nan", "positive"),
            ("p50_ms = 1", "p50_ms"),
        ] {
            let sentence = Budget::parse(text).unwrap_err().to_string();
            assert!(sentence.contains(word), "{sentence}");
        }
    }
}
