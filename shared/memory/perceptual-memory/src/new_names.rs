//! New category names: refused beside a category that people take for the same one, and brought
//! into the form that names have today.

use std::collections::{BTreeMap, BTreeSet};

use learning::CategoryName;
use unicode_text::likeness;

use crate::decision::{Decision, change_all};
use crate::error::StoreRefusal;
use crate::label_status::LabelStatus;
use crate::model::{Effect, Operation};
use crate::store_index::StoreIndex;

/// Refuses a decision that makes a category with a name like that of another one. A category that
/// the decision leaves without views is no other one.
pub(crate) fn check(index: &StoreIndex, decision: &Decision) -> Result<(), StoreRefusal> {
    let mut new = BTreeSet::new();
    let mut n_leaving: BTreeMap<&CategoryName, usize> = BTreeMap::new();
    for effect in &decision.effects {
        let Effect::Changed { before, after, .. } = effect else {
            continue;
        };
        new.extend(after.category().filter(|name| index.n_views_of(name) == 0));
        if let Some(left) = before.category() {
            *n_leaving.entry(left).or_default() += 1;
        }
    }
    let stays = |name: &&CategoryName| n_leaving.get(name) != Some(&index.n_views_of(name));
    for name in new {
        let alike = |existing: &&CategoryName| likeness(name.as_str(), existing.as_str()).is_some();
        if let Some(existing) = index.names().filter(stays).find(alike) {
            return Err(StoreRefusal::NameAlike {
                name: name.clone(),
                existing: existing.clone(),
            });
        }
    }
    Ok(())
}

/// Effects that write all stored names as they would be given today. Categories whose names become
/// equal are joined.
pub(crate) fn normalise(index: &StoreIndex) -> Decision {
    let mut names = Vec::new();
    let mut effects = Vec::new();
    for name in index.names() {
        let normalised = name.normalised();
        if normalised != *name {
            let views = index.category(name);
            effects.extend(change_all(views, &LabelStatus::Named(normalised.clone())));
            names.push((name.clone(), normalised));
        }
    }
    Decision::new(Operation::NormaliseNames { names }, effects)
}
