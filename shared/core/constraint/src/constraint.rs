//! Constraint: a named predicate about an object candidate.

use crate::finding::Finding;
use crate::reason::Reason;
use crate::ternary::Ternary;

coded_enum::coded_enum! {
    /// Constraint: a predicate about an object candidate.
    #[derive(PartialOrd, Ord)]
    pub enum Constraint {
        /// Support: the candidate stands on the table, or on or behind an object that does.
        Table, "C_table";
        /// Novelty: no live track explains the candidate.
        Track, "C_track";
        /// Graspable size: one hand could grasp the candidate.
        Size, "C_size";
        /// Person: the candidate is a part of a person.
        Instructor, "C_instructor";
        /// Robot: the candidate is a part of the robot.
        Robot, "C_robot";
        /// Table rim: the candidate stands at the rim, where half an object looks like a whole
        /// one.
        Edge, "C_edge";
        /// Key view: this view of the candidate is to be stored.
        KeyView, "C_key_view";
        /// Image border: the candidate reaches the border of the sensor's view and may be cut.
        ImageBorder, "C_image_border";
    }
}

impl Constraint {
    /// Number of constraints in the set [`Self::ALL`].
    pub const N: usize = Self::ALL.len();

    /// Constraint of a name; case-insensitive, with or without the prefix `C_`.
    pub fn from_name(name: &str) -> Option<Self> {
        let same = |one: &Self| {
            let full = one.word();
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
            let name = constraint.word();
            for spelling in [name, &name[2..], &name.to_uppercase(), &name.to_lowercase()] {
                assert_eq!(Constraint::from_name(spelling), Some(constraint));
            }
        }
        assert_eq!(Constraint::from_name("C_"), None);
        assert_eq!(Constraint::from_name(""), None);
    }
}
