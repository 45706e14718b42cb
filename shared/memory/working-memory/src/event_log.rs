//! Event log of the world model, in sequence order.

use std::collections::BTreeMap;
use std::ops::Bound;

use crate::dirty_set::DirtySet;
use crate::event::{Event, EventKind};
use crate::expiry_queue::ExpiryQueue;
use crate::record_key::RecordKey;

#[derive(Debug, Default)]
pub(crate) struct EventLog {
    events: BTreeMap<u64, Event>,
    over: ExpiryQueue,
    /// Sequence number of the last event; zero before the first.
    pub(crate) newest: u64,
}

impl EventLog {
    pub(crate) fn add(&mut self, kind: EventKind, now_ns: u64, dirty: &mut DirtySet) {
        let event = Event {
            sequence: self.newest + 1,
            wall_ns: now_ns,
            kind,
        };
        dirty.add(RecordKey::Event(event.sequence));
        dirty.add(RecordKey::Meta);
        self.insert(event);
    }

    pub(crate) fn insert(&mut self, event: Event) {
        self.newest = self.newest.max(event.sequence);
        self.over.insert(event.wall_ns, event.sequence);
        self.events.insert(event.sequence, event);
    }

    pub(crate) fn get(&self, sequence: u64) -> Option<&Event> {
        self.events.get(&sequence)
    }

    /// Events after a sequence number, in order.
    pub(crate) fn since(&self, sequence: u64) -> impl DoubleEndedIterator<Item = &Event> {
        let after = (Bound::Excluded(sequence), Bound::Unbounded);
        self.events.range(after).map(|(_, event)| event)
    }

    pub(crate) fn all(&self) -> impl DoubleEndedIterator<Item = &Event> {
        self.events.values()
    }

    /// Removes one expired event; `false` if there is none.
    pub(crate) fn expire(
        &mut self,
        now_ns: u64,
        keep_ns: u64,
        n_most: usize,
        dirty: &mut DirtySet,
    ) -> bool {
        let Some(sequence) = self.over.take(now_ns, keep_ns, n_most) else {
            return false;
        };
        self.events.remove(&sequence);
        dirty.add(RecordKey::Event(sequence));
        true
    }
}
