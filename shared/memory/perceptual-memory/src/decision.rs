//! Decisions: operation and effects of a change, with the content that it inserts.

use std::collections::HashMap;

use learning::ViewId;

use crate::digest::Digest;
use crate::index_row::IndexedView;
use crate::label_status::LabelStatus;
use crate::model::{Contradiction, Effect, Operation};
use crate::view_record::ViewParts;

/// Operation and effects for the history, with the content they insert.
pub(crate) struct Decision {
    pub(crate) operation: Operation,
    pub(crate) effects: Vec<Effect>,
    pub(crate) contradiction: Option<Contradiction>,
    pub(crate) contents: NewContent,
    /// First track-id still free after those given to foreign tracks; zero when none was.
    pub(crate) next_track_id: u64,
}

/// Content inserted by a decision, by digest.
#[derive(Default)]
pub(crate) struct NewContent {
    /// Inserted views, by content digest.
    pub(crate) views: HashMap<Digest, ViewParts>,
    pub(crate) documents: HashMap<Digest, Vec<u8>>,
}

impl Decision {
    pub(crate) fn new(operation: Operation, effects: Vec<Effect>) -> Self {
        Self {
            operation,
            effects,
            contradiction: None,
            contents: NewContent::default(),
            next_track_id: 0,
        }
    }
}

/// Effects of setting the label status of all these views.
pub(crate) fn change_all<'a>(
    views: impl IntoIterator<Item = (ViewId, &'a IndexedView)>,
    after: &LabelStatus,
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
