//! Constraint: a named predicate about an object candidate.

use crate::finding::Finding;
use crate::reason::Reason;
use crate::ternary::Ternary;

/// Constraint: a predicate about an object candidate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Constraint {
    /// Support: the candidate stands on the table, or on or behind an object that does.
    Table,
    /// Novelty: no live track explains the candidate.
    Track,
    /// Graspable size: one hand could grasp the candidate.
    Size,
    /// Person: the candidate is a part of a person.
    Instructor,
    /// Robot: the candidate is a part of the robot.
    Robot,
    /// Table rim: the candidate stands at the rim, where half an object looks like a whole
    /// one.
    Edge,
    /// Key view: this view of the candidate is to be stored.
    KeyView,
    /// Image border: the candidate reaches the border of the sensor's view and may be cut.
    ImageBorder,
}

impl Constraint {
    /// Number of constraints in the set [`Self::ALL`].
    pub const N: usize = Self::ALL.len();

    /// All constraints; the index of each is its discriminant.
    pub const ALL: [Self; 8] = [
        Self::Table,
        Self::Track,
        Self::Size,
        Self::Instructor,
        Self::Robot,
        Self::Edge,
        Self::KeyView,
        Self::ImageBorder,
    ];

    /// Name in a rule, for example `C_table`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Table => "C_table",
            Self::Track => "C_track",
            Self::Size => "C_size",
            Self::Instructor => "C_instructor",
            Self::Robot => "C_robot",
            Self::Edge => "C_edge",
            Self::KeyView => "C_key_view",
            Self::ImageBorder => "C_image_border",
        }
    }

    /// Constraint of a name; case-insensitive, with or without the prefix `C_`.
    pub fn from_name(name: &str) -> Option<Self> {
        let same = |one: &Self| {
            let full = one.name();
            full.eq_ignore_ascii_case(name) || full[2..].eq_ignore_ascii_case(name)
        };
        Self::ALL.into_iter().find(same)
    }

    /// Default finding without a source: no tracks, no capsules of people or the robot, or
    /// no history of the track for a key view. The other constraints need only the cloud;
    /// their default is unknown.
    pub fn default_finding(self) -> Finding {
        let (truth, reason) = match self {
            Self::Track => (Ternary::True, Reason::NoOverlappingTrack { overlap: 0.0 }),
            Self::Instructor => (Ternary::False, Reason::NoPersonKnown),
            Self::Robot => (Ternary::False, Reason::NoRobotKnown),
            Self::KeyView => (Ternary::Unknown, Reason::KeyViewUndecided),
            Self::Table | Self::Size | Self::Edge | Self::ImageBorder => {
                (Ternary::Unknown, Reason::NotEvaluated)
            }
        };
        Finding {
            value: truth,
            reason,
        }
    }

    pub(crate) fn bit(self) -> u8 {
        1 << self as u8
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constraint_round_trips_through_its_name_and_index() {
        for (i, constraint) in Constraint::ALL.into_iter().enumerate() {
            assert_eq!(constraint as usize, i);
            let name = constraint.name();
            for spelling in [name, &name[2..], &name.to_uppercase(), &name.to_lowercase()] {
                assert_eq!(Constraint::from_name(spelling), Some(constraint));
            }
        }
        assert_eq!(Constraint::from_name("C_"), None);
        assert_eq!(Constraint::from_name(""), None);
    }
}
