//! Descriptions of changes and history entries for logs and users.

use perceptual_memory::{Contradiction, Operation, StoreChange};

/// Description of a requested change.
pub(crate) fn describe_change(change: &StoreChange) -> String {
    match change {
        StoreChange::StoreViews(views) => format!("store {} view(s)", views.len()),
        StoreChange::Teach { track_id, category } => {
            format!("teach track {track_id} as {category}")
        }
        StoreChange::Correct { target, category } => format!("correct {target} to {category}"),
        StoreChange::Forget(target) => format!("forget {target}"),
        StoreChange::Rename { from, to } => format!("rename {from} to {to}"),
        StoreChange::MergeCategories { from, into } => format!("merge {from} into {into}"),
        StoreChange::Undo {
            sequence: Some(sequence),
        } => format!("undo entry {sequence}"),
        StoreChange::Undo { sequence: None } => "undo the last change".to_owned(),
        StoreChange::Redo => "redo the change that was undone last".to_owned(),
        StoreChange::PutDocument(document) => format!("store {}", document.key),
        StoreChange::RemoveDocument(key) => format!("remove {key}"),
        StoreChange::AllowingAlike(change) => describe_change(change),
        StoreChange::NormaliseNames => "bring the names of categories into one form".to_owned(),
        StoreChange::Purge { .. } => "permanently delete forgotten content".to_owned(),
        StoreChange::PurgeTombstones { .. } => "delete old notes of forgotten content".to_owned(),
        StoreChange::Import { source, .. } => format!("import {source}"),
        _ => "unknown change".to_owned(),
    }
}

/// Description of the operation of a history entry.
pub(crate) fn describe_operation(operation: &Operation) -> String {
    match operation {
        Operation::StoreViews => "store views".to_owned(),
        Operation::Teach { track_id, category } => format!("teach track {track_id} as {category}"),
        Operation::Correct { target, category } => format!("correct {target} to {category}"),
        Operation::Forget { target } => format!("forget {target}"),
        Operation::Rename { from, to } => format!("rename {from} to {to}"),
        Operation::MergeCategories { from, into } => format!("merge {from} into {into}"),
        Operation::Undo {
            redone: Some(redone),
            ..
        } => format!("redo entry {redone}"),
        Operation::Undo { sequence, .. } => format!("undo entry {sequence}"),
        Operation::Import { source, part } => match part.first {
            Some(first) => format!("import {source}, continued from entry {first}"),
            None => format!("import {source}"),
        },
        Operation::PutDocument { document } => format!("store {document}"),
        Operation::RemoveDocument { document } => format!("remove {document}"),
        Operation::NormaliseNames { names } => {
            let pairs = names.iter().map(|(from, to)| format!("{from} as {to}"));
            let pairs: Vec<_> = pairs.collect();
            format!(
                "bring the names of categories into one form: {}",
                pairs.join(", ")
            )
        }
        Operation::Purge => "permanently delete forgotten content".to_owned(),
        Operation::EnforceLimit {
            category: Some(category),
        } => format!("prune redundant views of {category}"),
        Operation::EnforceLimit { category: None } => {
            "delete the oldest unlabelled views".to_owned()
        }
        Operation::Rebuild { loss, .. } => format!("rebuild a damaged store; lost: {loss}"),
        Operation::Migrate { schema } => format!("migrate the store from schema {schema}"),
        _ => "unknown change".to_owned(),
    }
}

/// Explanation for an author whose label contradicts an earlier one.
pub(crate) fn describe_contradiction(asked: &str, said: &Contradiction, sequence: u64) -> String {
    let author = match &*said.decided.author {
        "" => "another author",
        author => author,
    };
    let present = &said.present;
    format!(
        "you asked to {asked}, but {author} taught it as {present}, so the label stays; entry \
         {sequence} of the history records your request, correct it if {present} is wrong"
    )
}
