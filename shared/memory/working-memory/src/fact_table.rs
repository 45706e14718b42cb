//! Fact table: current and past facts, indexed by subject and property.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Bound;

use crate::dirty_set::DirtySet;
use crate::expiry_queue::ExpiryQueue;
use crate::fact::{Fact, Property, Subject, ValueRef};
use crate::record_key::RecordKey;
use crate::world_config::WorldConfig;

#[derive(Debug, Default)]
pub(crate) struct FactTable {
    facts: BTreeMap<u64, Fact>,
    open: BTreeMap<(Subject, Property), u64>,
    of_subject: BTreeSet<(Subject, u64)>,
    over: ExpiryQueue,
    /// Number of the newest fact; zero before the first.
    pub(crate) newest: u64,
}

impl FactTable {
    /// Current fact about a property of a subject.
    pub(crate) fn holding(&self, subject: Subject, property: Property) -> Option<&Fact> {
        let number = self.open.get(&(subject, property))?;
        self.facts.get(number)
    }

    /// Asserts a value from now on. Nothing changes if it holds already; otherwise the old fact
    /// ends and a new one begins.
    pub(crate) fn assert_fact(
        &mut self,
        subject: Subject,
        value: ValueRef<'_>,
        now_ns: u64,
        config: &WorldConfig,
        dirty: &mut DirtySet,
    ) {
        let property = value.property();
        let known = self.holding(subject, property);
        if known.is_some_and(|known| value.matches_value(&known.value, config)) {
            return;
        }
        self.retract(subject, property, now_ns, dirty);
        let fact = Fact {
            number: self.newest + 1,
            subject,
            value: value.to_value(),
            start_ns: now_ns,
            end_ns: None,
        };
        dirty.add(RecordKey::Fact(fact.number));
        dirty.add(RecordKey::Meta);
        self.insert(fact);
    }

    /// Ends the current fact about a property of a subject, not before its start.
    pub(crate) fn retract(
        &mut self,
        subject: Subject,
        property: Property,
        end_ns: u64,
        dirty: &mut DirtySet,
    ) {
        let number = self.open.remove(&(subject, property));
        if let Some(fact) = number.and_then(|number| self.facts.get_mut(&number)) {
            let end_ns = end_ns.max(fact.start_ns);
            fact.end_ns = Some(end_ns);
            self.over.insert(end_ns, fact.number);
            dirty.add(RecordKey::Fact(fact.number));
        }
    }

    /// Inserts a fact that is newer than all others.
    pub(crate) fn insert(&mut self, fact: Fact) {
        self.newest = self.newest.max(fact.number);
        self.of_subject.insert((fact.subject, fact.number));
        if let Some(end_ns) = fact.end_ns {
            self.over.insert(end_ns, fact.number);
        } else {
            let what = (fact.subject, fact.value.property());
            self.open.insert(what, fact.number);
        }
        self.facts.insert(fact.number, fact);
    }

    /// Subjects and properties with a current fact.
    pub(crate) fn open(&self) -> impl Iterator<Item = (Subject, Property)> {
        self.open.keys().copied()
    }

    pub(crate) fn get(&self, number: u64) -> Option<&Fact> {
        self.facts.get(&number)
    }

    pub(crate) fn len(&self) -> usize {
        self.facts.len()
    }

    pub(crate) fn all(&self) -> impl Iterator<Item = &Fact> {
        self.facts.values()
    }

    /// Facts with a smaller number, newest first.
    pub(crate) fn before(&self, number: u64) -> impl Iterator<Item = &Fact> {
        self.facts.range(..number).rev().map(|(_, fact)| fact)
    }

    /// Facts about a subject with a smaller number, newest first.
    pub(crate) fn of(&self, subject: Subject, before: u64) -> impl Iterator<Item = &Fact> {
        let range = (
            Bound::Included((subject, 0)),
            Bound::Excluded((subject, before)),
        );
        let numbers = self.of_subject.range(range).rev();
        numbers.filter_map(|(_, number)| self.facts.get(number))
    }

    /// Removes one expired fact; `false` if there is none.
    pub(crate) fn expire(
        &mut self,
        now_ns: u64,
        config: &WorldConfig,
        dirty: &mut DirtySet,
    ) -> bool {
        let due = self.over.take(now_ns, config.keep_ns, config.n_kept_most);
        let Some(fact) = due.and_then(|number| self.facts.remove(&number)) else {
            return false;
        };
        self.of_subject.remove(&(fact.subject, fact.number));
        dirty.add(RecordKey::Fact(fact.number));
        true
    }
}
