//! Next move around an object: the way to the missing views.

use crate::growth::SEEN_COSINE;
use nalgebra::Vector3;
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

/// Move of the camera around the object, for a person who stands behind the camera.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct NextMove {
    /// Turn to the right around the object's vertical, degrees, -180 to 180.
    pub(crate) right_deg: f32,
    /// Change of the elevation, degrees.
    pub(crate) up_deg: f32,
}

impl NextMove {
    /// Move to the nearest place above the table that shows at least half as many of the missing
    /// directions as the best one; `None` where nothing is left to see. `direction` is the unit
    /// vector from the object to the camera; z is up.
    pub(crate) fn towards(unseen: &UnseenDirections, direction: &Vector3<f32>) -> Option<Self> {
        let missing = unseen.directions();
        let n_shown = |from: &Vector3<f32>| {
            let shown = missing.iter().filter(|d| d.dot(from) > SEEN_COSINE);
            shown.count()
        };
        let places = unseen.sphere().directions();
        let places = places.iter().filter(|d| ELEVATION_SINE.contains(&d.z));
        let places: Vec<(&Vector3<f32>, usize)> = places.map(|d| (d, n_shown(d))).collect();
        let most = places.iter().map(|(_, n)| *n).max()?;
        let enough = ((GOOD_SHARE * most as f32).ceil() as usize).max(N_SHOWN_MIN);
        let good = places.iter().filter(|(_, n)| *n >= enough);
        let (nearest, _) = good.max_by(|a, b| a.0.dot(direction).total_cmp(&b.0.dot(direction)))?;
        Some(Self::between(direction, nearest))
    }

    fn between(from: &Vector3<f32>, to: &Vector3<f32>) -> Self {
        let azimuth = |d: &Vector3<f32>| d.y.atan2(d.x).to_degrees();
        let elevation = |d: &Vector3<f32>| d.z.clamp(-1.0, 1.0).asin().to_degrees();
        // Counter-clockwise from above is to the right of a camera that looks at the centre.
        let right_deg = (azimuth(to) - azimuth(from) + 540.0).rem_euclid(360.0) - 180.0;
        Self {
            right_deg,
            up_deg: elevation(to) - elevation(from),
        }
    }

    /// Order, such as "move 60° to the left around the object and 20° higher".
    pub(crate) fn in_words(self) -> String {
        let part = |turn_deg: f32, plus: &str, minus: &str| {
            let rounded = (turn_deg.abs() / TURN_STEP_DEG).round() * TURN_STEP_DEG;
            let word = if turn_deg > 0.0 { plus } else { minus };
            (turn_deg.abs() >= TURN_MIN_DEG).then(|| format!("{rounded:.0}° {word}"))
        };
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
}

#[cfg(test)]
mod tests {
    use super::*;
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
        let onward = NextMove::towards(&unseen, seen.last().unwrap()).unwrap();
        assert!((10.0..90.0).contains(&onward.right_deg), "{onward:?}");
        let back = NextMove::towards(&unseen, &seen[0]).unwrap();
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
        let up = NextMove::towards(&seen_from(&seen), &seen[0]).unwrap();
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
        assert_eq!(NextMove::towards(&seen_from(&seen), &seen[0]), None);
    }

    #[test]
    fn turns_take_the_short_way() {
        let turn = NextMove::between(&direction(170.0, 30.0), &direction(-150.0, 30.0));
        assert!((turn.right_deg - 40.0).abs() < 1e-3, "{turn:?}");
        assert_eq!(turn.in_words(), "move 40° to the right around the object");
        let still = NextMove {
            right_deg: 4.0,
            up_deg: -3.0,
        };
        assert_eq!(still.in_words(), "stay here");
    }
}
