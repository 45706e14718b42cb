//! Table of the described views: categories, labels, files, and the omitted views.

use evaluation::recogniser::LabelledView;

/// Maximum number of kept reasons. Chosen.
const MOST_SENTENCES: usize = 20;

/// Labels and files of the described views.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct ViewTable {
    /// Category names by number; each category has a view.
    pub(super) categories: Vec<String>,
    /// Category and instance of each view.
    pub(super) labels: Vec<LabelledView>,
    /// File of each view, relative to the data set.
    pub(super) files: Vec<String>,
    pub(super) omissions: Omissions,
    /// True if the upward direction is known for all views.
    pub(super) is_up_known: bool,
    /// Mean description time of a view on one thread, by all methods together, without reading,
    /// milliseconds.
    pub(super) describe_ms: f64,
}

/// Views omitted from an experiment.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Omissions {
    /// Number of omitted views and category folders.
    pub(super) n: usize,
    /// Reasons, one sentence each; only the first ones are kept.
    pub(super) reasons: Vec<String>,
}

impl Omissions {
    pub(super) fn add(&mut self, n: usize, reason: impl FnOnce() -> String) {
        self.n += n;
        if self.reasons.len() < MOST_SENTENCES {
            self.reasons.push(reason());
        }
    }

    /// Sentences for the report: the reasons and the number of omitted views.
    pub(super) fn sentences(&self) -> Vec<String> {
        let reasons = self.reasons.iter();
        let mut sentences: Vec<String> = reasons.map(|r| format!("left out: {r}")).collect();
        if self.n > 0 {
            sentences.push(format!("{} views were left out", self.n));
        }
        sentences
    }
}
