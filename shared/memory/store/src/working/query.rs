//! Questions about facts: of whom, of what it was called, where, and when.

use std::collections::HashMap;

use super::fact::{Fact, Property, Subject, Value};
use super::fact_table::FactTable;

/// A part of the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Region {
    /// All that is within a radius of a point, metres.
    Ball {
        /// The point.
        centre_m: [f64; 3],
        /// The radius.
        radius_m: f64,
    },
    /// All between two corners, along the world's axes, metres.
    Box {
        /// The least coordinates.
        min_m: [f64; 3],
        /// The greatest coordinates.
        max_m: [f64; 3],
    },
}

/// From one instant to another, both included, nanoseconds since 1970.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Window {
    /// The first instant.
    pub from_ns: u64,
    /// The last instant; the same for a single one.
    pub to_ns: u64,
}

/// Which facts are wanted: those that held at some instant at which all holds
/// that is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct FactQuery {
    /// Only facts about this one.
    pub subject: Option<Subject>,
    /// The instant is one at which their subject was called so.
    pub label: Option<String>,
    /// The instant is one at which the centre of their subject lay there, as far
    /// as its facts tell.
    pub region: Option<Region>,
    /// The instant lies in here.
    pub window: Option<Window>,
    /// Only facts with a lower number: the `next` of the page before.
    pub before: Option<u64>,
    /// Most facts of a page.
    pub n_most: usize,
}

/// Facts, newest first.
#[derive(Debug, Clone, PartialEq)]
pub struct FactPage {
    /// The facts.
    pub facts: Vec<Fact>,
    /// Where the next page begins; `None` after the last one.
    pub next: Option<u64>,
}

impl Region {
    /// Whether a point lies in it.
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

/// From the first instant to before the second one; never empty.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Span {
    start: u64,
    end: u64,
}

impl Span {
    /// When a fact held. What ended as it began counts for that instant.
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

/// The page of facts that a query asks for.
pub(super) fn facts(table: &FactTable, query: &FactQuery) -> FactPage {
    let before = query.before.unwrap_or(u64::MAX);
    let candidates: Box<dyn Iterator<Item = &Fact>> = match query.subject {
        Some(subject) => Box::new(table.of(subject, before)),
        None => Box::new(table.before(before)),
    };
    let mut wanted_of = HashMap::<Subject, Vec<Span>>::new();
    let mut found = candidates.filter(|fact| {
        let wanted = wanted_of
            .entry(fact.subject)
            .or_insert_with(|| wanted_spans(table, query, fact.subject));
        meets(wanted, Span::of(fact))
    });
    let facts: Vec<Fact> = found.by_ref().take(query.n_most).cloned().collect();
    let has_more = found.next().is_some();
    let next = facts.last().map(|fact| fact.number).filter(|_| has_more);
    FactPage { facts, next }
}

/// When all holds of a subject that is asked for: in order, apart from each other.
fn wanted_spans(table: &FactTable, query: &FactQuery, subject: Subject) -> Vec<Span> {
    let mut wanted = vec![Span::of_window(query.window)];
    let when = |is_so: &dyn Fn(&Value) -> bool| {
        let facts = table.of(subject, u64::MAX);
        merged(facts.filter(|fact| is_so(&fact.value)).map(Span::of))
    };
    if let Some(label) = &query.label {
        let is_called = |value: &Value| matches!(value, Value::Label(known) if known == label);
        wanted = common(&wanted, &when(&is_called));
    }
    if let Some(region) = &query.region {
        let is_there = |value: &Value| matches!(value, Value::Place(place) if region.contains(&place.position_m));
        wanted = common(&wanted, &when(&is_there));
    }
    wanted
}

/// The same instants in spans in order and apart from each other.
fn merged(spans: impl Iterator<Item = Span>) -> Vec<Span> {
    let mut spans: Vec<Span> = spans.collect();
    spans.sort_unstable();
    spans.dedup_by(|next, last| {
        let touches = next.start <= last.end;
        if touches {
            last.end = last.end.max(next.end);
        }
        touches
    });
    spans
}

/// The instants in both.
fn common(a: &[Span], b: &[Span]) -> Vec<Span> {
    let (mut i, mut j) = (0, 0);
    let mut common = Vec::new();
    while let (Some(one), Some(other)) = (a.get(i), b.get(j)) {
        let start = one.start.max(other.start);
        let end = one.end.min(other.end);
        if start < end {
            common.push(Span { start, end });
        }
        if one.end < other.end {
            i += 1;
        } else {
            j += 1;
        }
    }
    common
}

/// Whether some of the spans, in order, has an instant in common with `span`.
fn meets(spans: &[Span], span: Span) -> bool {
    let first = spans.partition_point(|wanted| wanted.end <= span.start);
    spans
        .get(first)
        .is_some_and(|wanted| wanted.start < span.end)
}

/// What holds of an object's property, and since when.
pub(super) fn since_ns(table: &FactTable, subject: Subject, property: Property) -> Option<u64> {
    table.holding(subject, property).map(|fact| fact.start_ns)
}
