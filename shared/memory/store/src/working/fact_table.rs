//! The facts that hold, and those that held.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Bound;

use super::expiry::Expiry;
use super::fact::{Claim, Fact, Property, Subject};
use super::keys::Entry;
use super::touched::Touched;
use super::world_config::WorldConfig;

#[derive(Debug, Default)]
pub(super) struct FactTable {
    facts: BTreeMap<u64, Fact>,
    open: BTreeMap<(Subject, Property), u64>,
    of_subject: BTreeSet<(Subject, u64)>,
    over: Expiry,
    /// Number of the newest fact; zero before the first.
    pub(super) newest: u64,
}

impl FactTable {
    /// What holds of a subject's property.
    pub(super) fn holding(&self, subject: Subject, property: Property) -> Option<&Fact> {
        let number = self.open.get(&(subject, property))?;
        self.facts.get(number)
    }

    /// Has something hold from now on: nothing changes when it holds already,
    /// else the old fact ends and a new one begins.
    pub(super) fn claim(
        &mut self,
        subject: Subject,
        claim: Claim<'_>,
        now_ns: u64,
        config: &WorldConfig,
        touched: &mut Touched,
    ) {
        let property = claim.property();
        let known = self.holding(subject, property);
        if known.is_some_and(|known| claim.agrees(&known.value, config)) {
            return;
        }
        self.cease(subject, property, now_ns, touched);
        let fact = Fact {
            number: self.newest + 1,
            subject,
            value: claim.to_value(),
            start_ns: now_ns,
            end_ns: None,
        };
        touched.add(Entry::Fact(fact.number));
        touched.add(Entry::Meta);
        self.insert(fact);
    }

    /// Ends what holds of a subject's property, never before it began.
    pub(super) fn cease(
        &mut self,
        subject: Subject,
        property: Property,
        end_ns: u64,
        touched: &mut Touched,
    ) {
        let number = self.open.remove(&(subject, property));
        if let Some(fact) = number.and_then(|number| self.facts.get_mut(&number)) {
            let end_ns = end_ns.max(fact.start_ns);
            fact.end_ns = Some(end_ns);
            self.over.insert(end_ns, fact.number);
            touched.add(Entry::Fact(fact.number));
        }
    }

    /// Takes in a fact that is newer than all.
    pub(super) fn insert(&mut self, fact: Fact) {
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

    /// Of what something holds now.
    pub(super) fn open(&self) -> impl Iterator<Item = (Subject, Property)> {
        self.open.keys().copied()
    }

    pub(super) fn get(&self, number: u64) -> Option<&Fact> {
        self.facts.get(&number)
    }

    pub(super) fn len(&self) -> usize {
        self.facts.len()
    }

    pub(super) fn all(&self) -> impl Iterator<Item = &Fact> {
        self.facts.values()
    }

    /// The facts before a number, newest first.
    pub(super) fn before(&self, number: u64) -> impl Iterator<Item = &Fact> {
        self.facts.range(..number).rev().map(|(_, fact)| fact)
    }

    /// The facts about a subject before a number, newest first.
    pub(super) fn of(&self, subject: Subject, before: u64) -> impl Iterator<Item = &Fact> {
        let range = (
            Bound::Included((subject, 0)),
            Bound::Excluded((subject, before)),
        );
        let numbers = self.of_subject.range(range).rev();
        numbers.filter_map(|(_, number)| self.facts.get(number))
    }

    /// Forgets one fact that is to be forgotten; false when there is none.
    pub(super) fn expire(
        &mut self,
        now_ns: u64,
        config: &WorldConfig,
        touched: &mut Touched,
    ) -> bool {
        let due = self.over.take(now_ns, config.keep_ns, config.n_kept_most);
        let Some(fact) = due.and_then(|number| self.facts.remove(&number)) else {
            return false;
        };
        self.of_subject.remove(&(fact.subject, fact.number));
        touched.add(Entry::Fact(fact.number));
        true
    }
}
