//! Bounded list of findings: all are counted, the first ones are kept as sentences.

/// Maximum number of findings kept as sentences.
const MAX_SENTENCES: usize = 32;

/// Inconsistencies found by a consistency check.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Findings {
    sentences: Vec<String>,
    n: u64,
}

impl Findings {
    pub(crate) fn add(&mut self, finding: impl FnOnce() -> String) {
        self.n += 1;
        if self.sentences.len() < MAX_SENTENCES {
            self.sentences.push(finding());
        }
    }

    /// Adds `n` findings, of which only the first are given as sentences.
    pub(crate) fn extend(&mut self, n: u64, sentences: Vec<String>) {
        let n_omitted = n - (sentences.len() as u64).min(n);
        for finding in sentences {
            self.add(|| finding);
        }
        self.n += n_omitted;
    }

    /// Adds all findings of another check.
    pub(crate) fn merge(&mut self, other: &Self) {
        self.extend(other.n, other.sentences.clone());
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.n == 0
    }

    pub(crate) fn count(&self) -> u64 {
        self.n
    }

    /// Sentences of the findings, with the total count if some are left out.
    pub(crate) fn into_words(mut self) -> Vec<String> {
        if self.n > self.sentences.len() as u64 {
            let n = self.n;
            self.sentences.push(format!("{n} findings in all"));
        }
        self.sentences
    }
}
