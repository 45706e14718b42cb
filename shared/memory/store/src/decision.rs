//! What a change asked for does to the store as it is: the effects, or why not.
//!
//! Nothing is changed here; see [`crate::perceptual_memory`].

use std::collections::HashMap;

use learning::{CategoryName, Refusal as Lesson, ViewChange, ViewId};

use crate::catalogue::{Catalogue, Entry};
use crate::digest::Digest;
use crate::document::{Document, DocumentKey};
use crate::error::Refusal;
use crate::facts::ViewParts;
use crate::history::{Contradiction, Effect, Operation};
use crate::importing;
use crate::meta::Meta;
use crate::mutation::{Change, Target};
use crate::purge;
use crate::standing::Standing;
use crate::view::{Origin, View};

/// What is to be written into the history, and the content that comes with it.
pub(crate) struct Decision {
    pub(crate) operation: Operation,
    pub(crate) effects: Vec<Effect>,
    pub(crate) contradiction: Option<Contradiction>,
    pub(crate) contents: Contents,
    /// First track-id still free after those given to foreign tracks; zero when none was.
    pub(crate) next_track_id: u64,
}

/// New content, by its digest.
#[derive(Default)]
pub(crate) struct Contents {
    /// Views by identity.
    pub(crate) views: HashMap<Digest, ViewParts>,
    pub(crate) documents: HashMap<Digest, Vec<u8>>,
}

impl Decision {
    pub(crate) fn new(operation: Operation, effects: Vec<Effect>) -> Self {
        Self {
            operation,
            effects,
            contradiction: None,
            contents: Contents::default(),
            next_track_id: 0,
        }
    }
}

/// Decides everything but undoing, which needs to read the history.
pub(crate) fn decide(
    catalogue: &Catalogue,
    meta: &Meta,
    change: &Change,
) -> Result<Decision, Refusal> {
    match change {
        Change::StoreViews(views) => store_views(catalogue, meta, views),
        Change::Teach { track_id, category } => teach(catalogue, *track_id, category),
        Change::Correct { target, category } => correct(catalogue, target, category),
        Change::Forget(target) => forget(catalogue, target),
        Change::Rename { from, to } => rename(catalogue, from, to),
        Change::MergeCategories { from, into } => merge(catalogue, from, into),
        Change::Import {
            source,
            views,
            documents,
        } => importing::decide(catalogue, meta, source, views, documents),
        Change::PutDocument(document) => Ok(put_document(catalogue, document)),
        Change::RemoveDocument(key) => remove_document(catalogue, key),
        Change::Purge { before_ns } => Ok(purge::decide(catalogue, *before_ns)),
        Change::Undo { .. } => Err(Refusal::NothingToUndo),
    }
}

/// Stores those of the views that are new, or refuses all.
fn store_views(catalogue: &Catalogue, meta: &Meta, views: &[View]) -> Result<Decision, Refusal> {
    let mut decision = Decision::new(Operation::StoreViews, Vec::new());
    let mut new: HashMap<ViewId, Digest> = HashMap::new();
    for view in views {
        let origin = Origin {
            memory_id: meta.memory_id(),
            view: view.id,
        };
        // A view that came from elsewhere, and came back under its id here.
        let known = catalogue.get(view.id);
        let parts = ViewParts::of(view, known.map_or(origin, |entry| entry.origin));
        let identity = parts.facts.identity();
        let known = known.map(|entry| entry.identity);
        match known.or(new.get(&view.id).copied()) {
            // An id that may be leased later must not belong to another track by then.
            None if view.id.track_id >= meta.next_track_id => {
                return Err(Refusal::TrackNotLeased { view: view.id });
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
            Some(_) => return Err(Refusal::ViewDiffers { view: view.id }),
        }
    }
    Ok(decision)
}

fn teach(
    catalogue: &Catalogue,
    track_id: u64,
    category: &CategoryName,
) -> Result<Decision, Refusal> {
    let operation = Operation::Teach {
        track_id,
        category: category.clone(),
    };
    match learning::teach(catalogue.records_of_track(track_id), track_id, category) {
        Ok(changes) => Ok(Decision::new(operation, effects(changes))),
        Err(Lesson::LabelledOtherwise { present, .. }) => {
            let mut decision = Decision::new(operation, Vec::new());
            decision.contradiction = contradiction(catalogue, track_id, &present);
            Ok(decision)
        }
        Err(lesson) => Err(lesson.into()),
    }
}

/// Who gave the track the name it has.
fn contradiction(
    catalogue: &Catalogue,
    track_id: u64,
    present: &CategoryName,
) -> Option<Contradiction> {
    let registers = catalogue.track(track_id).map(|(_, entry)| &entry.register);
    let said = registers
        .filter(|register| register.standing.category() == Some(present))
        .max_by_key(|register| register.decided.stamp_ns)?;
    Some(Contradiction {
        present: present.clone(),
        decided: said.decided.clone(),
    })
}

fn effects(changes: Vec<ViewChange>) -> Vec<Effect> {
    let effect = |change: ViewChange| Effect::Changed {
        view: change.id,
        before: Standing::of(change.before),
        after: Standing::of(change.after),
        decided: None,
    };
    changes.into_iter().map(effect).collect()
}

fn correct(
    catalogue: &Catalogue,
    target: &Target,
    category: &CategoryName,
) -> Result<Decision, Refusal> {
    let after = Standing::Named(category.clone());
    let operation = Operation::Correct {
        target: target.clone(),
        category: category.clone(),
    };
    Ok(Decision::new(
        operation,
        change_all(of_target(catalogue, target)?, &after),
    ))
}

fn forget(catalogue: &Catalogue, target: &Target) -> Result<Decision, Refusal> {
    let after = match target {
        // The name goes, the views stay and can be taught again.
        Target::Category(_) => Standing::Unnamed,
        Target::Track(_) | Target::View(_) => Standing::Forgotten,
    };
    let operation = Operation::Forget {
        target: target.clone(),
    };
    Ok(Decision::new(
        operation,
        change_all(of_target(catalogue, target)?, &after),
    ))
}

fn rename(
    catalogue: &Catalogue,
    from: &CategoryName,
    to: &CategoryName,
) -> Result<Decision, Refusal> {
    let views = of_target(catalogue, &Target::Category(from.clone()))?;
    if catalogue.n_views_of(to) > 0 {
        return Err(Refusal::NameTaken {
            from: from.clone(),
            to: to.clone(),
        });
    }
    let operation = Operation::Rename {
        from: from.clone(),
        to: to.clone(),
    };
    let effects = change_all(views, &Standing::Named(to.clone()));
    Ok(Decision::new(operation, effects))
}

fn merge(
    catalogue: &Catalogue,
    from: &CategoryName,
    into: &CategoryName,
) -> Result<Decision, Refusal> {
    let views = of_target(catalogue, &Target::Category(from.clone()))?;
    of_target(catalogue, &Target::Category(into.clone()))?;
    let operation = Operation::MergeCategories {
        from: from.clone(),
        into: into.clone(),
    };
    let effects = change_all(views, &Standing::Named(into.clone()));
    Ok(Decision::new(operation, effects))
}

type Views<'a> = Vec<(ViewId, &'a Entry)>;

/// The views that are meant, at least one.
fn of_target<'a>(catalogue: &'a Catalogue, target: &Target) -> Result<Views<'a>, Refusal> {
    let (views, none): (Views<'_>, Refusal) = match target {
        Target::Category(name) => (
            catalogue.category(name).collect(),
            Lesson::UnknownCategory {
                category: name.clone(),
            }
            .into(),
        ),
        Target::Track(track_id) => (
            catalogue.track(*track_id).collect(),
            Lesson::NoViews {
                track_id: *track_id,
            }
            .into(),
        ),
        Target::View(view) => {
            let entry = catalogue.get(*view);
            let entry = entry.filter(|entry| entry.register.standing != Standing::Forgotten);
            (
                entry.map(|entry| (*view, entry)).into_iter().collect(),
                Refusal::UnknownView { view: *view },
            )
        }
    };
    if views.is_empty() {
        return Err(none);
    }
    Ok(views)
}

/// The effects of having all these views stand for `after`.
pub(crate) fn change_all<'a>(
    views: impl IntoIterator<Item = (ViewId, &'a Entry)>,
    after: &Standing,
) -> Vec<Effect> {
    let others = views
        .into_iter()
        .filter(|(_, entry)| entry.register.standing != *after);
    others
        .map(|(view, entry)| Effect::Changed {
            view,
            before: entry.register.standing.clone(),
            after: after.clone(),
            decided: None,
        })
        .collect()
}

fn put_document(catalogue: &Catalogue, document: &Document) -> Decision {
    let before = catalogue.document(&document.key);
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
    let mut decision = Decision::new(operation, vec![effect]);
    let content = document.content.clone();
    decision.contents.documents.insert(digest, content);
    decision
}

fn remove_document(catalogue: &Catalogue, key: &DocumentKey) -> Result<Decision, Refusal> {
    let present = catalogue.document(key);
    let Some(before) = present.and_then(|(_, version)| version.content.clone()) else {
        return Err(Refusal::UnknownDocument {
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
