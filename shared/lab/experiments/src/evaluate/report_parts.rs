//! Parts that the reports of several experiments share: header, omitted views, output files.

use super::view_table::ViewTable;
use serde::Serialize;
use std::path::Path;

/// Legend of the figures of open-ended learning.
pub(super) const OPEN_ENDED_LEGEND: &str = "qci: questions until the end of a run; tlc: learned \
    categories; aic: taught views of a category; gca: share of right answers; apa: mean protocol \
    accuracy at the ends of the stages";

/// Header of a recognition report.
#[derive(Debug, Serialize)]
pub(super) struct ReportHeader {
    /// Version of the evaluating program.
    version: &'static str,
    /// Name of the data set.
    dataset: String,
    /// Number of categories in the data set.
    pub(super) n_categories: usize,
    /// Number of views in the data set.
    pub(super) n_views: usize,
}

/// Views omitted from a recognition report.
#[derive(Debug, Serialize)]
pub(super) struct OmissionSummary {
    /// Number of omitted views.
    n_left_out: usize,
    /// Reasons for the omissions, one sentence each.
    pub(super) left_out: Vec<String>,
}

/// Paths of the written page and of the report itself.
#[derive(Debug, Serialize)]
pub(super) struct ReportFiles {
    /// Path of the HTML report page.
    pub(super) page: String,
    /// Path of the JSON report.
    pub(super) file: String,
}

impl ReportHeader {
    /// Header of a report about a data set and its described views.
    pub(super) fn new(dataset: String, views: &ViewTable) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION"),
            dataset,
            n_categories: views.categories.len(),
            n_views: views.labels.len(),
        }
    }
}

impl From<&ViewTable> for OmissionSummary {
    fn from(views: &ViewTable) -> Self {
        Self {
            n_left_out: views.omissions.n,
            left_out: views.omissions.sentences(),
        }
    }
}

impl ReportFiles {
    /// Paths of `index.html` and of the report in the output folder.
    pub(super) fn in_folder(out: &Path, report: &str) -> Self {
        let path = |name: &str| out.join(name).display().to_string();
        Self {
            page: path("index.html"),
            file: path(report),
        }
    }

    /// Both paths, for the text of a report.
    pub(super) fn paths(&self) -> Vec<String> {
        vec![self.page.clone(), self.file.clone()]
    }
}
