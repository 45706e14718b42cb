//! Body of the simulated person: capsules posed from the hand position.

use geometry::Capsule;
use nalgebra::{Point3, Vector3};

/// Resting position of the hand, world frame, metres: next to the body, above the camera's view.
/// Chosen.
pub(crate) const RESTING_HAND: Point3<f64> = Point3::new(0.30, 0.72, 1.05);

/// Hip joint of the resting body, world frame, metres. Chosen, as are the other body dimensions.
const HIP: Point3<f64> = Point3::new(0.05, 0.92, 0.55);
/// Neck of the resting body, world frame, metres.
const NECK: Point3<f64> = Point3::new(0.05, 0.88, 1.38);
/// Right shoulder of the resting body, world frame, metres.
const SHOULDER: Point3<f64> = Point3::new(0.24, 0.86, 1.34);
/// Length of the upper arm, metres.
const UPPER_ARM_M: f64 = 0.31;
/// Length of the forearm, metres.
const FOREARM_M: f64 = 0.27;
/// Radius of the torso, metres.
const TORSO_RADIUS_M: f64 = 0.20;
/// Radius of both legs together, metres.
const LEGS_RADIUS_M: f64 = 0.20;
/// Radius of the head, metres.
const HEAD_RADIUS_M: f64 = 0.11;
/// Radius of the upper arm, metres.
const UPPER_ARM_RADIUS_M: f64 = 0.055;
/// Radius of the forearm, metres.
const FOREARM_RADIUS_M: f64 = 0.045;
/// Radius of the hand, metres.
const HAND_RADIUS_M: f64 = 0.065;
/// Distance from the wrist to the middle of the hand, metres.
const HAND_M: f64 = 0.09;
/// Distance from the wrist to the fingertips less the hand's radius, metres.
const FINGERS_M: f64 = 0.14;

/// Number of capsules of a body.
pub(crate) const N_CAPSULES: usize = 6;

/// Capsules of the person's body, world frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PersonBody {
    /// Torso, head, upper arm, forearm, hand, legs.
    pub(crate) capsules: [Capsule; N_CAPSULES],
}

impl PersonBody {
    /// Body of a person whose hand is at `hand`. The person leans towards a hand that is out of
    /// reach.
    pub(crate) fn reaching(hand: Point3<f64>) -> Self {
        let wrist_from = |shoulder: Point3<f64>| hand - (hand - shoulder).normalize() * HAND_M;
        let reach = (UPPER_ARM_M + FOREARM_M) * 0.97;
        let away = hand - SHOULDER;
        let lean = away.normalize() * (away.norm() - HAND_M - reach).max(0.0);
        let (shoulder, neck) = (SHOULDER + lean, NECK + lean);
        let wrist = wrist_from(shoulder);
        let elbow = elbow(shoulder, wrist);
        let head = neck + Vector3::new(0.0, -0.03, 0.22);
        let capsule = |from, to, radius_m| Capsule { from, to, radius_m };
        Self {
            capsules: [
                capsule(
                    HIP,
                    neck - Vector3::new(0.0, 0.0, TORSO_RADIUS_M),
                    TORSO_RADIUS_M,
                ),
                capsule(head, head, HEAD_RADIUS_M),
                capsule(shoulder, elbow, UPPER_ARM_RADIUS_M),
                capsule(elbow, wrist, FOREARM_RADIUS_M),
                capsule(
                    wrist,
                    wrist + (hand - wrist).normalize() * FINGERS_M,
                    HAND_RADIUS_M,
                ),
                capsule(Point3::new(HIP.x, HIP.y, 0.0), HIP, LEGS_RADIUS_M),
            ],
        }
    }
}

/// Two-link inverse kinematics: elbow between shoulder and wrist, pointing outward and down.
fn elbow(shoulder: Point3<f64>, wrist: Point3<f64>) -> Point3<f64> {
    let across = wrist - shoulder;
    let distance = across.norm().max(1e-6);
    let axis = across / distance;
    let (a, b) = (UPPER_ARM_M, FOREARM_M);
    let along = ((a * a - b * b + distance * distance) / (2.0 * distance)).clamp(-a, a);
    let aside = (a * a - along * along).max(0.0).sqrt();
    let outward = Vector3::new(0.8, 0.1, -0.6);
    let side = outward - axis * outward.dot(&axis);
    shoulder + axis * along + side.normalize() * aside
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limb_lengths_are_constant_and_the_arm_reaches_the_hand() {
        for hand in [
            RESTING_HAND,
            Point3::new(-0.4, -0.3, 0.8),
            Point3::new(0.5, 0.3, 0.75),
            Point3::new(0.24, 0.86, 1.30),
        ] {
            let [_, _, upper, forearm, palm, _] = PersonBody::reaching(hand).capsules;
            assert!(
                ((upper.to - upper.from).norm() - UPPER_ARM_M).abs() < 0.02,
                "{hand}"
            );
            assert!(
                (forearm.to - forearm.from).norm() < FOREARM_M + 0.12,
                "{hand}"
            );
            assert_eq!(upper.to, forearm.from);
            assert_eq!(forearm.to, palm.from);
            assert!(
                Capsule {
                    radius_m: 0.0,
                    ..palm
                }
                .distance_m(&hand)
                    < 1e-9
            );
        }
    }
}
