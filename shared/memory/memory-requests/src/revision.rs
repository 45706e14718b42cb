//! Conversion of revisions (changes other than teaching and the storing of documents) into store
//! changes.

use crate::translate;
use control_protocol::{
    DocumentKind as WireKind, DocumentName, Refusal, RefusalKind, RevisionChange,
};
use perceptual_memory::{DocumentKey, DocumentKind, StoreChange, Target};

/// Store change of a revision, and its subject for the answer.
pub(crate) fn change(change: RevisionChange) -> Result<(StoreChange, String), Refusal> {
    let category = |name: &str| translate::category(name);
    Ok(match change {
        RevisionChange::ForgetTrack { track_id } => (
            StoreChange::Forget(Target::Track(track_id)),
            format!("track {track_id}"),
        ),
        RevisionChange::ForgetView { view } => {
            let target = Target::View(translate::local_id(view));
            let about = target.to_string();
            (StoreChange::Forget(target), about)
        }
        RevisionChange::CorrectView {
            view,
            category: name,
            is_new,
        } => {
            let target = Target::View(translate::local_id(view));
            let category = category(&name)?;
            let change = StoreChange::Correct { target, category };
            (allowing_alike(is_new, change), name)
        }
        RevisionChange::Rename { from, to, is_new } => {
            let change = StoreChange::Rename {
                from: category(&from)?,
                to: category(&to)?,
            };
            (allowing_alike(is_new, change), to)
        }
        RevisionChange::Merge { from, into } => {
            let change = StoreChange::MergeCategories {
                from: category(&from)?,
                into: category(&into)?,
            };
            (change, into)
        }
        RevisionChange::Undo { sequence } => (StoreChange::Undo { sequence }, String::new()),
        RevisionChange::Redo => (StoreChange::Redo, String::new()),
        RevisionChange::RemoveDocument { document } => {
            let about = document.name.clone();
            (StoreChange::RemoveDocument(key(document)?), about)
        }
        RevisionChange::PutDocument { .. } => {
            let sentence = "a document is stored with its upload";
            return Err(Refusal::new(RefusalKind::Internal, sentence));
        }
    })
}

/// The change, which may make a category with a name like that of another one if `is_new` is set.
pub(crate) fn allowing_alike(is_new: bool, change: StoreChange) -> StoreChange {
    if is_new {
        StoreChange::AllowingAlike(Box::new(change))
    } else {
        change
    }
}

/// Store key of a document with a wire name.
pub(crate) fn key(document: DocumentName) -> Result<DocumentKey, Refusal> {
    let kind = match document.kind {
        WireKind::ObjectModel => DocumentKind::ObjectModel,
        WireKind::TaskKnowledge => DocumentKind::TaskKnowledge,
        other => {
            let sentence = format!("this memory knows no documents of the kind {other:?}");
            return Err(Refusal::new(RefusalKind::Invalid, sentence));
        }
    };
    Ok(DocumentKey {
        kind,
        name: document.name.into(),
    })
}

/// Wire name of a document with a store key.
pub(crate) fn name(key: &DocumentKey) -> Option<DocumentName> {
    let kind = match key.kind {
        DocumentKind::ObjectModel => WireKind::ObjectModel,
        DocumentKind::TaskKnowledge => WireKind::TaskKnowledge,
        _ => return None,
    };
    Some(DocumentName {
        kind,
        name: key.name.to_string(),
    })
}
