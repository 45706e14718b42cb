//! Next move around an object, or of it before a camera that stands still: the way to the missing
//! views.

use crate::camera_motion::Mover;
use crate::growth::SEEN_COSINE;
use nalgebra::{Rotation3, Vector3};
use object_model::UnseenDirections;
use serde::Serialize;

/// Elevations of a camera that sees an object on a table, as the sine: 10° to 80°. Chosen: a lower
/// one sees the table's edge, a higher one has no way to turn.
const ELEVATION_SINE: std::ops::RangeInclusive<f32> = 0.17..=0.985;
/// Share of the missing directions that the best place shows, from which a nearer one is good, too.
/// Chosen.
const GOOD_SHARE: f32 = 0.5;
/// Number of missing directions that a move must show. Chosen: fewer are borders of what was seen.
const N_SHOWN_MIN: usize = 3;
/// Turn that is not worth a word, degrees.
const TURN_MIN_DEG: f32 = 10.0;
/// Step to which turns are rounded, degrees.
const TURN_STEP_DEG: f32 = 10.0;
/// Turn of the object between two views that can be compared, degrees.
const OBJECT_TURN_DEG: f32 = 30.0;

/// Move of the camera around the object, for a person who stands behind the camera; or the turn of
/// the object that shows the same.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct NextMove {
    /// Thing to move.
    pub(crate) by: Mover,
    /// Turn to the right around the object's vertical, degrees, -180 to 180.
    pub(crate) right_deg: f32,
    /// Change of the elevation, degrees.
    pub(crate) up_deg: f32,
}

impl NextMove {
    /// Move to the nearest place above the table that shows at least half as many of the missing
    /// directions as the best one; `None` where nothing is left to see. `direction` is the unit
    /// vector from the object to the camera; z is up. An object that turns shows the places at the
    /// elevation of the camera.
    pub(crate) fn towards(
        unseen: &UnseenDirections,
        direction: &Vector3<f32>,
        by: Mover,
    ) -> Option<Self> {
        let missing = unseen.directions();
        let n_shown = |from: &Vector3<f32>| {
            let shown = missing.iter().filter(|d| d.dot(from) > SEEN_COSINE);
            shown.count()
        };
        let places = match by {
            Mover::Object => ring_at(direction),
            Mover::Camera | Mover::Either => {
                let all = unseen.sphere().directions();
                let above = all.iter().filter(|d| ELEVATION_SINE.contains(&d.z));
                above.copied().collect()
            }
        };
        let places: Vec<(&Vector3<f32>, usize)> = places.iter().map(|d| (d, n_shown(d))).collect();
        let most = places.iter().map(|(_, n)| *n).max()?;
        let enough = ((GOOD_SHARE * most as f32).ceil() as usize).max(N_SHOWN_MIN);
        let good = places.iter().filter(|(_, n)| *n >= enough);
        let (nearest, _) = good.max_by(|a, b| a.0.dot(direction).total_cmp(&b.0.dot(direction)))?;
        Some(Self::between(direction, nearest, by))
    }

    fn between(from: &Vector3<f32>, to: &Vector3<f32>, by: Mover) -> Self {
        let azimuth = |d: &Vector3<f32>| d.y.atan2(d.x).to_degrees();
        let elevation = |d: &Vector3<f32>| d.z.clamp(-1.0, 1.0).asin().to_degrees();
        // Counter-clockwise from above is to the right of a camera that looks at the centre.
        let right_deg = (azimuth(to) - azimuth(from) + 540.0).rem_euclid(360.0) - 180.0;
        Self {
            by,
            right_deg,
            up_deg: elevation(to) - elevation(from),
        }
    }

    /// Order, such as "move 60° to the left around the object and 20° higher".
    pub(crate) fn in_words(self) -> String {
        match self.by {
            Mover::Camera => self.camera_move(),
            Mover::Object => self
                .object_turn()
                .unwrap_or_else(|| "leave the object as it stands".to_owned()),
            Mover::Either => match self.object_turn() {
                Some(turn) => format!("{}, or {turn}", self.camera_move()),
                None => self.camera_move(),
            },
        }
    }

    fn camera_move(self) -> String {
        let around = part(
            self.right_deg,
            "to the right around the object",
            "to the left around the object",
        );
        let up = part(self.up_deg, "higher", "lower");
        let parts: Vec<String> = around.into_iter().chain(up).collect();
        if parts.is_empty() {
            return "stay here".to_owned();
        }
        format!("move {}", parts.join(" and "))
    }

    /// Turn of the object that shows the camera what it would see on its way; `None` for a turn
    /// that is not worth a word.
    fn object_turn(self) -> Option<String> {
        let turn = part(self.right_deg, "clockwise", "counter-clockwise")?;
        let steps = if self.right_deg.abs() > OBJECT_TURN_DEG + TURN_STEP_DEG / 2.0 {
            format!(", some {OBJECT_TURN_DEG:.0}° at a time")
        } else {
            String::new()
        };
        Some(format!("turn the object {turn} as seen from above{steps}"))
    }
}

/// Rounded turn with its direction; `None` for one that is not worth a word.
fn part(turn_deg: f32, plus: &str, minus: &str) -> Option<String> {
    let rounded = (turn_deg.abs() / TURN_STEP_DEG).round() * TURN_STEP_DEG;
    let word = if turn_deg > 0.0 { plus } else { minus };
    (turn_deg.abs() >= TURN_MIN_DEG).then(|| format!("{rounded:.0}° {word}"))
}

/// Directions of the elevation of a direction, all around the vertical.
fn ring_at(direction: &Vector3<f32>) -> Vec<Vector3<f32>> {
    let turn = |i: i16| {
        let angle_rad = (f32::from(i) * TURN_STEP_DEG).to_radians();
        Rotation3::from_axis_angle(&Vector3::z_axis(), angle_rad) * direction
    };
    (0..(360.0 / TURN_STEP_DEG) as i16).map(turn).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use Mover::{Camera, Either, Object};
    use object_model::DirectionSphere::Icosphere162;

    fn direction(azimuth_deg: f32, elevation_deg: f32) -> Vector3<f32> {
        let (azimuth, elevation) = (azimuth_deg.to_radians(), elevation_deg.to_radians());
        let level = elevation.cos();
        Vector3::new(
            level * azimuth.cos(),
            level * azimuth.sin(),
            elevation.sin(),
        )
    }

    fn seen_from(seen: &[Vector3<f32>]) -> UnseenDirections {
        UnseenDirections::of(Icosphere162, |d| {
            !seen.iter().any(|s| s.dot(d) > SEEN_COSINE)
        })
    }

    #[test]
    fn move_leads_to_the_missing_side() {
        let seen: Vec<_> = (0..10).map(|i| direction(20.0 * i as f32, 35.0)).collect();
        let unseen = seen_from(&seen);
        let onward = NextMove::towards(&unseen, seen.last().unwrap(), Camera).unwrap();
        assert!((10.0..90.0).contains(&onward.right_deg), "{onward:?}");
        let back = NextMove::towards(&unseen, &seen[0], Camera).unwrap();
        assert!((-90.0..-10.0).contains(&back.right_deg), "{back:?}");
        assert!(
            back.in_words().contains("to the left"),
            "{}",
            back.in_words()
        );
    }

    #[test]
    fn low_ring_leaves_the_top() {
        let seen: Vec<_> = (0..36).map(|i| direction(10.0 * i as f32, 15.0)).collect();
        let up = NextMove::towards(&seen_from(&seen), &seen[0], Camera).unwrap();
        assert!(up.up_deg > 20.0, "{up:?}");
        assert!(up.in_words().contains("higher"), "{}", up.in_words());
    }

    #[test]
    fn no_move_when_only_the_underside_is_missing() {
        let rings = [0.0, 25.0, 50.0, 85.0];
        let seen = rings
            .iter()
            .flat_map(|&elevation| (0..36).map(move |i| direction(10.0 * i as f32, elevation)));
        let seen: Vec<_> = seen.collect();
        let unseen = seen_from(&seen);
        for by in [Camera, Object, Either] {
            assert_eq!(NextMove::towards(&unseen, &seen[0], by), None);
        }
    }

    #[test]
    fn turns_take_the_short_way() {
        let turn = NextMove::between(&direction(170.0, 30.0), &direction(-150.0, 30.0), Camera);
        assert!((turn.right_deg - 40.0).abs() < 1e-3, "{turn:?}");
        assert_eq!(turn.in_words(), "move 40° to the right around the object");
        let still = NextMove {
            by: Camera,
            right_deg: 4.0,
            up_deg: -3.0,
        };
        assert_eq!(still.in_words(), "stay here");
    }

    #[test]
    fn object_is_turned_before_a_camera_that_stands_still() {
        // Seen from azimuths 0° to 90°, at 15°: the camera would better go up.
        let seen: Vec<_> = (0..10).map(|i| direction(10.0 * i as f32, 15.0)).collect();
        let unseen = seen_from(&seen);
        let last = seen.last().unwrap();
        let turn = NextMove::towards(&unseen, last, Object).unwrap();
        assert!(turn.up_deg.abs() < 0.1 && turn.right_deg > 10.0, "{turn:?}");
        // The camera that would go to the right sees what the object shows when it turns to the
        // left, as seen by it: clockwise from above.
        let words = turn.in_words();
        assert!(words.starts_with("turn the object "), "{words}");
        assert!(words.contains("° clockwise as seen from above"), "{words}");
        assert!(!words.contains("move"), "{words}");
        let turned = |right_deg| NextMove {
            by: Object,
            right_deg,
            up_deg: 0.0,
        };
        for (right_deg, words) in [
            (
                -30.0,
                "turn the object 30° counter-clockwise as seen from above",
            ),
            (
                120.0,
                "turn the object 120° clockwise as seen from above, some 30° at a time",
            ),
            (3.0, "leave the object as it stands"),
        ] {
            assert_eq!(turned(right_deg).in_words(), words);
        }
    }

    #[test]
    fn camera_of_unknown_pose_or_its_object_is_moved() {
        let next = NextMove {
            by: Either,
            right_deg: 20.0,
            up_deg: 30.0,
        };
        assert_eq!(
            next.in_words(),
            "move 20° to the right around the object and 30° higher, or turn the object 20° \
             clockwise as seen from above"
        );
    }
}
