//! Projection of the history: the store content it implies, for comparison with the stored records.

use std::collections::{BTreeMap, BTreeSet};

use learning::ViewId;

use crate::digest::Digest;
use crate::document_key::DocumentKey;
use crate::findings::Findings;
use crate::history::HistoryEntry;
use crate::label_status::LabelStatus;
use crate::model::{Effect, Operation, is_among};
use crate::store_index::StoreIndex;
use crate::view_phrase::view_phrase;

/// State of a view as implied by the history.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct ProjectedView {
    pub(crate) identity: Digest,
    pub(crate) standing: LabelStatus,
    /// Sequence number of the last entry that touched the view.
    pub(crate) sequence: u64,
}

/// Accumulated effects of the history entries.
#[derive(Debug, Default)]
pub(crate) struct HistoryProjection {
    pub(crate) views: BTreeMap<ViewId, ProjectedView>,
    versions: BTreeSet<(DocumentKey, u64)>,
    tombstones: BTreeSet<Digest>,
    /// Links of the hash chain: sequence number, digest of the predecessor, own digest.
    links: Vec<(u64, Digest, Digest)>,
    lost: Vec<(u64, u64)>,
}

impl HistoryProjection {
    pub(crate) fn apply(&mut self, entry: &HistoryEntry, digest: Digest) {
        self.links.push((entry.sequence, entry.previous, digest));
        if let Operation::Rebuild { lost, .. } = &entry.operation {
            self.lost.extend(lost);
        }
        for effect in &entry.effects {
            self.make(effect, entry.sequence);
        }
    }

    fn make(&mut self, effect: &Effect, sequence: u64) {
        match effect {
            Effect::Stored { view, identity } => {
                let projected = ProjectedView {
                    identity: *identity,
                    standing: LabelStatus::Unnamed,
                    sequence,
                };
                self.views.insert(*view, projected);
            }
            Effect::Changed { view, after, .. } => {
                if let Some(projected) = self.views.get_mut(view) {
                    projected.standing = after.clone();
                    projected.sequence = sequence;
                }
            }
            Effect::Purged { view } => {
                self.views.remove(view);
            }
            Effect::Tombstone { identity, decided } => {
                if decided.is_some() {
                    self.tombstones.insert(*identity);
                } else {
                    self.tombstones.remove(identity);
                }
            }
            Effect::Document { document, .. } => {
                self.versions.insert((document.clone(), sequence));
            }
            Effect::VersionPurged { document, sequence } => {
                self.versions.remove(&(document.clone(), *sequence));
            }
        }
    }

    /// Document versions that have not been purged.
    pub(crate) fn into_versions(self) -> BTreeSet<(DocumentKey, u64)> {
        self.versions
    }

    /// Number of history entries.
    pub(crate) fn n_entries(&self) -> u64 {
        self.links.len() as u64
    }

    /// Sequence number and digest of the last history entry.
    pub(crate) fn head(&self) -> (u64, Digest) {
        let last = self.links.last();
        last.map_or((0, Digest::default()), |(sequence, _, digest)| {
            (*sequence, *digest)
        })
    }

    /// Ranges of entries known to be lost.
    pub(crate) fn lost(&self) -> &[(u64, u64)] {
        &self.lost
    }

    /// Verifies the hash chain: reports missing entries and wrong predecessors.
    pub(crate) fn check_chain(&self, findings: &mut Findings) {
        let is_lost = |sequence| is_among(&self.lost, sequence);
        let mut before = (0, Digest::default());
        for &(sequence, previous, digest) in &self.links {
            if sequence == before.0 + 1 {
                if previous != before.1 {
                    findings.add(|| {
                        format!("history entry {sequence} does not follow the one before it")
                    });
                }
            } else if !(before.0 + 1..sequence).all(is_lost) {
                let (first, last) = (before.0 + 1, sequence - 1);
                findings.add(|| format!("history entries {first} to {last} are missing"));
            }
            before = (sequence, digest);
        }
    }

    /// Reports differences between the projection of the history and the stored records.
    pub(crate) fn compare(&self, index: &StoreIndex, findings: &mut Findings) {
        for (&view, projected) in &self.views {
            match index.get(view) {
                None => findings.add(|| format!("{} is missing", view_phrase(view))),
                Some(entry) if entry.identity != projected.identity => {
                    findings.add(|| format!("{} is another one", view_phrase(view)));
                }
                Some(entry) if entry.register.standing != projected.standing => {
                    let (is, must) = (&entry.register.standing, &projected.standing);
                    findings.add(|| {
                        format!(
                            "{} stands for {is}, by the history for {must}",
                            view_phrase(view)
                        )
                    });
                }
                Some(_) => {}
            }
        }
        for (view, _) in index.all() {
            if !self.views.contains_key(&view) {
                findings.add(|| format!("the history does not know of {}", view_phrase(view)));
            }
        }
        let present: BTreeSet<(DocumentKey, u64)> = index
            .versions()
            .map(|(document, sequence, ..)| (document.clone(), sequence))
            .collect();
        for (document, sequence) in present.symmetric_difference(&self.versions) {
            findings
                .add(|| format!("{document}, as of entry {sequence}, does not match the history"));
        }
        let n_differing = self
            .tombstones
            .iter()
            .filter(|identity| !index.tombstones.contains_key(identity))
            .count()
            + index.tombstones.len().saturating_sub(self.tombstones.len());
        if n_differing > 0 {
            findings.add(|| format!("{n_differing} notes of forgotten views are missing"));
        }
    }
}
