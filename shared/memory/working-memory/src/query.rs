//! Temporal queries on facts by subject, label, region and time window.

use std::collections::HashMap;

use crate::fact::{Fact, Property, Subject, Value};
use crate::fact_table::FactTable;

/// Region in the world frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Region {
    /// Ball-shaped region around a point, metres.
    Ball {
        /// Centre of the ball, metres.
        centre_m: [f64; 3],
        /// Radius of the ball, metres.
        radius_m: f64,
    },
    /// Axis-aligned box, metres.
    Box {
        /// Minimum corner of the box, metres.
        min_m: [f64; 3],
        /// Maximum corner of the box, metres.
        max_m: [f64; 3],
    },
}

/// Closed time interval, nanoseconds since 1970.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Window {
    /// First instant of the time window, nanoseconds since 1970.
    pub from_ns: u64,
    /// Last instant; equal to the first for a single instant.
    pub to_ns: u64,
}

/// Query for facts that held at an instant at which all given conditions held.
#[derive(Debug, Clone, PartialEq)]
pub struct FactQuery {
    /// Subject that the facts must describe.
    pub subject: Option<Subject>,
    /// Label of the subject at that instant.
    pub label: Option<String>,
    /// Region that contains the centre of the subject at that instant, according to its facts.
    pub region: Option<Region>,
    /// Time window that contains the instant.
    pub window: Option<Window>,
    /// Upper bound of the fact number (exclusive): the `next` of the previous page.
    pub before: Option<u64>,
    /// Maximum number of facts on a page.
    pub n_most: usize,
}

/// Page of facts, newest first.
#[derive(Debug, Clone, PartialEq)]
pub struct FactPage {
    /// Facts on the page.
    pub facts: Vec<Fact>,
    /// Cursor of the next page; `None` after the last page.
    pub next: Option<u64>,
}

impl Region {
    /// `true` if the region contains the point.
    pub fn contains(&self, point_m: &[f64; 3]) -> bool {
        match self {
            Self::Ball { centre_m, radius_m } => {
                let squares = point_m.iter().zip(centre_m).map(|(a, b)| (a - b) * (a - b));
                squares.sum::<f64>() <= radius_m * radius_m
            }
            Self::Box { min_m, max_m } => {
                (0..3).all(|i| (min_m[i]..=max_m[i]).contains(&point_m[i]))
            }
        }
    }
}

/// Time interval, half-open and not empty, nanoseconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct TimeInterval {
    start: u64,
    end: u64,
}

impl TimeInterval {
    /// Validity interval of a fact. A fact that ended at its start counts for that instant.
    fn of(fact: &Fact) -> Self {
        let end = fact.end_ns.unwrap_or(u64::MAX);
        Self {
            start: fact.start_ns,
            end: end.max(fact.start_ns.saturating_add(1)),
        }
    }

    fn of_window(window: Option<Window>) -> Self {
        window.map_or(
            Self {
                start: 0,
                end: u64::MAX,
            },
            |window| Self {
                start: window.from_ns,
                end: window.to_ns.saturating_add(1),
            },
        )
    }
}

/// Page of facts that match a query.
pub(crate) fn facts(table: &FactTable, query: &FactQuery) -> FactPage {
    let before = query.before.unwrap_or(u64::MAX);
    let candidates: Box<dyn Iterator<Item = &Fact>> = match query.subject {
        Some(subject) => Box::new(table.of(subject, before)),
        None => Box::new(table.before(before)),
    };
    let mut wanted_of = HashMap::<Subject, Vec<TimeInterval>>::new();
    let mut found = candidates.filter(|fact| {
        let wanted = wanted_of
            .entry(fact.subject)
            .or_insert_with(|| wanted_intervals(table, query, fact.subject));
        meets(wanted, TimeInterval::of(fact))
    });
    let facts: Vec<Fact> = found.by_ref().take(query.n_most).cloned().collect();
    let has_more = found.next().is_some();
    let next = facts.last().map(|fact| fact.number).filter(|_| has_more);
    FactPage { facts, next }
}

/// Intervals in which all conditions hold for a subject, sorted and disjoint.
fn wanted_intervals(table: &FactTable, query: &FactQuery, subject: Subject) -> Vec<TimeInterval> {
    let mut wanted = vec![TimeInterval::of_window(query.window)];
    let when = |is_so: &dyn Fn(&Value) -> bool| {
        let facts = table.of(subject, u64::MAX);
        merged(
            facts
                .filter(|fact| is_so(&fact.value))
                .map(TimeInterval::of),
        )
    };
    if let Some(label) = &query.label {
        let is_called = |value: &Value| value.label() == Some(label);
        wanted = common(&wanted, &when(&is_called));
    }
    if let Some(region) = &query.region {
        let is_there = |value: &Value| matches!(value, Value::Place(place) if region.contains(&place.position_m));
        wanted = common(&wanted, &when(&is_there));
    }
    wanted
}

/// Union of time intervals, sorted and disjoint.
fn merged(intervals: impl Iterator<Item = TimeInterval>) -> Vec<TimeInterval> {
    let mut intervals: Vec<TimeInterval> = intervals.collect();
    intervals.sort_unstable();
    intervals.dedup_by(|next, last| {
        let touches = next.start <= last.end;
        if touches {
            last.end = last.end.max(next.end);
        }
        touches
    });
    intervals
}

/// Intersection of two sorted lists of intervals.
fn common(a: &[TimeInterval], b: &[TimeInterval]) -> Vec<TimeInterval> {
    let (mut i, mut j) = (0, 0);
    let mut common = Vec::new();
    while let (Some(one), Some(other)) = (a.get(i), b.get(j)) {
        let start = one.start.max(other.start);
        let end = one.end.min(other.end);
        if start < end {
            common.push(TimeInterval { start, end });
        }
        if one.end < other.end {
            i += 1;
        } else {
            j += 1;
        }
    }
    common
}

/// `true` if the sorted intervals intersect `interval`.
fn meets(intervals: &[TimeInterval], interval: TimeInterval) -> bool {
    let first = intervals.partition_point(|wanted| wanted.end <= interval.start);
    intervals
        .get(first)
        .is_some_and(|wanted| wanted.start < interval.end)
}

/// Start of the current fact about a property.
pub(crate) fn since_ns(table: &FactTable, subject: Subject, property: Property) -> Option<u64> {
    table.holding(subject, property).map(|fact| fact.start_ns)
}
