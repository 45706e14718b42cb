//! Hash chain of the history, checked entry by entry.

use crate::digest::Digest;
use crate::findings::Findings;
use crate::history::HistoryEntry;
use crate::model::{Operation, is_among};

/// Check of consecutive entries: each names the digest of the one before it.
#[derive(Debug, Default)]
pub(crate) struct HistoryChain {
    last: (u64, Digest),
    n_entries: u64,
    /// Ranges of missing entries.
    gaps: Vec<(u64, u64)>,
    /// Ranges that the entries themselves give as lost with a damaged store.
    lost: Vec<(u64, u64)>,
    breaks: Findings,
}

impl HistoryChain {
    /// Chain that goes on after an entry.
    pub(crate) fn after(sequence: u64, digest: Digest) -> Self {
        Self {
            last: (sequence, digest),
            ..Self::default()
        }
    }

    /// Adds the next entry with its digest.
    pub(crate) fn add(&mut self, entry: &HistoryEntry, digest: Digest) {
        let sequence = entry.sequence;
        if sequence > self.last.0 + 1 {
            self.gaps.push((self.last.0 + 1, sequence - 1));
        } else if entry.previous != self.last.1 {
            let sentence = || format!("history entry {sequence} does not follow the one before it");
            self.breaks.add(sentence);
        }
        if let Operation::Rebuild { lost, .. } = &entry.operation {
            self.lost.extend(lost);
        }
        self.last = (sequence, digest);
        self.n_entries += 1;
    }

    /// Sequence number and digest of the last entry.
    pub(crate) fn head(&self) -> (u64, Digest) {
        self.last
    }

    /// Number of entries added.
    pub(crate) fn n_entries(&self) -> u64 {
        self.n_entries
    }

    /// Ranges of entries that the added entries give as lost.
    pub(crate) fn newly_lost(&self) -> &[(u64, u64)] {
        &self.lost
    }

    /// Reports broken links, and missing entries that are not among the lost ones.
    pub(crate) fn report(&self, lost: &[(u64, u64)], findings: &mut Findings) {
        for &(first, last) in &self.gaps {
            if !(first..=last).all(|sequence| is_among(lost, sequence)) {
                findings.add(|| format!("history entries {first} to {last} are missing"));
            }
        }
        findings.merge(&self.breaks);
    }
}
