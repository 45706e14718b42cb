//! The rules of teaching: which views change their category.
//!
//! A person teaches an object, not a picture: all key views of the track get the
//! name. The rules only say what must change; who keeps the views writes the
//! changes in one piece.

use crate::{CategoryName, ViewId};
use std::fmt;

/// A key view and its category, as it is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ViewRecord<'a> {
    /// The view.
    pub id: ViewId,
    /// Its category; `None` when it was never taught or forgotten.
    pub category: Option<&'a CategoryName>,
}

/// One view's change of category; `before` and `after` differ.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ViewChange {
    /// The view.
    pub id: ViewId,
    /// The category it leaves.
    pub before: Option<CategoryName>,
    /// The category it belongs to from now on.
    pub after: Option<CategoryName>,
}

/// Why a lesson changes nothing.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Refusal {
    /// The track has no key views.
    NoViews {
        /// The track.
        track_id: u64,
    },
    /// The track was taught as something else.
    LabelledOtherwise {
        /// The track.
        track_id: u64,
        /// What it was taught as.
        present: CategoryName,
        /// What it should be taught as now.
        asked: CategoryName,
    },
    /// No view belongs to the category.
    UnknownCategory {
        /// The category.
        category: CategoryName,
    },
}

/// Teaches a track: all its views without a category get this one. Teaching the
/// same again changes nothing, or adds the views that have come since.
///
/// `records` may contain other tracks; the changes are in its order.
///
/// # Errors
/// When the track has no views, or one of them belongs to another category: then
/// two people disagree, and [`correct`] decides.
pub fn teach<'a>(
    records: impl IntoIterator<Item = ViewRecord<'a>> + Clone,
    track_id: u64,
    category: &CategoryName,
) -> Result<Vec<ViewChange>, Refusal> {
    let others = records
        .clone()
        .into_iter()
        .filter(|record| record.id.track_id == track_id);
    if let Some(present) = others
        .filter_map(|r| r.category)
        .find(|&present| present != category)
    {
        return Err(Refusal::LabelledOtherwise {
            track_id,
            present: present.clone(),
            asked: category.clone(),
        });
    }
    correct(records, track_id, category)
}

/// Corrects a track: all its views leave whatever category they are in and
/// belong to this one. On a track without a category it is the same as [`teach`].
///
/// `records` may contain other tracks; the changes are in its order.
///
/// # Errors
/// When the track has no views.
pub fn correct<'a>(
    records: impl IntoIterator<Item = ViewRecord<'a>>,
    track_id: u64,
    category: &CategoryName,
) -> Result<Vec<ViewChange>, Refusal> {
    let mut of_track = records
        .into_iter()
        .filter(|record| record.id.track_id == track_id)
        .peekable();
    if of_track.peek().is_none() {
        return Err(Refusal::NoViews { track_id });
    }
    Ok(of_track
        .filter(|record| record.category != Some(category))
        .map(|record| record.changed_to(Some(category)))
        .collect())
}

/// Forgets a category: its views belong to none. They stay stored, so the tracks
/// can be taught again.
///
/// # Errors
/// When no view belongs to the category.
pub fn forget<'a>(
    records: impl IntoIterator<Item = ViewRecord<'a>>,
    category: &CategoryName,
) -> Result<Vec<ViewChange>, Refusal> {
    let of_category = records
        .into_iter()
        .filter(|record| record.category == Some(category));
    let changes: Vec<_> = of_category.map(|record| record.changed_to(None)).collect();
    if changes.is_empty() {
        return Err(Refusal::UnknownCategory {
            category: category.clone(),
        });
    }
    Ok(changes)
}

impl ViewRecord<'_> {
    fn changed_to(self, after: Option<&CategoryName>) -> ViewChange {
        ViewChange {
            id: self.id,
            before: self.category.cloned(),
            after: after.cloned(),
        }
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoViews { track_id } => write!(
                f,
                "track {track_id} has no key views to learn from: let the object rest in view of \
                 the camera and teach it again"
            ),
            Self::LabelledOtherwise {
                track_id,
                present,
                asked,
            } => write!(
                f,
                "track {track_id} was taught as {present}, not as {asked}: correct it if {asked} is \
                 right"
            ),
            Self::UnknownCategory { category } => write!(
                f,
                "no view belongs to the category {category}: list the categories to see which there \
                 are"
            ),
        }
    }
}

impl std::error::Error for Refusal {}

#[cfg(test)]
mod tests;
