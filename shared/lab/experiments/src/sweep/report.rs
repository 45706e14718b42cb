//! Table of a sweep: each constant, factor, and the change of each score.

use super::constant::Constant;
use super::measurement::{Measurement, Scores};
use crate::output_files::write;
use command_line::format_table;
use serde::Serialize;
use service::Failure;
use std::path::Path;

/// Scores with the original constants, and the rows of the scaled ones.
#[derive(Debug, Serialize)]
pub(super) struct SweepReport {
    /// Names of the evaluation's scores.
    scores: Vec<&'static str>,
    /// Scores with the constants as they are.
    original: Scores,
    rows: Vec<SweepRow>,
}

/// Scores measured with one scaled constant.
#[derive(Debug, Serialize)]
pub(super) struct SweepRow {
    file: String,
    constant: String,
    expression: String,
    factor: f64,
    /// Scores with the scaled constant; `None` when it does not build or run.
    scores: Option<Scores>,
    /// Reason why the scores are missing.
    failure: Option<String>,
}

impl SweepRow {
    pub(super) fn new(constant: &Constant, factor: f64, scores: Result<Scores, Failure>) -> Self {
        let (scores, failure) = match scores {
            Ok(scores) => (Some(scores), None),
            Err(failure) => (None, Some(failure.sentence)),
        };
        Self {
            file: constant.file.display().to_string(),
            constant: constant.name.clone(),
            expression: constant.expression.clone(),
            factor,
            scores,
            failure,
        }
    }
}

impl SweepReport {
    pub(super) fn new(measure: &Measurement, original: Scores) -> Self {
        Self {
            scores: measure.names().collect(),
            original,
            rows: Vec::new(),
        }
    }

    pub(super) fn push(&mut self, row: SweepRow) {
        self.rows.push(row);
    }

    /// Writes the sweep report as `sweep.json`.
    pub(super) fn write(&self, out: &Path) -> Result<(), Failure> {
        let json = serde_json::to_vec_pretty(self).map_err(Failure::general)?;
        write(&out.join("sweep.json"), &json)
    }

    /// Text table: change of each score by row.
    pub(super) fn text(&self) -> String {
        let mut heading = vec!["constant", "value", "factor"];
        heading.extend(&self.scores);
        let mut original = vec!["as they are".to_owned(), String::new(), String::new()];
        original.extend(self.original.iter().map(|score| format!("{score:.4}")));
        let mut rows = vec![original];
        rows.extend(self.rows.iter().map(|row| self.line(row)));
        format_table(&heading, &rows)
    }

    fn line(&self, row: &SweepRow) -> Vec<String> {
        let mut line = vec![
            row.constant.clone(),
            row.expression.clone(),
            format!("{}", row.factor),
        ];
        match &row.scores {
            Some(scores) => line.extend(
                scores
                    .iter()
                    .zip(&self.original)
                    .map(|(score, original)| format!("{:+.4}", score - original)),
            ),
            None => line.push(row.failure.clone().unwrap_or_default()),
        }
        line
    }
}
