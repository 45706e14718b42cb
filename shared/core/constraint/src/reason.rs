//! Why a constraint holds or does not.

use std::fmt;

/// Declares the reasons with their stable numbers, their values, and their
/// sentences.
macro_rules! reasons {
    ($($(#[$doc:meta])* $code:literal $reason:ident $({ $($(#[$value_doc:meta])* $value:ident),+ })?
        => $sentence:literal $(, $shown:expr)*;)*) => {
        /// Why a constraint holds or does not; the numbers that decided it go with
        /// it. Prints as the rest of a sentence about the candidate.
        #[derive(Debug, Clone, Copy, PartialEq)]
        #[non_exhaustive]
        pub enum Reason {
            $($(#[$doc])* $reason $({ $($(#[$value_doc])* $value: f32),+ })?,)*
        }

        impl Reason {
            /// Its number on the wire; never given to another reason.
            pub fn code(self) -> u16 {
                match self {
                    $(Self::$reason $({ $($value: _),+ })? => $code,)*
                }
            }

            /// Its values on the wire; zero where it has fewer.
            pub fn values(self) -> [f32; 2] {
                match self {
                    $(Self::$reason $({ $($value),+ })? => padded(&[$($($value),+)?]),)*
                }
            }

            /// The reason of a number and its values; `None` for any other number,
            /// and for values that are not finite.
            pub fn from_parts(code: u16, values: [f32; 2]) -> Option<Self> {
                if !values.iter().all(|value| value.is_finite()) {
                    return None;
                }
                let mut values = values.into_iter();
                let mut next = || values.next().unwrap_or(0.0);
                match code {
                    $($code => Some(Self::$reason $({ $($value: next()),+ })?),)*
                    _ => None,
                }
            }
        }

        impl fmt::Display for Reason {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                match *self {
                    $(Self::$reason $({ $($value),+ })? => write!(f, $sentence $(, $shown)*),)*
                }
            }
        }
    };
}

fn padded(values: &[f32]) -> [f32; 2] {
    std::array::from_fn(|i| values.get(i).copied().unwrap_or(0.0))
}

/// A share as people write it.
struct Percent(f32);

/// A length in metres as people write it.
struct Cm(f32);

/// A volume in cubic metres as people write it.
struct Litres(f32);

impl fmt::Display for Percent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} %", (100.0 * self.0).round())
    }
}

impl fmt::Display for Cm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} cm", (1000.0 * self.0).round() / 10.0)
    }
}

impl fmt::Display for Litres {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} l", (1e4 * self.0).round() / 10.0)
    }
}

reasons! {
    /// Nothing was asked.
    0 NotJudged
        => "it was not judged";
    /// Its lowest points are near the table.
    1 StandsOnTable
        => "it stands on the table";
    /// It touches something that stands on the table.
    2 RestsOnObject
        => "it rests on something that stands on the table";
    /// Something nearer hides what it stands on.
    3 LowerEndHidden
        => "something nearer hides what it stands on";
    /// Nothing carries it.
    4 InTheAir {
        /// From the table to its lowest point, metres.
        gap_m
    } => "nothing carries it: it begins {} over the table", Cm(gap_m);
    /// There is no depth where it should stand.
    5 LowerEndUnseen
        => "there is no depth below it: what it stands on is not seen";
    /// No track explains it.
    10 NoTrackThere {
        /// Greatest overlap with a track's box, as intersection over union.
        overlap
    } => "no track explains it (greatest overlap {})", Percent(overlap);
    /// It fills the box of a track.
    11 OverlapsTrack {
        /// Overlap with the track's box, as intersection over union.
        overlap
    } => "it is a part of what is tracked already ({} overlap with a track's box)", Percent(overlap);
    /// It lies within the box of a track.
    12 InsideTrack {
        /// Share of its points in the track's grown box.
        share
    } => "it is a part of what is tracked already ({} of its points in a track's box)", Percent(share);
    /// One hand could grasp it.
    20 Graspable {
        /// Its longest side, metres.
        side_m
    } => "a hand could grasp it (longest side {})", Cm(side_m);
    /// Too small for an object.
    21 TooSmall {
        /// Its longest side, metres.
        side_m,
        /// Least length, metres.
        least_m
    } => "it is too small (longest side {}, at least {})", Cm(side_m), Cm(least_m);
    /// Too long to be grasped.
    22 TooLong {
        /// Its longest side, metres.
        side_m,
        /// Greatest length, metres.
        most_m
    } => "it is too long (longest side {}, at most {})", Cm(side_m), Cm(most_m);
    /// Too broad to be grasped.
    23 TooBroad {
        /// Its second side, metres.
        side_m,
        /// Greatest length, metres.
        most_m
    } => "it is too broad (second side {}, at most {})", Cm(side_m), Cm(most_m);
    /// Too bulky to be grasped.
    24 TooBulky {
        /// Its volume, cubic metres.
        volume_m3,
        /// Greatest volume, cubic metres.
        most_m3
    } => "it is too bulky ({}, at most {})", Litres(volume_m3), Litres(most_m3);
    /// A part of it is missing, so that it may be larger than it looks.
    25 SizeCut {
        /// Its longest side as far as it is seen, metres.
        side_m
    } => "the border of the image cuts it, so its size is not known (at least {})", Cm(side_m);
    /// Where people are is not known.
    30 NoPersonKnown
        => "where people are is not known";
    /// It is no part of a person.
    31 NoPerson
        => "it is no part of a person";
    /// It is a part of a person.
    32 Person {
        /// Share of its points near a part of the body.
        share,
        /// What is near, metres.
        margin_m
    } => "it is a person ({} of its points within {} of the body)", Percent(share), Cm(margin_m);
    /// It may be a part of a person.
    33 MaybePerson {
        /// Share of its points near a part of the body.
        share,
        /// What is near, metres.
        margin_m
    } => "it may be a person ({} of its points within {} of the body)", Percent(share), Cm(margin_m);
    /// A person touches it, so that a part of it may be missing.
    34 AtPerson {
        /// Share of its points near a part of the body.
        share,
        /// What is near, metres.
        margin_m
    } => "a person touches it, so a part of it may be missing ({} of its points within {} of the body)", Percent(share), Cm(margin_m);
    /// Where the robot's arm is is not known.
    40 NoRobotKnown
        => "where the robot's arm is is not known";
    /// It is no part of the robot.
    41 NoRobot
        => "it is no part of the robot";
    /// It is a part of the robot.
    42 Robot {
        /// Share of its points near a link.
        share,
        /// What is near, metres.
        margin_m
    } => "it is the robot's arm ({} of its points within {} of a link)", Percent(share), Cm(margin_m);
    /// It may be a part of the robot.
    43 MaybeRobot {
        /// Share of its points near a link.
        share,
        /// What is near, metres.
        margin_m
    } => "it may be the robot's arm ({} of its points within {} of a link)", Percent(share), Cm(margin_m);
    /// The robot touches it, so that a part of it may be missing.
    44 AtRobot {
        /// Share of its points near a link.
        share,
        /// What is near, metres.
        margin_m
    } => "the robot touches it, so a part of it may be missing ({} of its points within {} of a link)", Percent(share), Cm(margin_m);
    /// It stands away from the table's rim.
    50 AwayFromRim
        => "it stands away from the table's rim";
    /// It stands at the table's rim.
    51 AtRim {
        /// Share of its points near the rim.
        share,
        /// What is near, metres.
        distance_m
    } => "it is at the table's rim ({} of its points nearer than {})", Percent(share), Cm(distance_m);
    /// Only the history of its track tells whether a view is key.
    60 KeyViewNotDecided
        => "whether a view is key is decided by its track, later";
    /// It is seen as a whole, as far as the border of the image goes.
    70 WithinView
        => "the border of the image does not cut it";
    /// It comes to the border of what the sensor sees.
    71 AtImageBorder
        => "it comes to the border of what the sensor sees";
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reason_survives_its_number_and_values() {
        let values = [0.25, 0.03];
        let all: Vec<_> = (0..u16::MAX)
            .filter_map(|code| Some((code, Reason::from_parts(code, values)?)))
            .collect();
        assert_eq!(all.len(), 30);
        for (code, reason) in all {
            assert_eq!(reason.code(), code);
            let n_values = reason
                .values()
                .iter()
                .filter(|&&value| value != 0.0)
                .count();
            assert_eq!(reason.values()[..n_values], values[..n_values]);
            assert_eq!(Reason::from_parts(code, reason.values()), Some(reason));
            assert!(reason.to_string().len() > 10);
        }
    }

    #[test]
    fn broken_values_are_no_reason() {
        assert_eq!(Reason::from_parts(42, [f32::NAN, 0.0]), None);
        assert_eq!(Reason::from_parts(42, [0.0, f32::INFINITY]), None);
        assert_eq!(Reason::from_parts(9999, [0.0; 2]), None);
    }

    #[test]
    fn a_sentence_tells_the_numbers() {
        let arm = Reason::Robot {
            share: 0.867,
            margin_m: 0.03,
        };
        assert_eq!(
            arm.to_string(),
            "it is the robot's arm (87 % of its points within 3 cm of a link)"
        );
    }
}
