//! Merge of another memory: a state-based last-writer-wins register per view and document.
//!
//! The latest decision wins wherever it was made; ties are broken by content. The result therefore
//! depends neither on the order of merges nor on their number (state-based CRDT: Shapiro, Preguiça,
//! Baquero and Zawirski 2011).

use std::collections::BTreeSet;

use learning::ViewId;

use crate::decision::Decision;
use crate::digest::Digest;
use crate::document::MemoryDocument;
use crate::error::StoreRefusal;
use crate::exchange::{ForeignDocument, ForeignIdAllocator, ForeignView};
use crate::label_status::{DecisionStamp, LabelStatus};
use crate::meta::Meta;
use crate::model::{Effect, Operation};
use crate::store_index::StoreIndex;
use crate::view::{CapturedView, Origin};
use crate::view_record::ViewParts;

/// Effects of an import: the foreign views, decisions and documents that are new.
pub(crate) fn decide(
    index: &StoreIndex,
    meta: &Meta,
    operation: Operation,
    views: &[ForeignView],
    documents: &[ForeignDocument],
) -> Result<Decision, StoreRefusal> {
    // Each view needs at most one new track.
    if meta
        .next_track_id
        .checked_add(views.len() as u64 + 1)
        .is_none()
    {
        return Err(StoreRefusal::TrackIdsExhausted);
    }
    let mut import = Import {
        index,
        memory_id: meta.memory_id(),
        next_track_id: meta.next_track_id,
        foreign_ids: ForeignIdAllocator::new(meta.next_track_id),
        met: BTreeSet::new(),
        decision: Decision::new(operation, Vec::new()),
    };
    for view in views {
        // Of duplicates in one batch the first counts; an export has each view once.
        if import.met.insert(view.identity()) {
            import.take_view(view);
        }
    }
    for document in documents {
        import.take_document(document);
    }
    import.decision.next_track_id = import.foreign_ids.next_track_id();
    Ok(import.decision)
}

struct Import<'a> {
    index: &'a StoreIndex,
    memory_id: u128,
    /// First track-id that was never leased.
    next_track_id: u64,
    foreign_ids: ForeignIdAllocator,
    met: BTreeSet<Digest>,
    decision: Decision,
}

impl Import<'_> {
    fn take_view(&mut self, foreign: &ForeignView) {
        match foreign {
            ForeignView::Present {
                view,
                origin,
                standing,
                decided,
            } => self.take_present(view, *origin, standing, decided.as_ref()),
            ForeignView::Forgotten { identity, decided } => {
                self.take_forgotten(*identity, decided);
            }
        }
    }

    fn take_present(
        &mut self,
        view: &CapturedView,
        origin: Origin,
        standing: &LabelStatus,
        decided: Option<&DecisionStamp>,
    ) {
        let parts = ViewParts::of(view, origin);
        let identity = parts.metadata.identity();
        if self.index.by_identity(identity).is_some() {
            if let Some(decided) = decided {
                self.change_known(identity, standing, decided);
            }
            return;
        }
        if let Some(forgotten_ns) = self.index.tombstone(identity) {
            let stamp_ns = decided.map_or(0, |decided| decided.stamp_ns);
            if (stamp_ns, standing) <= (forgotten_ns, &LabelStatus::Forgotten) {
                return;
            }
            self.decision.effects.push(Effect::Tombstone {
                identity,
                decided: None,
            });
        }
        let view = match self.without_its_cloud(&parts) {
            // The local view lost its point cloud: the complete one replaces it.
            Some(view) => {
                self.decision.effects.push(Effect::Purged { view });
                view
            }
            None => self.id_for(origin),
        };
        self.decision
            .effects
            .push(Effect::Stored { view, identity });
        self.decision.contents.views.insert(identity, parts);
        self.decide(view, standing, decided);
    }

    /// Sets the label status of an inserted view to the latest decision.
    fn decide(&mut self, view: ViewId, standing: &LabelStatus, decided: Option<&DecisionStamp>) {
        let before = self.index.get(view).map(|entry| &entry.register);
        let theirs = decided.map(|decided| (standing, decided));
        // Decision on the view that it replaces.
        let ours = before.map(|register| (&register.standing, &register.decided));
        let latest = theirs
            .into_iter()
            .chain(ours)
            .max_by_key(|(standing, decided)| (decided.stamp_ns, *standing));
        if let Some((standing, decided)) = latest.filter(|(s, _)| **s != LabelStatus::Unnamed) {
            self.decision.effects.push(Effect::Changed {
                view,
                before: LabelStatus::Unnamed,
                after: standing.clone(),
                decided: Some(decided.clone()),
            });
        }
    }

    /// Local view that equals the imported one except for its point cloud, which a damaged store
    /// lost.
    fn without_its_cloud(&self, whole: &ViewParts) -> Option<ViewId> {
        let origin = whole.metadata.origin();
        let (track_id, _) = self.index.track_of_origin(origin)?;
        let mut of_track = self.index.track(track_id);
        let (view, known) = of_track.find(|(_, known)| known.origin == origin)?;
        let is_same = known.descriptor == whole.metadata.descriptor
            && known.captured_ns == whole.metadata.captured_ns;
        let lacks_cloud = known.points.is_none() && whole.metadata.points.is_some();
        (is_same && lacks_cloud).then_some(view)
    }

    fn id_for(&mut self, origin: Origin) -> ViewId {
        // A view that was first stored here and lost comes back under its id.
        let is_own = origin.memory_id == self.memory_id;
        let is_leased = origin.view.track_id < self.next_track_id;
        let is_free = self.index.get(origin.view).is_none();
        if is_own && is_leased && is_free && self.foreign_ids.give(origin.view) {
            return origin.view;
        }
        let index = self.index;
        self.foreign_ids
            .id_for(origin, || index.track_of_origin(origin))
    }

    fn take_forgotten(&mut self, identity: Digest, decided: &DecisionStamp) {
        if self.index.by_identity(identity).is_some() {
            return self.change_known(identity, &LabelStatus::Forgotten, decided);
        }
        let known_ns = self.index.tombstone(identity);
        if known_ns.is_none_or(|known_ns| known_ns < decided.stamp_ns) {
            self.decision.effects.push(Effect::Tombstone {
                identity,
                decided: Some(decided.clone()),
            });
        }
    }

    fn change_known(&mut self, identity: Digest, standing: &LabelStatus, decided: &DecisionStamp) {
        let Some((view, entry)) = self.index.by_identity(identity) else {
            return;
        };
        let register = &entry.register;
        if register.yields_to(decided.stamp_ns, standing) {
            self.decision.effects.push(Effect::Changed {
                view,
                before: register.standing.clone(),
                after: standing.clone(),
                decided: Some(decided.clone()),
            });
        }
    }

    fn take_document(&mut self, foreign: &ForeignDocument) {
        let after = foreign.document.as_ref().map(MemoryDocument::summary);
        let known = self.index.document(&foreign.key);
        let rank = |content: Option<Digest>, stamp_ns: u64| (stamp_ns, content);
        let digest = after.as_ref().map(|content| content.digest);
        let is_later = known.is_none_or(|(_, known)| {
            let known_digest = known.content.as_ref().map(|content| content.digest);
            rank(known_digest, known.decided.stamp_ns) < rank(digest, foreign.decided.stamp_ns)
        });
        if !is_later {
            return;
        }
        if let (Some(content), Some(document)) = (&after, &foreign.document) {
            let bytes = document.content.clone();
            self.decision
                .contents
                .documents
                .insert(content.digest, bytes);
        }
        self.decision.effects.push(Effect::Document {
            document: foreign.key.clone(),
            before: known.and_then(|(_, known)| known.content.clone()),
            after,
            decided: Some(foreign.decided.clone()),
        });
    }
}
