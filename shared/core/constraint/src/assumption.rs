//! What was taken for granted where a source was absent.

/// One thing that was taken for granted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Assumption {
    /// The person's capsules are not known.
    NoPersonKnown,
    /// The robot's capsules are not known.
    NoRobotKnown,
    /// Up is not known.
    UpGuessed,
    /// The camera's pose is not known.
    NoCameraPose,
}

impl Assumption {
    /// All of them; each stands at the place of its own number.
    pub const ALL: [Self; 4] = [
        Self::NoPersonKnown,
        Self::NoRobotKnown,
        Self::UpGuessed,
        Self::NoCameraPose,
    ];

    /// A short name for scripts.
    pub fn name(self) -> &'static str {
        match self {
            Self::NoPersonKnown => "no-person-known",
            Self::NoRobotKnown => "no-robot-known",
            Self::UpGuessed => "up-guessed",
            Self::NoCameraPose => "no-camera-pose",
        }
    }

    /// A sentence for people.
    pub fn sentence(self) -> &'static str {
        match self {
            Self::NoPersonKnown => {
                "where people are is not known: nothing is taken for a part of a person"
            }
            Self::NoRobotKnown => {
                "where the robot's arm is is not known: nothing is taken for a part of the robot"
            }
            Self::UpGuessed => {
                "the direction of gravity is not known: the plane that looks most like a table \
                 in the image is taken for it"
            }
            Self::NoCameraPose => {
                "the camera's pose is not known: the world is the camera's frame, and where \
                 people and the robot are can not be used"
            }
        }
    }

    fn bit(self) -> u32 {
        1 << self as u32
    }
}

/// Things that were taken for granted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Assumptions(u32);

impl Assumptions {
    /// One bit for each assumption, by its number.
    pub fn bits(self) -> u32 {
        self.0
    }

    /// The assumptions of some bits; bits without a meaning stay unheard.
    pub fn from_bits(bits: u32) -> Self {
        Self(bits)
    }

    /// Adds one.
    pub fn add(&mut self, assumption: Assumption) {
        self.0 |= assumption.bit();
    }

    /// Whether it is one of them.
    pub fn contains(self, assumption: Assumption) -> bool {
        self.0 & assumption.bit() != 0
    }

    /// All of them.
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
    fn assumptions_survive_their_bits() {
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
