//! Assumptions: defaults used in place of absent sources.

coded_enum::coded_enum! {
    /// Default used in place of one absent source.
    pub enum Assumption {
        /// Capsules of people are unknown: no candidate is treated as a part of a person.
        NoPersonKnown, "no-person-known";
        /// Capsules of the robot are unknown: no candidate is treated as a part of the robot.
        NoRobotKnown, "no-robot-known";
        /// Up direction is unknown: the most table-like plane of the image is used.
        UpGuessed, "up-guessed";
        /// Camera pose is unknown: the camera frame serves as the world frame.
        NoCameraPose, "no-camera-pose";
    }
}

impl Assumption {
    /// Description of the assumption as a sentence.
    pub fn sentence(self) -> &'static str {
        match self {
            Self::NoPersonKnown => {
                "no person state received: people are excluded only where depth shows them"
            }
            Self::NoRobotKnown => "no arm state received: arm points cannot be excluded",
            Self::UpGuessed => {
                "the direction of gravity is not known: the plane that looks most like a table \
                 in the image is used"
            }
            Self::NoCameraPose => {
                "the camera's pose is not known: the camera frame serves as the world frame, and \
                 the poses of people and the robot cannot be used"
            }
        }
    }

    fn bit(self) -> u32 {
        1 << self as u32
    }
}

/// Set of assumptions, stored as bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Assumptions(u32);

impl Assumptions {
    /// Bit mask on the wire: bit `i` is the assumption with discriminant `i`.
    pub fn bits(self) -> u32 {
        self.0
    }

    /// Assumptions of a bit mask; bits without an assumption are ignored by
    /// [`iter`](Self::iter).
    pub fn from_bits(bits: u32) -> Self {
        Self(bits)
    }

    /// Add an assumption.
    pub fn add(&mut self, assumption: Assumption) {
        self.0 |= assumption.bit();
    }

    /// `true` when the set contains the assumption.
    pub fn contains(self, assumption: Assumption) -> bool {
        self.0 & assumption.bit() != 0
    }

    /// Assumptions of the set in the order of their discriminants.
    pub fn iter(self) -> impl Iterator<Item = Assumption> {
        Assumption::ALL
            .into_iter()
            .filter(move |one| self.contains(*one))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn assumptions_round_trip_through_their_bits() {
        for (i, one) in Assumption::ALL.into_iter().enumerate() {
            assert_eq!(one as usize, i);
            let mut assumptions = Assumptions::default();
            assert!(!assumptions.contains(one));
            assumptions.add(one);
            let back: Vec<_> = Assumptions::from_bits(assumptions.bits()).iter().collect();
            assert_eq!(back, [one]);
        }
        assert_eq!(Assumptions::from_bits(1 << 31).iter().count(), 0);
    }
}
