//! Holding law of two pads: soft-finger contacts with a limit surface of friction and torsion.
//!
//! A pad that presses with the force N holds a force f along its face and a torque t about its
//! normal as long as (f / μN)² + (t / μNr)² ≤ 1 (Howe and Cutkosky 1996); r is the mean distance of
//! the touching places from their middle, as for an even pressure (Lynch and Park 2017, 12.2). A
//! load beside the line between the pads bends the grasp: the pressure shifts within the pads as far
//! as they touch, and the rest is a couple of forces along both faces.

use nalgebra::{Point3, Vector3};

/// Least distance of the pads that counts as a lever, metres.
const LEVER_MIN_M: f64 = 0.001;

/// Touching part of a pad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PadPatch {
    /// Middle of the touching places.
    pub(super) middle: Point3<f64>,
    /// Mean distance of the touching places from the middle, metres.
    pub(super) radius_m: f64,
}

/// Two pads that press on an object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct HoldingLaw {
    pub(super) patches: [PadPatch; 2],
    /// Friction coefficient between pads and object.
    pub(super) friction: f64,
    /// Force with which each pad presses, newtons.
    pub(super) force_n: f64,
}

/// State of a held object under a load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Holding {
    /// It stays.
    Fast,
    /// It turns about the line between the pads, in the direction of this torque, newton metres.
    Turns(f64),
    /// It slides out.
    Slides,
}

impl HoldingLaw {
    /// Middle of both patches.
    pub(super) fn middle(&self) -> Point3<f64> {
        nalgebra::center(&self.patches[0].middle, &self.patches[1].middle)
    }

    /// Unit vector from the second patch to the first; zero where they are in one place.
    pub(super) fn axis(&self) -> Vector3<f64> {
        let across = self.patches[0].middle - self.patches[1].middle;
        across.try_normalize(1e-9).unwrap_or_else(Vector3::zeros)
    }

    /// State under a force, newtons, that the object exerts at a place, such as its weight at its
    /// centre of mass.
    pub(super) fn under(&self, load_n: &Vector3<f64>, at: &Point3<f64>) -> Holding {
        let axis = self.axis();
        let between = self.patches[0].middle - self.patches[1].middle;
        let moment = (at - self.middle()).cross(load_n);
        let torsion = moment.dot(&axis);
        let bending = (moment - axis * torsion).norm();
        let along_n = load_n.dot(&axis);
        let across_n = (load_n - axis * along_n).norm();
        // The load along the line takes from one pad what it gives to the other.
        let normal_n = self.force_n - 0.5 * along_n.abs();
        let hold_n = self.friction * normal_n;
        if hold_n <= 0.0 {
            return Holding::Slides;
        }
        let radius_m = 0.5 * (self.patches[0].radius_m + self.patches[1].radius_m);
        let couple = (bending - 2.0 * normal_n * radius_m).max(0.0);
        let along_face_n = 0.5 * across_n + couple / between.norm().max(LEVER_MIN_M);
        let slide = along_face_n / hold_n;
        if slide > 1.0 {
            return Holding::Slides;
        }
        let turn = 0.5 * torsion.abs() / (hold_n * radius_m).max(1e-9);
        if slide * slide + turn * turn > 1.0 {
            Holding::Turns(torsion)
        } else {
            Holding::Fast
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pads 4 cm apart along x, with patches of 8 mm.
    fn law(friction: f64) -> HoldingLaw {
        let patch = |x: f64| PadPatch {
            middle: Point3::new(x, 0.0, 0.0),
            radius_m: 0.008,
        };
        HoldingLaw {
            patches: [patch(0.02), patch(-0.02)],
            friction,
            force_n: 25.0,
        }
    }

    fn weight(mass_kg: f64) -> Vector3<f64> {
        Vector3::new(0.0, 0.0, -9.81 * mass_kg)
    }

    #[test]
    fn weight_on_the_line_is_held_up_to_the_friction_of_both_pads() {
        let middle = Point3::origin();
        let most_kg = 2.0 * 0.5 * 25.0 / 9.81;
        assert_eq!(
            law(0.5).under(&weight(0.99 * most_kg), &middle),
            Holding::Fast
        );
        assert_eq!(
            law(0.5).under(&weight(1.01 * most_kg), &middle),
            Holding::Slides
        );
    }

    #[test]
    fn weight_beside_the_line_turns_the_object_from_the_torque_of_the_patches_on() {
        // Torque of both pads without any slide: 2 μ N r.
        let lever_m = |mass_kg: f64| {
            let slide = 0.5 * 9.81 * mass_kg / (0.5 * 25.0);
            let torque = 2.0 * 0.5 * 25.0 * 0.008 * (1.0_f64 - slide * slide).sqrt();
            torque / (9.81 * mass_kg)
        };
        let at = |share: f64| Point3::new(0.0, share * lever_m(0.3), 0.0);
        assert_eq!(law(0.5).under(&weight(0.3), &at(0.99)), Holding::Fast);
        let turns = law(0.5).under(&weight(0.3), &at(1.01));
        assert!(
            matches!(turns, Holding::Turns(torque) if torque < 0.0),
            "{turns:?}"
        );
        let other = law(0.5).under(&weight(0.3), &at(-1.01));
        assert!(
            matches!(other, Holding::Turns(torque) if torque > 0.0),
            "{other:?}"
        );
    }

    #[test]
    fn load_along_the_line_and_bending_take_from_the_hold() {
        let middle = Point3::origin();
        let pull = |n: f64| Vector3::new(n, 0.0, 0.0);
        assert_eq!(law(0.5).under(&pull(49.0), &middle), Holding::Fast);
        assert_eq!(law(0.5).under(&pull(51.0), &middle), Holding::Slides);
        // A long lever along the line: a couple of forces on the faces.
        let far = Point3::new(0.25, 0.0, 0.0);
        assert_eq!(law(0.5).under(&weight(0.3), &far), Holding::Fast);
        assert_eq!(law(0.5).under(&weight(0.6), &far), Holding::Slides);
    }
}
