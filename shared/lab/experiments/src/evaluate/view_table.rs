//! Table of the described views: categories, labels, files, and the omitted views.

use evaluation::recogniser::LabelledView;

/// Most sentences about what was left out that are kept.
const MOST_SENTENCES: usize = 20;

/// What is known of the views that could be described.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ViewTable {
    /// Names of the categories by number; each has a view.
    pub(super) categories: Vec<String>,
    /// Category and object of each view.
    pub(super) labels: Vec<LabelledView>,
    /// File of each view, relative to the data set.
    pub(super) files: Vec<String>,
    pub(super) omissions: Omissions,
    /// Whether of all views it is known what is up.
    pub(super) is_up_known: bool,
    /// Mean time to describe a view on one thread, by all methods together, reading not
    /// included, milliseconds.
    pub(super) describe_ms: f64,
}

/// What is not part of an experiment.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Omissions {
    /// Views and folders of categories.
    pub(super) n: usize,
    /// Why, one sentence each; of many the first.
    pub(super) reasons: Vec<String>,
}

impl Omissions {
    pub(super) fn add(&mut self, n: usize, reason: impl FnOnce() -> String) {
        self.n += n;
        if self.reasons.len() < MOST_SENTENCES {
            self.reasons.push(reason());
        }
    }

    /// For people: the sentences, and how many are not shown.
    pub(super) fn sentences(&self) -> Vec<String> {
        let reasons = self.reasons.iter();
        let mut sentences: Vec<String> = reasons.map(|r| format!("left out: {r}")).collect();
        if self.n > 0 {
            sentences.push(format!("{} views were left out", self.n));
        }
        sentences
    }
}
