//! Findings of all constraints for one candidate.

use crate::constraint::Constraint;
use crate::finding::Finding;
use crate::ternary::Ternary;

/// Findings of all constraints for one candidate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Findings([Finding; Constraint::N]);

impl Default for Findings {
    /// Default findings, as if all sources were absent.
    fn default() -> Self {
        Self(Constraint::ALL.map(Constraint::default_finding))
    }
}

impl Findings {
    /// Finding of the given constraint.
    pub fn get(&self, constraint: Constraint) -> Finding {
        self.0[constraint as usize]
    }

    /// Sets the finding about a constraint.
    pub fn set(&mut self, constraint: Constraint, finding: Finding) {
        self.0[constraint as usize] = finding;
    }

    /// `true` when the candidate is known to be a part of a person or of the robot.
    pub fn is_person_or_robot(&self) -> bool {
        let holds = |constraint| self.get(constraint).value == Ternary::True;
        holds(Constraint::Robot) || holds(Constraint::Instructor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn default_findings_have_no_person_or_robot() {
        let findings = Findings::default();
        assert!(!findings.is_person_or_robot());
        assert_eq!(findings.get(Constraint::Track).value, Ternary::True);
        assert_eq!(findings.get(Constraint::KeyView).value, Ternary::Unknown);
    }
}
