//! Directions from which a surface was never seen, and their description in words.

use crate::direction_sphere::DirectionSphere;
use nalgebra::Vector3;

/// Elevation above which a direction belongs to the top, and below whose negative to the
/// underside, as the sine of the angle. Chosen: 45°.
const TOP_SINE: f32 = std::f32::consts::FRAC_1_SQRT_2;
/// Number of sectors of the sides. Chosen: each has some directions of every sphere.
const N_SECTORS: usize = 8;
/// Width of a sector, degrees.
const SECTOR_DEG: usize = 360 / N_SECTORS;

/// Directions of a sphere from which the surface was never seen. A direction points from the object
/// to the eye, in the frame of the object.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnseenDirections {
    sphere: DirectionSphere,
    /// True for the unseen ones of the sphere's directions, in its order.
    is_unseen: Vec<bool>,
}

impl UnseenDirections {
    /// Directions of a sphere for which `is_unseen` holds; it gets a unit vector.
    pub fn of(sphere: DirectionSphere, is_unseen: impl FnMut(&Vector3<f32>) -> bool) -> Self {
        Self {
            sphere,
            is_unseen: sphere.directions().iter().map(is_unseen).collect(),
        }
    }

    /// Sphere of the directions.
    pub fn sphere(&self) -> DirectionSphere {
        self.sphere
    }

    /// Unit vectors of the unseen directions.
    pub fn directions(&self) -> Vec<Vector3<f32>> {
        let all = self.sphere.directions().into_iter().zip(&self.is_unseen);
        all.filter(|(_, is_unseen)| **is_unseen)
            .map(|(direction, _)| direction)
            .collect()
    }

    /// Number of unseen directions.
    pub fn n_unseen(&self) -> usize {
        self.is_unseen.iter().filter(|unseen| **unseen).count()
    }

    /// Share of the directions from which the surface was seen, 0 to 1.
    pub fn completeness(&self) -> f64 {
        1.0 - self.n_unseen() as f64 / self.sphere.n_directions() as f64
    }

    /// Description of the unseen directions as phrases, such as "the underside" and "the sides from
    /// 45° to 180°", counted from x towards y; empty when all were seen.
    pub fn in_words(&self) -> Vec<String> {
        let directions = self.sphere.directions();
        let all: Vec<_> = directions
            .iter()
            .zip(self.is_unseen.iter().copied())
            .collect();
        let share = |is_part: &dyn Fn(&Vector3<f32>) -> bool| {
            let part = all.iter().filter(|(direction, _)| is_part(direction));
            let (n_unseen, n) = part.fold((0, 0), |(unseen, n), (_, is_unseen)| {
                (unseen + usize::from(*is_unseen), n + 1)
            });
            n_unseen as f64 / f64::from(n.max(1))
        };
        let cap = |name: &str, share: f64| match share {
            0.0 => None,
            1.0 => Some(format!("the {name}")),
            _ => Some(format!("parts of the {name}")),
        };
        let underside = cap("underside", share(&|d| d.z < -TOP_SINE));
        let top = cap("top", share(&|d| d.z > TOP_SINE));
        let is_side = |d: &Vector3<f32>| d.z.abs() <= TOP_SINE;
        let of_sectors: [bool; N_SECTORS] =
            std::array::from_fn(|sector| share(&|d| is_side(d) && sector_of(d) == sector) > 0.5);
        let sides = match share(&is_side) {
            0.0 => Vec::new(),
            1.0 => vec!["all sides".to_owned()],
            _ => sides_in_words(of_sectors),
        };
        underside.into_iter().chain(sides).chain(top).collect()
    }
}

/// Sector of a direction around the vertical, counted from x towards y.
fn sector_of(direction: &Vector3<f32>) -> usize {
    let turn = direction
        .y
        .atan2(direction.x)
        .rem_euclid(std::f32::consts::TAU);
    (turn / std::f32::consts::TAU * N_SECTORS as f32) as usize % N_SECTORS
}

/// Phrases for the runs of unseen sectors.
fn sides_in_words(is_unseen: [bool; N_SECTORS]) -> Vec<String> {
    let at = |sector: usize| is_unseen[sector % N_SECTORS];
    let begins = (0..N_SECTORS).filter(|&sector| at(sector) && !at(sector + N_SECTORS - 1));
    let runs: Vec<_> = begins
        .map(|begin| {
            let length = (0..N_SECTORS).take_while(|&i| at(begin + i)).count();
            let end_deg = (begin + length) * SECTOR_DEG;
            let end_deg = if end_deg > 360 {
                end_deg - 360
            } else {
                end_deg
            };
            format!("the sides from {}° to {end_deg}°", begin * SECTOR_DEG)
        })
        .collect();
    match runs.is_empty() {
        // All sectors are mostly unseen, or none is.
        true if at(0) => vec!["most of the sides".to_owned()],
        true => vec!["parts of the sides".to_owned()],
        false => runs,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use DirectionSphere::{Icosphere42, Icosphere162};

    fn words(is_unseen: impl Fn(&Vector3<f32>) -> bool) -> Vec<String> {
        UnseenDirections::of(Icosphere162, is_unseen).in_words()
    }

    fn turn_deg(d: &Vector3<f32>) -> f32 {
        d.y.atan2(d.x).to_degrees().rem_euclid(360.0)
    }

    #[test]
    fn missing_parts_are_named() {
        assert_eq!(words(|_| false), [""; 0]);
        assert_eq!(words(|_| true), ["the underside", "all sides", "the top"]);
        assert_eq!(words(|d| d.z < -0.75), ["the underside"]);
        assert_eq!(words(|d| d.z > 0.75), ["the top"]);
        assert_eq!(
            words(|d| d.z < -0.75 && d.x > 0.0),
            ["parts of the underside"]
        );
        let is_side = |d: &Vector3<f32>| d.z.abs() < 0.7;
        assert_eq!(
            words(|d| is_side(d) && d.y > 0.0),
            ["the sides from 0° to 180°"]
        );
        let back = |d: &Vector3<f32>| !(90.0..270.0).contains(&turn_deg(d));
        assert_eq!(
            words(|d| is_side(d) && back(d)),
            ["the sides from 270° to 90°"]
        );
    }

    /// A coarse sphere rounds the ends of the sides, which have some directions in each sector.
    #[test]
    fn coarse_sphere_names_the_same_parts() {
        let words = |is_unseen: fn(&Vector3<f32>) -> bool| {
            UnseenDirections::of(Icosphere42, is_unseen).in_words()
        };
        assert_eq!(words(|_| true), ["the underside", "all sides", "the top"]);
        assert_eq!(words(|d| d.z < -0.75), ["the underside"]);
        assert_eq!(
            words(|d| d.z.abs() < 0.7 && d.y > 0.0),
            ["the sides from 45° to 180°"]
        );
        for sector in 0..N_SECTORS {
            let directions = Icosphere42.directions();
            let is_in = |d: &&Vector3<f32>| d.z.abs() <= TOP_SINE && sector_of(d) == sector;
            assert!(directions.iter().filter(is_in).count() >= 2, "{sector}");
        }
    }

    #[test]
    fn separate_sides_are_named_apart() {
        let unseen = UnseenDirections::of(Icosphere162, |d| {
            let turn = turn_deg(d);
            d.z.abs() < 0.7 && ((40.0..95.0).contains(&turn) || (265.0..359.9).contains(&turn))
        });
        assert_eq!(
            unseen.in_words(),
            ["the sides from 45° to 90°", "the sides from 270° to 360°"]
        );
        let one = UnseenDirections::of(Icosphere162, |d| d.x > 0.999);
        assert_eq!(one.n_unseen(), 1);
        assert_eq!(one.in_words(), ["parts of the sides"]);
    }

    #[test]
    fn completeness_is_the_share_of_seen_directions() {
        for sphere in [Icosphere42, Icosphere162] {
            let share = |is_unseen: fn(&Vector3<f32>) -> bool| {
                UnseenDirections::of(sphere, is_unseen).completeness()
            };
            assert!((share(|_| false) - 1.0).abs() < 1e-12);
            assert!(share(|_| true).abs() < 1e-12);
            let half = share(|d| d.z < 0.0);
            assert!((0.5..0.7).contains(&half), "{half}");
        }
        let unseen = UnseenDirections::of(Icosphere42, |d| d.z < 0.0);
        let directions = unseen.directions();
        assert_eq!(directions.len(), unseen.n_unseen());
        assert!(directions.iter().all(|direction| direction.z < 0.0));
    }
}
