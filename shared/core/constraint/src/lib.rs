//! The constraints of a candidate, and the rule that joins them.
//!
//! Each constraint is a predicate that is true, false or unknown, with a
//! reason. A rule, ψ in the paper, is an expression over them; only a candidate
//! for which it is true begins a track.

mod assumption;
mod expression;
mod invalid_expression;
mod parser;
mod reason;
mod truth;

pub use assumption::{Assumption, Assumptions};
pub use expression::Expression;
pub use invalid_expression::InvalidExpression;
pub use reason::Reason;
pub use truth::Truth;

/// One predicate about a candidate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Constraint {
    /// It stands on the table, or on or behind something that does.
    Table,
    /// No live track explains it.
    Track,
    /// One hand could grasp it.
    Size,
    /// It is a part of a person.
    Instructor,
    /// It is a part of the robot.
    Robot,
    /// It stands at the table's rim, where half an object looks like a whole one.
    Edge,
    /// This view of it is to be stored.
    KeyView,
    /// It comes to the border of what the sensor sees.
    ImageBorder,
}

impl Constraint {
    /// How many there are.
    pub const N: usize = Self::ALL.len();

    /// All constraints; each stands at the place of its own number.
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

    /// Its name in a rule.
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

    /// The constraint of a name, in capitals or not, with or without `C_`.
    pub fn from_name(name: &str) -> Option<Self> {
        let same = |one: &Self| {
            let full = one.name();
            full.eq_ignore_ascii_case(name) || full[2..].eq_ignore_ascii_case(name)
        };
        Self::ALL.into_iter().find(same)
    }

    /// What it finds when its source is absent: the tracks, the person's or the
    /// robot's capsules, the track's own history for a key view. The other
    /// constraints need nothing but the cloud and are never without a source.
    pub fn when_absent(self) -> Finding {
        let (truth, reason) = match self {
            Self::Track => (Truth::True, Reason::NoTrackThere { overlap: 0.0 }),
            Self::Instructor => (Truth::False, Reason::NoPersonKnown),
            Self::Robot => (Truth::False, Reason::NoRobotKnown),
            Self::KeyView => (Truth::Unknown, Reason::KeyViewNotDecided),
            Self::Table | Self::Size | Self::Edge | Self::ImageBorder => {
                (Truth::Unknown, Reason::NotJudged)
            }
        };
        Finding { truth, reason }
    }

    pub(crate) fn bit(self) -> u8 {
        1 << self as u8
    }
}

/// What one constraint says of one candidate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Finding {
    /// Whether it holds.
    pub truth: Truth,
    /// Why.
    pub reason: Reason,
}

/// What every constraint says of one candidate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Findings([Finding; Constraint::N]);

impl Default for Findings {
    /// As if all sources were absent.
    fn default() -> Self {
        Self(Constraint::ALL.map(Constraint::when_absent))
    }
}

impl Findings {
    /// What one constraint says.
    pub fn of(&self, constraint: Constraint) -> Finding {
        self.0[constraint as usize]
    }

    /// Writes down what one constraint says.
    pub fn set(&mut self, constraint: Constraint, finding: Finding) {
        self.0[constraint as usize] = finding;
    }

    /// Whether the candidate is known to be a part of a person or of the robot.
    pub fn is_limb(&self) -> bool {
        let holds = |constraint| self.of(constraint).truth == Truth::True;
        holds(Constraint::Robot) || holds(Constraint::Instructor)
    }
}

/// Some of the constraints.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ConstraintSet(u8);

impl ConstraintSet {
    /// No constraint.
    pub const NONE: Self = Self(0);

    /// One bit for each constraint, by its number.
    pub fn bits(self) -> u8 {
        self.0
    }

    /// The set of some bits.
    pub fn from_bits(bits: u8) -> Self {
        Self(bits)
    }

    /// Whether it holds a constraint.
    pub fn contains(self, constraint: Constraint) -> bool {
        self.0 & constraint.bit() != 0
    }

    /// Its constraints.
    pub fn iter(self) -> impl Iterator<Item = Constraint> {
        Constraint::ALL
            .into_iter()
            .filter(move |one| self.contains(*one))
    }

    /// Whether it holds none.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    pub(crate) fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl From<Constraint> for ConstraintSet {
    fn from(constraint: Constraint) -> Self {
        Self(constraint.bit())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_constraint_is_known_by_its_name_and_its_place() {
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

    #[test]
    fn a_set_holds_what_was_put_in() {
        let set = ConstraintSet::from(Constraint::Edge).union(Constraint::Table.into());
        let held: Vec<_> = set.iter().collect();
        assert_eq!(held, [Constraint::Table, Constraint::Edge]);
        assert_eq!(ConstraintSet::from_bits(set.bits()), set);
        assert!(ConstraintSet::default().is_empty() && !set.is_empty());
    }

    #[test]
    fn without_sources_nobody_is_a_person_or_the_robot() {
        let findings = Findings::default();
        assert!(!findings.is_limb());
        assert_eq!(findings.of(Constraint::Track).truth, Truth::True);
        assert_eq!(findings.of(Constraint::KeyView).truth, Truth::Unknown);
    }
}
