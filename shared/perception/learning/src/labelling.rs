//! Teaching rules: label changes of views for teach, correct and forget.
//!
//! A person teaches an object, not an image: all key views of a track receive the label.
//! The functions compute the changes only; the memory applies them atomically.

use crate::{CategoryName, ViewId};

/// Stored key view with its label.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ViewLabel<'a> {
    /// Id of the stored view.
    pub id: ViewId,
    /// Label; `None` when the view was never taught, or forgotten.
    pub category: Option<&'a CategoryName>,
}

/// Label change of one view; `before` and `after` differ.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LabelChange {
    /// Id of the relabelled view.
    pub id: ViewId,
    /// Label of the view before the change.
    pub before: Option<CategoryName>,
    /// Label of the view after the change.
    pub after: Option<CategoryName>,
}

/// Rejected teaching request.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TeachingError {
    /// Track that has no key views to label.
    #[error(
        "track {track_id} has no key views to learn from: let the object rest in view of the \
         camera and teach it again"
    )]
    NoViews {
        /// Track-id of that track.
        track_id: u64,
    },
    /// Track that already has another label.
    #[error(
        "track {track_id} was taught as {present}, not as {asked}: correct it if {asked} is right"
    )]
    LabelConflict {
        /// Track-id of the labelled track.
        track_id: u64,
        /// Present label of the track.
        present: CategoryName,
        /// Label requested for the track.
        asked: CategoryName,
    },
    /// Category to which no view belongs.
    #[error(
        "no view belongs to the category {category}: list the categories to see which there are"
    )]
    UnknownCategory {
        /// Name of the empty category.
        category: CategoryName,
    },
}

/// Label changes that teach a track: its unlabelled views receive the category. Teaching
/// the same category again labels only newer views.
///
/// `records` may contain other tracks; the changes follow its order.
///
/// # Errors
/// When the track has no views, or a view with another label: two people disagree, and
/// [`correct`] decides.
pub fn teach<'a>(
    records: impl IntoIterator<Item = ViewLabel<'a>> + Clone,
    track_id: u64,
    category: &CategoryName,
) -> Result<Vec<LabelChange>, TeachingError> {
    let others = records
        .clone()
        .into_iter()
        .filter(|record| record.id.track_id == track_id);
    if let Some(present) = others
        .filter_map(|r| r.category)
        .find(|&present| present != category)
    {
        return Err(TeachingError::LabelConflict {
            track_id,
            present: present.clone(),
            asked: category.clone(),
        });
    }
    correct(records, track_id, category)
}

/// Label changes that correct a track: all its views receive the category, whatever
/// their present one. Equals [`teach`] for an unlabelled track.
///
/// `records` may contain other tracks; the changes follow its order.
///
/// # Errors
/// When the track has no views.
pub fn correct<'a>(
    records: impl IntoIterator<Item = ViewLabel<'a>>,
    track_id: u64,
    category: &CategoryName,
) -> Result<Vec<LabelChange>, TeachingError> {
    let mut of_track = records
        .into_iter()
        .filter(|record| record.id.track_id == track_id)
        .peekable();
    if of_track.peek().is_none() {
        return Err(TeachingError::NoViews { track_id });
    }
    Ok(of_track
        .filter(|record| record.category != Some(category))
        .map(|record| record.changed_to(Some(category)))
        .collect())
}

/// Label changes that forget a category: its views become unlabelled but stay stored, so
/// that their tracks can be taught again.
///
/// # Errors
/// When no view belongs to the category.
pub fn forget<'a>(
    records: impl IntoIterator<Item = ViewLabel<'a>>,
    category: &CategoryName,
) -> Result<Vec<LabelChange>, TeachingError> {
    let of_category = records
        .into_iter()
        .filter(|record| record.category == Some(category));
    let changes: Vec<_> = of_category.map(|record| record.changed_to(None)).collect();
    if changes.is_empty() {
        return Err(TeachingError::UnknownCategory {
            category: category.clone(),
        });
    }
    Ok(changes)
}

impl ViewLabel<'_> {
    fn changed_to(self, after: Option<&CategoryName>) -> LabelChange {
        LabelChange {
            id: self.id,
            before: self.category.cloned(),
            after: after.cloned(),
        }
    }
}

#[cfg(test)]
mod tests;
