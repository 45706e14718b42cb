//! The rules of teaching: which names a change alters. Pure.

use learning::CategoryName;

use crate::catalogue::Catalogue;
use crate::error::Refusal;
use crate::history::ViewChange;

/// Gives the track's views a name. Views stored since it was taught get it too.
///
/// # Errors
///
/// The track has no views, or has another name already.
pub(crate) fn teach(
    catalogue: &Catalogue,
    track_id: u64,
    category: &CategoryName,
) -> Result<Vec<ViewChange>, Refusal> {
    let other = catalogue
        .track(track_id)
        .filter_map(|(_, entry)| entry.label.as_ref())
        .find(|(present, _)| present != category);
    if let Some((present, _)) = other {
        return Err(Refusal::LabelledOtherwise {
            track_id,
            present: present.clone(),
            asked: category.clone(),
        });
    }
    correct(catalogue, track_id, category)
}

/// Gives the track's views a name, whatever they were called.
///
/// # Errors
///
/// The track has no views.
pub(crate) fn correct(
    catalogue: &Catalogue,
    track_id: u64,
    category: &CategoryName,
) -> Result<Vec<ViewChange>, Refusal> {
    let mut views = catalogue.track(track_id).peekable();
    if views.peek().is_none() {
        return Err(Refusal::NoViews { track_id });
    }
    let changes = views.filter_map(|(view, entry)| {
        let before = entry.label.as_ref().map(|(name, _)| name.clone());
        let is_new = before.as_ref() != Some(category);
        is_new.then(|| ViewChange { view, before, after: Some(category.clone()) })
    });
    Ok(changes.collect())
}

/// Takes a name from all views that carry it.
///
/// # Errors
///
/// No view carries it.
pub(crate) fn forget(
    catalogue: &Catalogue,
    category: &CategoryName,
) -> Result<Vec<ViewChange>, Refusal> {
    let change = |view| ViewChange { view, before: Some(category.clone()), after: None };
    let changes: Vec<_> = catalogue.category(category).map(change).collect();
    if changes.is_empty() {
        return Err(Refusal::UnknownCategory { category: category.clone() });
    }
    Ok(changes)
}
