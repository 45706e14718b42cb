//! Decision of a requested change: its effects on the present state, or the reason for a refusal.
//!
//! Pure functions; [`crate::perceptual_memory`] applies the result.

use std::collections::HashMap;

use learning::{CategoryName, LabelChange, TeachingError as TeachingRefusal, ViewId};

use crate::decision::{Decision, change_all};
use crate::digest::Digest;
use crate::document::MemoryDocument;
use crate::document_key::DocumentKey;
use crate::error::StoreRefusal;
use crate::importing;
use crate::index_row::IndexedView;
use crate::label_status::LabelStatus;
use crate::meta::Meta;
use crate::model::{Contradiction, Effect, Operation, Target};
use crate::mutation::StoreChange;
use crate::new_names;
use crate::purge;
use crate::store_index::StoreIndex;
use crate::view::{CapturedView, Origin};
use crate::view_record::ViewParts;

/// Decides every change except undo and redo, which have to read the history.
pub(crate) fn decide(
    index: &StoreIndex,
    meta: &Meta,
    change: &StoreChange,
) -> Result<Decision, StoreRefusal> {
    let decision = decide_with_any_name(index, meta, change)?;
    match change {
        // The names of an import were checked as a whole before its first entry.
        StoreChange::Import { .. }
        | StoreChange::AllowingAlike(_)
        | StoreChange::NormaliseNames => {}
        _ => new_names::check(index, &decision)?,
    }
    Ok(decision)
}

/// Decides a change whose category may have a name like that of another one.
fn decide_with_any_name(
    index: &StoreIndex,
    meta: &Meta,
    change: &StoreChange,
) -> Result<Decision, StoreRefusal> {
    match change {
        StoreChange::AllowingAlike(change) => decide_with_any_name(index, meta, change),
        StoreChange::NormaliseNames => Ok(new_names::normalise(index)),
        StoreChange::StoreViews(views) => store_views(index, meta, views),
        StoreChange::Teach { track_id, category } => teach(index, *track_id, category),
        StoreChange::Correct { target, category } => correct(index, target, category),
        StoreChange::Forget(target) => forget(index, target),
        StoreChange::Rename { from, to } => rename(index, from, to),
        StoreChange::MergeCategories { from, into } => merge(index, from, into),
        StoreChange::Import {
            source,
            views,
            documents,
            part,
        } => {
            let operation = Operation::Import {
                source: source.clone(),
                part: *part,
            };
            importing::decide(index, meta, operation, views, documents)
        }
        StoreChange::PutDocument(document) => Ok(put_document(index, document)),
        StoreChange::RemoveDocument(key) => remove_document(index, key),
        StoreChange::Purge { before_ns } => Ok(purge::decide(index, *before_ns)),
        StoreChange::PurgeTombstones { before_ns } => {
            Ok(purge::decide_tombstones(index, *before_ns))
        }
        StoreChange::Undo { .. } => Err(StoreRefusal::NothingToUndo),
        StoreChange::Redo => Err(StoreRefusal::NothingToRedo),
    }
}

/// Stores the new views, or refuses all.
fn store_views(
    index: &StoreIndex,
    meta: &Meta,
    views: &[CapturedView],
) -> Result<Decision, StoreRefusal> {
    let mut decision = Decision::new(Operation::StoreViews, Vec::new());
    let mut new: HashMap<ViewId, Digest> = HashMap::new();
    for view in views {
        let origin = Origin {
            memory_id: meta.memory_id(),
            view: view.id,
        };
        // An imported view that is sent back under its local id keeps its origin.
        let known = index.get(view.id);
        let parts = ViewParts::of(view, known.map_or(origin, |entry| entry.origin));
        let identity = parts.metadata.identity();
        let known = known.map(|entry| entry.identity);
        match known.or(new.get(&view.id).copied()) {
            // The id may be leased to another track later.
            None if view.id.track_id >= meta.next_track_id => {
                return Err(StoreRefusal::TrackNotLeased { view: view.id });
            }
            None => {
                new.insert(view.id, identity);
                decision.effects.push(Effect::Stored {
                    view: view.id,
                    identity,
                });
                decision.contents.views.insert(identity, parts);
            }
            Some(known) if known == identity => {}
            Some(_) => return Err(StoreRefusal::ViewDiffers { view: view.id }),
        }
    }
    Ok(decision)
}

fn teach(
    index: &StoreIndex,
    track_id: u64,
    category: &CategoryName,
) -> Result<Decision, StoreRefusal> {
    let category = index.stored_name(category);
    let operation = Operation::Teach {
        track_id,
        category: category.clone(),
    };
    match learning::teach(index.records_of_track(track_id), track_id, category) {
        Ok(changes) => Ok(Decision::new(operation, effects(changes))),
        Err(TeachingRefusal::LabelConflict { present, .. }) => {
            let mut decision = Decision::new(operation, Vec::new());
            decision.contradiction = contradiction(index, track_id, &present);
            Ok(decision)
        }
        Err(lesson) => Err(lesson.into()),
    }
}

/// Author and time of the present label of a track.
fn contradiction(
    index: &StoreIndex,
    track_id: u64,
    present: &CategoryName,
) -> Option<Contradiction> {
    let registers = index.track(track_id).map(|(_, entry)| &entry.register);
    let said = registers
        .filter(|register| register.standing.category() == Some(present))
        .max_by_key(|register| register.decided.stamp_ns)?;
    Some(Contradiction {
        present: present.clone(),
        decided: said.decided.clone(),
    })
}

fn effects(changes: Vec<LabelChange>) -> Vec<Effect> {
    let effect = |change: LabelChange| Effect::Changed {
        view: change.id,
        before: LabelStatus::of(change.before),
        after: LabelStatus::of(change.after),
        decided: None,
    };
    changes.into_iter().map(effect).collect()
}

fn correct(
    index: &StoreIndex,
    target: &Target,
    category: &CategoryName,
) -> Result<Decision, StoreRefusal> {
    let category = index.stored_name(category);
    let after = LabelStatus::Named(category.clone());
    let operation = Operation::Correct {
        target: target.clone(),
        category: category.clone(),
    };
    Ok(Decision::new(
        operation,
        change_all(of_target(index, target)?, &after),
    ))
}

fn forget(index: &StoreIndex, target: &Target) -> Result<Decision, StoreRefusal> {
    let after = match target {
        // Only the label is removed: the views stay and can be taught again.
        Target::Category(_) => LabelStatus::Unnamed,
        Target::Track(_) | Target::View(_) => LabelStatus::Forgotten,
    };
    let operation = Operation::Forget {
        target: target.clone(),
    };
    Ok(Decision::new(
        operation,
        change_all(of_target(index, target)?, &after),
    ))
}

fn rename(
    index: &StoreIndex,
    from: &CategoryName,
    to: &CategoryName,
) -> Result<Decision, StoreRefusal> {
    let views = of_target(index, &Target::Category(from.clone()))?;
    if index.n_views_of(to) > 0 {
        return Err(StoreRefusal::NameTaken {
            from: from.clone(),
            to: to.clone(),
        });
    }
    let operation = Operation::Rename {
        from: from.clone(),
        to: to.clone(),
    };
    let effects = change_all(views, &LabelStatus::Named(to.clone()));
    Ok(Decision::new(operation, effects))
}

fn merge(
    index: &StoreIndex,
    from: &CategoryName,
    into: &CategoryName,
) -> Result<Decision, StoreRefusal> {
    let views = of_target(index, &Target::Category(from.clone()))?;
    let into = index.stored_name(into);
    of_target(index, &Target::Category(into.clone()))?;
    let operation = Operation::MergeCategories {
        from: from.clone(),
        into: into.clone(),
    };
    let effects = change_all(views, &LabelStatus::Named(into.clone()));
    Ok(Decision::new(operation, effects))
}

type Views<'a> = Vec<(ViewId, &'a IndexedView)>;

/// Views of a target; at least one.
fn of_target<'a>(index: &'a StoreIndex, target: &Target) -> Result<Views<'a>, StoreRefusal> {
    let (views, none): (Views<'_>, StoreRefusal) = match target {
        Target::Category(name) => (
            index.category(name).collect(),
            TeachingRefusal::UnknownCategory {
                category: name.clone(),
            }
            .into(),
        ),
        Target::Track(track_id) => (
            index.track(*track_id).collect(),
            TeachingRefusal::NoViews {
                track_id: *track_id,
            }
            .into(),
        ),
        Target::View(view) => {
            let entry = index.get(*view);
            let entry = entry.filter(|entry| entry.register.standing != LabelStatus::Forgotten);
            (
                entry.map(|entry| (*view, entry)).into_iter().collect(),
                StoreRefusal::UnknownView { view: *view },
            )
        }
    };
    if views.is_empty() {
        return Err(none);
    }
    Ok(views)
}

fn put_document(index: &StoreIndex, document: &MemoryDocument) -> Decision {
    let before = index.document(&document.key);
    let before = before.and_then(|(_, version)| version.content.clone());
    let after = document.summary();
    let operation = Operation::PutDocument {
        document: document.key.clone(),
    };
    if before.as_ref() == Some(&after) {
        return Decision::new(operation, Vec::new());
    }
    let digest = after.digest;
    let effect = Effect::Document {
        document: document.key.clone(),
        before,
        after: Some(after),
        decided: None,
    };
    let surplus = purge::surplus_versions(index, &document.key);
    let effects = std::iter::once(effect).chain(surplus).collect();
    let mut decision = Decision::new(operation, effects);
    let content = document.content.clone();
    decision.contents.documents.insert(digest, content);
    decision
}

fn remove_document(index: &StoreIndex, key: &DocumentKey) -> Result<Decision, StoreRefusal> {
    let present = index.document(key);
    let Some(before) = present.and_then(|(_, version)| version.content.clone()) else {
        return Err(StoreRefusal::UnknownDocument {
            document: key.clone(),
        });
    };
    let effect = Effect::Document {
        document: key.clone(),
        before: Some(before),
        after: None,
        decided: None,
    };
    let operation = Operation::RemoveDocument {
        document: key.clone(),
    };
    Ok(Decision::new(operation, vec![effect]))
}
