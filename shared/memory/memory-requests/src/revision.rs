//! Conversion of revisions (changes other than teaching) into store changes.

use crate::translate;
use message::control::{
    DocumentKind as WireKind, DocumentName, Refusal, RefusalKind, RevisionChange,
};
use store::{Change, DocumentKey, DocumentKind, MemoryDocument, Target};

/// Store change of a revision, and its subject for the answer.
pub(crate) fn change(change: RevisionChange) -> Result<(Change, String), Refusal> {
    let category = |name: &str| translate::category(name);
    Ok(match change {
        RevisionChange::ForgetTrack { track_id } => (
            Change::Forget(Target::Track(track_id)),
            format!("track {track_id}"),
        ),
        RevisionChange::ForgetView { view } => {
            let target = Target::View(translate::local_id(view));
            let about = target.to_string();
            (Change::Forget(target), about)
        }
        RevisionChange::CorrectView {
            view,
            category: name,
        } => {
            let target = Target::View(translate::local_id(view));
            let category = category(&name)?;
            (Change::Correct { target, category }, name)
        }
        RevisionChange::Rename { from, to } => {
            let change = Change::Rename {
                from: category(&from)?,
                to: category(&to)?,
            };
            (change, to)
        }
        RevisionChange::Merge { from, into } => {
            let change = Change::MergeCategories {
                from: category(&from)?,
                into: category(&into)?,
            };
            (change, into)
        }
        RevisionChange::Undo { sequence } => (Change::Undo { sequence }, String::new()),
        RevisionChange::PutDocument {
            document,
            media_type,
            content,
        } => {
            let about = document.name.clone();
            let document = MemoryDocument {
                key: key(document)?,
                media_type,
                content,
            };
            (Change::PutDocument(document), about)
        }
        RevisionChange::RemoveDocument { document } => {
            let about = document.name.clone();
            (Change::RemoveDocument(key(document)?), about)
        }
        other => {
            let sentence = format!("this memory does not know the change {other:?}");
            return Err(Refusal::new(RefusalKind::Invalid, sentence));
        }
    })
}

/// Store key of a document.
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

/// Wire name of a document.
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
