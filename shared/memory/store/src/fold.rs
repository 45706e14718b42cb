//! What the history says the store must hold, to compare with what it holds.

use std::collections::{BTreeMap, BTreeSet};

use learning::ViewId;

use crate::catalogue::Catalogue;
use crate::digest::Digest;
use crate::document::DocumentKey;
use crate::error::in_words;
use crate::findings::Findings;
use crate::history::{Effect, HistoryEntry, Operation, is_among};
use crate::standing::Standing;

/// A view by the history.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Folded {
    pub(crate) identity: Digest,
    pub(crate) standing: Standing,
    /// The entry that touched it last.
    pub(crate) sequence: u64,
}

/// All effects of the entries so far.
#[derive(Debug, Default)]
pub(crate) struct Fold {
    pub(crate) views: BTreeMap<ViewId, Folded>,
    versions: BTreeSet<(DocumentKey, u64)>,
    tombstones: BTreeSet<Digest>,
    /// Sequence, digest of the entry before, own digest.
    links: Vec<(u64, Digest, Digest)>,
    lost: Vec<(u64, u64)>,
}

impl Fold {
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
                let folded = Folded {
                    identity: *identity,
                    standing: Standing::Unnamed,
                    sequence,
                };
                self.views.insert(*view, folded);
            }
            Effect::Changed { view, after, .. } => {
                if let Some(folded) = self.views.get_mut(view) {
                    folded.standing = after.clone();
                    folded.sequence = sequence;
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

    /// Versions of documents that were not purged.
    pub(crate) fn into_versions(self) -> BTreeSet<(DocumentKey, u64)> {
        self.versions
    }

    /// Number of entries.
    pub(crate) fn n_entries(&self) -> u64 {
        self.links.len() as u64
    }

    /// Sequence and digest of the last entry.
    pub(crate) fn head(&self) -> (u64, Digest) {
        let last = self.links.last();
        last.map_or((0, Digest::default()), |(sequence, _, digest)| {
            (*sequence, *digest)
        })
    }

    /// Entries known to be lost.
    pub(crate) fn lost(&self) -> &[(u64, u64)] {
        &self.lost
    }

    /// Entries that are missing without that being known, and entries that do not
    /// follow the one before.
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

    /// Where the store holds something else.
    pub(crate) fn compare(&self, catalogue: &Catalogue, findings: &mut Findings) {
        for (&view, folded) in &self.views {
            match catalogue.get(view) {
                None => findings.add(|| format!("{} is missing", in_words(view))),
                Some(entry) if entry.identity != folded.identity => {
                    findings.add(|| format!("{} is another one", in_words(view)));
                }
                Some(entry) if entry.register.standing != folded.standing => {
                    let (is, must) = (&entry.register.standing, &folded.standing);
                    findings.add(|| {
                        format!(
                            "{} stands for {is}, by the history for {must}",
                            in_words(view)
                        )
                    });
                }
                Some(_) => {}
            }
        }
        for (view, _) in catalogue.all() {
            if !self.views.contains_key(&view) {
                findings.add(|| format!("the history does not know of {}", in_words(view)));
            }
        }
        let present: BTreeSet<(DocumentKey, u64)> = catalogue
            .versions()
            .map(|(document, sequence, ..)| (document.clone(), sequence))
            .collect();
        for (document, sequence) in present.symmetric_difference(&self.versions) {
            findings.add(|| {
                format!("{document}, as of entry {sequence}, is not what the history says")
            });
        }
        let n_differing = self
            .tombstones
            .iter()
            .filter(|identity| !catalogue.tombstones.contains_key(identity))
            .count()
            + catalogue
                .tombstones
                .len()
                .saturating_sub(self.tombstones.len());
        if n_differing > 0 {
            findings.add(|| format!("{n_differing} notes of forgotten views are missing"));
        }
    }
}
