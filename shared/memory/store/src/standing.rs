//! What a view stands for, and who decided that.

use std::fmt;
use std::sync::Arc;

use learning::CategoryName;
use serde::{Deserialize, Serialize};

/// What a stored view stands for.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Standing {
    /// Nobody has named it.
    #[serde(rename = "u")]
    Unnamed,
    /// An example of a category.
    #[serde(rename = "n")]
    Named(CategoryName),
    /// Nothing any more: it is neither recognised nor taught, and is removed for
    /// good after a while.
    #[serde(rename = "f")]
    Forgotten,
}

impl Standing {
    /// The name, if it is one's example.
    pub fn category(&self) -> Option<&CategoryName> {
        match self {
            Self::Named(name) => Some(name),
            Self::Unnamed | Self::Forgotten => None,
        }
    }

    /// The standing of a view with or without a name.
    pub(crate) fn of(category: Option<CategoryName>) -> Self {
        category.map_or(Self::Unnamed, Self::Named)
    }
}

impl fmt::Display for Standing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unnamed => f.write_str("no name"),
            Self::Named(name) => write!(f, "{name}"),
            Self::Forgotten => f.write_str("forgotten"),
        }
    }
}

/// Who decided something, and when: the later of two decisions on one view holds,
/// also when they were made on two robots.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Decided {
    /// Who.
    pub author: Arc<str>,
    /// When, nanoseconds since 1970, UTC; later than any decision it replaced,
    /// whatever the clock said.
    pub stamp_ns: u64,
}

impl Decided {
    /// Now, and after what was decided before: a clock that steps back does not turn
    /// decisions round.
    pub(crate) fn after(last_stamp_ns: u64, author: Arc<str>, wall_ns: u64) -> Self {
        Self {
            author,
            stamp_ns: wall_ns.max(last_stamp_ns.saturating_add(1)),
        }
    }
}

impl Default for Decided {
    /// By nobody, before everything.
    fn default() -> Self {
        Self {
            author: "".into(),
            stamp_ns: 0,
        }
    }
}

/// The present standing of a view, as it is stored.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Register {
    pub(crate) standing: Standing,
    pub(crate) decided: Decided,
    /// Sequence of the history entry that touched the view last.
    pub(crate) sequence: u64,
}

impl Register {
    /// Of a view just stored by entry `sequence`: any decision is later.
    pub(crate) fn untouched(sequence: u64) -> Self {
        Self {
            standing: Standing::Unnamed,
            decided: Decided::default(),
            sequence,
        }
    }

    /// Whether what was decided elsewhere is later. Equal times are told apart by
    /// what was decided, so that all robots come to the same.
    pub(crate) fn yields_to(&self, stamp_ns: u64, standing: &Standing) -> bool {
        (self.decided.stamp_ns, &self.standing) < (stamp_ns, standing)
    }
}
