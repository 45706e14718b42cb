//! Reason codes of constraint findings.

use std::fmt;

/// Declare the reasons with their stable codes, values and sentences. The name before them stands
/// for the surface of the candidate.
macro_rules! reasons {
    ($surface:ident: $($(#[$doc:meta])* $code:literal $reason:ident $({ $($(#[$value_doc:meta])* $value:ident),+ })?
        => $sentence:literal $(, $shown:expr)*;)*) => {
        /// Reason for the value of a constraint, with the numbers that decided it. Displays
        /// as a sentence about the candidate.
        #[derive(Debug, Clone, Copy, PartialEq)]
        #[non_exhaustive]
        pub enum Reason {
            $($(#[$doc])* $reason $({ $($(#[$value_doc])* $value: f32),+ })?,)*
        }

        impl Reason {
            /// Reason code on the wire; never reused for another reason.
            pub fn code(self) -> u16 {
                match self {
                    $(Self::$reason $({ $($value: _),+ })? => $code,)*
                }
            }

            /// Values on the wire; unused ones are zero.
            pub fn values(self) -> [f32; 2] {
                match self {
                    $(Self::$reason $({ $($value),+ })? => padded(&[$($($value),+)?]),)*
                }
            }

            /// Reason of a wire code and its values; `None` for an unknown code and for
            /// values that are not finite.
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

        impl Reason {
            /// Sentence about a candidate on or over a surface with a name, such as "the table".
            pub fn sentence(self, $surface: &str) -> String {
                match self {
                    $(Self::$reason $({ $($value),+ })? => format!($sentence $(, $shown)*),)*
                }
            }
        }
    };
}

fn padded(values: &[f32]) -> [f32; 2] {
    std::array::from_fn(|i| values.get(i).copied().unwrap_or(0.0))
}

/// Display of a share in percent.
struct Percent(f32);

/// Display of a length in centimetres; holds metres.
struct Cm(f32);

/// Display of a volume in litres; holds cubic metres.
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

reasons! { surface:
    /// Constraint was not evaluated.
    0 NotEvaluated
        => "it was not evaluated";
    /// The candidate stands on the table: its lowest points are near the plane.
    1 StandsOnTable
        => "it stands on {}", surface;
    /// The candidate rests on an object that stands on the table.
    2 RestsOnObject
        => "it rests on an object that stands on {}", surface;
    /// The base of the candidate is occluded by a nearer surface.
    3 BaseOccluded
        => "a nearer surface occludes its base";
    /// Candidate has no support.
    4 Unsupported {
        /// Height of the lowest point above the table, metres.
        gap_m
    } => "unsupported: its lowest point is {} above {}", Cm(gap_m), surface;
    /// The sensor has no depth below the candidate.
    5 BaseWithoutDepth
        => "its support is not visible: there is no depth below it";
    /// The candidate begins off the table, as furniture beside it does.
    6 BeginsOffTable {
        /// Share of the lower border below or behind the table, 0 to 1.
        share
    } => "it does not begin on {}: {} of its lower border goes on below or behind it", surface, Percent(share);
    /// No track overlaps the candidate.
    10 NoOverlappingTrack {
        /// Greatest intersection over union with a track's box, 0 to 1.
        overlap
    } => "no track overlaps it (greatest overlap {})", Percent(overlap);
    /// The candidate overlaps the box of a track.
    11 OverlapsTrack {
        /// Intersection over union with the track's box, 0 to 1.
        overlap
    } => "it belongs to a tracked object ({} overlap with the track's box)", Percent(overlap);
    /// The candidate is inside the box of a track.
    12 InsideTrack {
        /// Share of the points inside the track's grown box, 0 to 1.
        share
    } => "it belongs to a tracked object ({} of its points in the track's box)", Percent(share);
    /// One hand could grasp the candidate.
    20 Graspable {
        /// Longest side of the object, metres.
        side_m
    } => "a hand could grasp it (longest side {})", Cm(side_m);
    /// The candidate is too small for an object.
    21 TooSmall {
        /// Longest side of the object, metres.
        side_m,
        /// Least accepted length of the longest side, metres.
        min_m
    } => "it is too small (longest side {}, at least {})", Cm(side_m), Cm(min_m);
    /// The candidate is too long to be grasped.
    22 TooLong {
        /// Longest side of the object, metres.
        side_m,
        /// Greatest accepted length of the longest side, metres.
        max_m
    } => "it is too long (longest side {}, at most {})", Cm(side_m), Cm(max_m);
    /// The candidate is too broad to be grasped.
    23 TooBroad {
        /// Second longest side of the object, metres.
        side_m,
        /// Greatest accepted length of the second longest side, metres.
        max_m
    } => "it is too broad (second side {}, at most {})", Cm(side_m), Cm(max_m);
    /// The candidate is too bulky to be grasped.
    24 TooBulky {
        /// Volume of the candidate's box, cubic metres.
        volume_m3,
        /// Greatest accepted volume of the box, cubic metres.
        max_m3
    } => "it is too bulky ({}, at most {})", Litres(volume_m3), Litres(max_m3);
    /// The image border truncates the candidate; its true size is unknown.
    25 SizeTruncated {
        /// Longest visible side of the object, metres.
        side_m
    } => "the image border truncates it, so its size is unknown (at least {})", Cm(side_m);
    /// No person state is available.
    30 NoPersonKnown
        => "no person state was received";
    /// The candidate is not a part of a person.
    31 NotPerson
        => "it is no part of a person";
    /// The candidate is a part of a person.
    32 Person {
        /// Share of the points near the body, 0 to 1.
        share,
        /// Distance threshold from the body's capsules, metres.
        margin_m
    } => "it is a person ({} of its points within {} of the body)", Percent(share), Cm(margin_m);
    /// The candidate may be a part of a person.
    33 MaybePerson {
        /// Share of the points near the body, 0 to 1.
        share,
        /// Distance threshold from the body's capsules, metres.
        margin_m
    } => "it may be a person ({} of its points within {} of the body)", Percent(share), Cm(margin_m);
    /// A person touches the candidate, so that a part of it may be missing.
    34 TouchedByPerson {
        /// Share of the points near the body, 0 to 1.
        share,
        /// Distance threshold from the body's capsules, metres.
        margin_m
    } => "a person touches it, so a part of it may be missing ({} of its points within {} of the body)", Percent(share), Cm(margin_m);
    /// The candidate reaches over the table from beside it, as a person's arm does.
    35 ReachesOverTable
        => "it reaches over {} from beside it, as a person's arm does", surface;
    /// No robot state is available.
    40 NoRobotKnown
        => "no arm state was received";
    /// The candidate is not a part of the robot.
    41 NotRobot
        => "it is no part of the robot";
    /// The candidate is a part of the robot.
    42 Robot {
        /// Share of the points near a link, 0 to 1.
        share,
        /// Distance threshold from the links' capsules, metres.
        margin_m
    } => "it is the robot's arm ({} of its points within {} of a link)", Percent(share), Cm(margin_m);
    /// The candidate may be a part of the robot.
    43 MaybeRobot {
        /// Share of the points near a link, 0 to 1.
        share,
        /// Distance threshold from the links' capsules, metres.
        margin_m
    } => "it may be the robot's arm ({} of its points within {} of a link)", Percent(share), Cm(margin_m);
    /// The robot touches the candidate, so that a part of it may be missing.
    44 TouchedByRobot {
        /// Share of the points near a link, 0 to 1.
        share,
        /// Distance threshold from the links' capsules, metres.
        margin_m
    } => "the robot touches it, so a part of it may be missing ({} of its points within {} of a link)", Percent(share), Cm(margin_m);
    /// The candidate stands away from the table's rim.
    50 AwayFromRim
        => "it stands away from the rim of {}", surface;
    /// The candidate stands at the table's rim.
    51 AtRim {
        /// Share of the points near the rim, 0 to 1.
        share,
        /// Distance threshold from the rim, metres.
        distance_m
    } => "it is at the rim of {} ({} of its points nearer than {})", surface, Percent(share), Cm(distance_m);
    /// The candidate reaches over the table's rim.
    52 BeyondRim {
        /// Share of the points beyond the rim, 0 to 1.
        share
    } => "it reaches over the rim of {} ({} of its points)", surface, Percent(share);
    /// The table's border near the candidate is hidden or outside of the view.
    53 RimUnseen {
        /// Share of the points near the unseen border, 0 to 1.
        share,
        /// Distance threshold from the border, metres.
        distance_m
    } => "the border of {} near it is hidden or outside of the view ({} of its points nearer than {})", surface, Percent(share), Cm(distance_m);
    /// The key-view decision needs the history of the track and is made later.
    60 KeyViewUndecided
        => "its track decides later whether this is a key view";
    /// The candidate does not reach the image border.
    70 WithinView
        => "the image border does not truncate it";
    /// The candidate reaches the image border.
    71 AtImageBorder
        => "it touches the image border";
}

/// Sentence about a candidate of the table.
impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.sentence("the table"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reason_round_trips_through_its_code_and_values() {
        let values = [0.25, 0.03];
        let all: Vec<_> = (0..u16::MAX)
            .filter_map(|code| Some((code, Reason::from_parts(code, values)?)))
            .collect();
        assert_eq!(all.len(), 34);
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
    fn from_parts_rejects_non_finite_values() {
        assert_eq!(Reason::from_parts(42, [f32::NAN, 0.0]), None);
        assert_eq!(Reason::from_parts(42, [0.0, f32::INFINITY]), None);
        assert_eq!(Reason::from_parts(9999, [0.0; 2]), None);
    }

    #[test]
    fn display_includes_the_numbers() {
        let arm = Reason::Robot {
            share: 0.867,
            margin_m: 0.03,
        };
        assert_eq!(
            arm.to_string(),
            "it is the robot's arm (87 % of its points within 3 cm of a link)"
        );
    }

    #[test]
    fn sentence_names_the_surface_of_the_candidate() {
        let rim = Reason::AtRim {
            share: 0.4,
            distance_m: 0.03,
        };
        let level = "the level 40 cm above the table";
        assert_eq!(
            rim.sentence(level),
            "it is at the rim of the level 40 cm above the table (40 % of its points nearer than 3 cm)"
        );
        assert_eq!(Reason::StandsOnTable.to_string(), "it stands on the table");
    }
}
