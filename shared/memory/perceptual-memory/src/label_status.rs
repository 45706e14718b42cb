//! Label status of a view, as a last-writer-wins register with author and time stamp.

use std::fmt;
use std::sync::Arc;

use learning::CategoryName;
use serde::{Deserialize, Serialize};

/// Label status of a stored view.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum LabelStatus {
    /// Unlabelled view.
    #[serde(rename = "u")]
    Unnamed,
    /// Labelled as an example of a category.
    #[serde(rename = "n")]
    Named(CategoryName),
    /// Forgotten: excluded from recognition and teaching, and purged later.
    #[serde(rename = "f")]
    Forgotten,
}

impl LabelStatus {
    /// Category label of the view, if it has one.
    pub fn category(&self) -> Option<&CategoryName> {
        match self {
            Self::Named(name) => Some(name),
            Self::Unnamed | Self::Forgotten => None,
        }
    }

    /// Label status of a view with an optional label.
    pub(crate) fn of(category: Option<CategoryName>) -> Self {
        category.map_or(Self::Unnamed, Self::Named)
    }
}

impl fmt::Display for LabelStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unnamed => f.write_str("no name"),
            Self::Named(name) => write!(f, "{name}"),
            Self::Forgotten => f.write_str("forgotten"),
        }
    }
}

/// Author and time stamp of a decision. Of two decisions on one view the later one wins, also
/// across robots.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct DecisionStamp {
    /// Author of the decision.
    pub author: Arc<str>,
    /// Time, nanoseconds since 1970, UTC; always later than that of the decision it replaced,
    /// whatever the clock says.
    pub stamp_ns: u64,
}

/// Maximum accepted clock difference between two robots: a day. Chosen.
const MAX_AHEAD_NS: u64 = 24 * 3_600_000_000_000;

impl DecisionStamp {
    /// `true` for a decision that is more than a day ahead of a clock, of which an import refuses
    /// all: it would win over every decision that is made here until then.
    pub fn is_too_far_ahead(&self, wall_ns: u64) -> bool {
        self.stamp_ns.saturating_sub(wall_ns) > MAX_AHEAD_NS
    }

    /// Time stamp of a new decision: the present time, but later than the previous stamp, so that a
    /// clock that steps back does not reorder decisions.
    pub(crate) fn after(last_stamp_ns: u64, author: Arc<str>, wall_ns: u64) -> Self {
        Self {
            author,
            stamp_ns: wall_ns.max(last_stamp_ns.saturating_add(1)),
        }
    }
}

/// Author of limit decisions in the history.
pub(crate) const LIMIT_AUTHOR: &str = "the store itself, to hold a limit";

impl DecisionStamp {
    /// `true` if a view was forgotten only because of a local retention limit, which does
    /// not concern other robots.
    pub(crate) fn is_limit_decision(&self) -> bool {
        &*self.author == LIMIT_AUTHOR
    }
}

impl Default for DecisionStamp {
    /// Earliest possible decision, without an author.
    fn default() -> Self {
        Self {
            author: "".into(),
            stamp_ns: 0,
        }
    }
}

/// Last-writer-wins register: present label status of a view, as stored.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct LwwRegister {
    pub(crate) standing: LabelStatus,
    pub(crate) decided: DecisionStamp,
    /// Sequence number of the last history entry that touched the view.
    pub(crate) sequence: u64,
}

impl LwwRegister {
    /// Initial register of a view stored by entry `sequence`; any decision is later.
    pub(crate) fn untouched(sequence: u64) -> Self {
        Self {
            standing: LabelStatus::Unnamed,
            decided: DecisionStamp::default(),
            sequence,
        }
    }

    /// `true` if a decision from elsewhere is later. Ties are broken by the label status, so that
    /// all robots converge.
    pub(crate) fn yields_to(&self, stamp_ns: u64, standing: &LabelStatus) -> bool {
        (self.decided.stamp_ns, &self.standing) < (stamp_ns, standing)
    }
}
