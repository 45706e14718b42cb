//! Projection of the history: the store content it implies, for comparison with the stored records
//! and for a rebuild.

use std::collections::BTreeMap;

use learning::ViewId;

use crate::digest::Digest;
use crate::document::DocumentVersion;
use crate::document_key::DocumentKey;
use crate::findings::Findings;
use crate::history::HistoryEntry;
use crate::label_status::LwwRegister;
use crate::model::Effect;
use crate::store_index::StoreIndex;
use crate::view_phrase::view_phrase;

/// State of a view as implied by the history.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct ProjectedView {
    pub(crate) identity: Digest,
    pub(crate) register: LwwRegister,
}

/// Accumulated effects of the history entries. Its memory is in proportion to the content of the
/// store, not to the number of entries.
#[derive(Debug, Clone, Default)]
pub(crate) struct HistoryProjection {
    pub(crate) views: BTreeMap<ViewId, ProjectedView>,
    /// Document versions that have not been purged.
    pub(crate) versions: BTreeMap<(DocumentKey, u64), DocumentVersion>,
    /// Times at which purged views were forgotten, nanoseconds since 1970, UTC.
    pub(crate) tombstones: BTreeMap<Digest, u64>,
}

impl HistoryProjection {
    pub(crate) fn apply(&mut self, entry: &HistoryEntry) {
        for effect in &entry.effects {
            self.make(effect, entry);
        }
    }

    fn make(&mut self, effect: &Effect, entry: &HistoryEntry) {
        match effect {
            Effect::Stored { view, identity } => {
                let projected = ProjectedView {
                    identity: *identity,
                    register: LwwRegister::untouched(entry.sequence),
                };
                self.views.insert(*view, projected);
            }
            Effect::Changed {
                view,
                after,
                decided,
                ..
            } => {
                if let Some(ProjectedView { register, .. }) = self.views.get_mut(view) {
                    let last_ns = register.decided.stamp_ns;
                    let decided = decided.clone();
                    register.decided = decided.unwrap_or_else(|| entry.decided_after(last_ns));
                    register.standing = after.clone();
                    register.sequence = entry.sequence;
                }
            }
            Effect::Purged { view } => {
                self.views.remove(view);
            }
            Effect::Tombstone { identity, decided } => match decided {
                Some(decided) => drop(self.tombstones.insert(*identity, decided.stamp_ns)),
                None => drop(self.tombstones.remove(identity)),
            },
            Effect::Document {
                document,
                after,
                decided,
                ..
            } => {
                // An entry states the stamp itself when the clock has stepped back.
                let decided = decided.clone().unwrap_or_else(|| entry.decided_after(0));
                let content = after.clone();
                let version = DocumentVersion { content, decided };
                let key = (document.clone(), entry.sequence);
                self.versions.insert(key, version);
            }
            Effect::VersionPurged { document, sequence } => {
                self.versions.remove(&(document.clone(), *sequence));
            }
        }
    }

    /// Reports differences between the projection of the history and the stored records.
    pub(crate) fn compare(&self, index: &StoreIndex, findings: &mut Findings) {
        self.compare_views(index, findings);
        let mut n_present = 0;
        for (document, sequence, version, _) in index.versions() {
            n_present += 1;
            if self.versions.get(&(document.clone(), sequence)) != Some(version) {
                findings.add(|| {
                    format!("{document}, as of entry {sequence}, does not match the history")
                });
            }
        }
        let n_missing = self.versions.len().saturating_sub(n_present);
        if n_missing > 0 {
            findings.add(|| format!("{n_missing} versions of documents are missing"));
        }
        let present: BTreeMap<Digest, u64> = index.tombstones().collect();
        if present != self.tombstones {
            let (is, must) = (present.len(), self.tombstones.len());
            findings.add(|| {
                format!("the {is} notes of forgotten views are not the {must} of the history")
            });
        }
    }

    fn compare_views(&self, index: &StoreIndex, findings: &mut Findings) {
        for (&view, projected) in &self.views {
            match index.get(view) {
                None => findings.add(|| format!("{} is missing", view_phrase(view))),
                Some(row) if row.identity != projected.identity => {
                    findings.add(|| format!("{} is another one", view_phrase(view)));
                }
                Some(row) if row.register != projected.register => {
                    let is = &row.register.standing;
                    let must = &projected.register.standing;
                    let sequence = projected.register.sequence;
                    findings.add(|| {
                        format!(
                            "{} stands for {is}, by history entry {sequence} for {must}",
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
    }
}
