//! The events of a tree.

use std::fmt;
use std::num::NonZeroUsize;
use std::sync::Arc;

use crate::event::{Event, Events};
use crate::mailbox::{KeepLatest, Sender, mailbox};

/// A child's place in the tree, as `vision/objects`.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ChildPath(Arc<str>);

impl ChildPath {
    /// The path as text.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for ChildPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// Without quotes, for it stands in sentences.
impl fmt::Debug for ChildPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// Where a tree, and the trees in it, report to.
#[derive(Debug, Clone)]
pub struct Reports {
    events: Sender<Event<ChildPath>, KeepLatest>,
    /// Ends with a slash, unless it is the root's.
    prefix: Arc<str>,
}

/// A stream of events that keeps so many for a slow reader, and its end for
/// [`Tree::run`](super::Tree::run).
pub fn reports(capacity: NonZeroUsize) -> (Reports, Events<ChildPath>) {
    let (events, reader) = mailbox(capacity);
    let prefix = Arc::from("");
    (Reports { events, prefix }, reader)
}

impl Reports {
    pub(super) fn path(&self, id: &str) -> ChildPath {
        ChildPath(format!("{}{id}", self.prefix).into())
    }

    /// The same stream for the tree that is the child `id`.
    pub(super) fn below(&self, id: &str) -> Self {
        Self {
            events: self.events.clone(),
            prefix: format!("{}{id}/", self.prefix).into(),
        }
    }

    pub(super) fn report(&self, event: Event<ChildPath>) {
        // Nobody needs to listen.
        let _ = self.events.send(event);
    }
}
