//! Grasp test of closed fingers: touching parts of the pads, and friction cone (Nguyen 1988).

use super::holding_law::{HoldingLaw, PadPatch};
use super::{GraspedObject, SimulatedArm};
use crate::physics::{BodyId, Physics};
use crate::scene_object::{ObjectState, SimulatedObject};
use arm_kinematics::FingerContact;
use geometry::OrientedBox;
use nalgebra::{Point3, Vector3};
use random::Random;
use std::fmt;

/// Number of ray samples on a pad, along and across. Chosen.
const GRID: [usize; 2] = [9, 5];
/// Greatest distance of the object's surface from a pad sample that touches it, metres. Chosen.
const TOUCHING_M: f64 = 0.004;
/// Stream of the random numbers of the friction.
const FRICTION_STREAM: u64 = 0x6672_6963;
/// Depth by which both pads give before they press with their whole force, metres. Chosen.
const PRESSED_M: f64 = 0.0008;
/// Distance behind the nearest place of the surface within which a pad touches it, metres. Chosen:
/// soft rubber.
const GIVING_M: f64 = 0.0015;
/// Speeds below which an object is at rest between the fingers, m/s and rad/s. Chosen.
const STILL_M_S: f64 = 0.004;
const STILL_RAD_S: f64 = 0.1;
/// Error of the normals of a patch, radians: those of an edge are a mean over both its sides. Chosen.
const NORMAL_ERROR_RAD: f64 = 0.1;
/// Least radius of a touching patch, metres: half of the distance of the samples.
const RADIUS_MIN_M: f64 = 0.002;

/// Grasp failure of closed fingers.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum GraspFailure {
    /// Fingers that met each other without an object.
    Nothing,
    /// Fingers that touch different objects.
    Different,
    /// Fingers that touch the named object beside a pad.
    BesidePad(String),
    /// Slanted surfaces under the pads, from which the named object slips.
    Slanted(String),
}

impl fmt::Display for GraspFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nothing => f.write_str("the fingers closed on nothing"),
            Self::Different => {
                f.write_str("the fingers closed on two different objects and hold neither")
            }
            Self::BesidePad(name) => write!(
                f,
                "the fingers closed on {name} beside their pads, which do not hold it"
            ),
            Self::Slanted(name) => write!(
                f,
                "the fingers closed on slanted sides of {name}, which slips out"
            ),
        }
    }
}

/// Contact of a pad with an object: touching places and mean outward normal of the surface.
struct PadContact {
    patch: PadPatch,
    normal: Vector3<f64>,
}

/// Friction coefficient between the pads and all objects of a scene, drawn by its seed: half of that
/// of the pads, for wet or dusty surfaces, to all of it.
pub(super) fn drawn_friction(pad_friction: f64, seed: u64) -> f64 {
    let share = Random::substream(seed, FRICTION_STREAM).unit();
    pad_friction * (0.5 + 0.5 * share)
}

impl SimulatedArm {
    /// Bodies that both fingers touch: twice the common one, or else one of each finger.
    pub(super) fn touched_by_both_fingers(&self, physics: &Physics) -> Option<[BodyId; 2]> {
        let [.., first, second] = self.bodies.as_slice() else {
            return None;
        };
        let of_second: Vec<BodyId> = physics.contacts_of(*second).collect();
        let mut either = None;
        for body in physics.contacts_of(*first) {
            if of_second.contains(&body) {
                return Some([body; 2]);
            }
            either = either.or(Some([body, *of_second.first()?]));
        }
        either
    }

    /// Contact of the fingers with the bodies that both touch.
    pub(super) fn finger_contact(
        &self,
        touched: Option<[BodyId; 2]>,
        physics: &Physics,
    ) -> FingerContact {
        let ([.., first, second], Some(touched)) = (self.bodies.as_slice(), touched) else {
            return FingerContact::Free;
        };
        let presses = |finger: BodyId, on: BodyId| {
            let mut pressed = physics.pressed_by(finger, PRESSED_M);
            pressed.any(|body| body == on)
        };
        let is_still = |body: BodyId| {
            let (linear, angular) = physics.velocity(body);
            linear.norm() < STILL_M_S && angular.norm() < STILL_RAD_S
        };
        if !(presses(*first, touched[0]) && presses(*second, touched[1])) {
            FingerContact::Touching
        } else if touched.into_iter().all(is_still) {
            FingerContact::Pressed
        } else {
            FingerContact::Pressing
        }
    }

    /// Tries to grasp the touched object and records the failure otherwise.
    pub(super) fn try_grasp(
        &mut self,
        touched: Option<[BodyId; 2]>,
        physics: &mut Physics,
        objects: &mut [SimulatedObject],
    ) {
        if let Err(failure) = self.grasp(touched, physics, objects) {
            self.failure = Some(failure.to_string());
        }
    }

    fn grasp(
        &mut self,
        touched: Option<[BodyId; 2]>,
        physics: &mut Physics,
        objects: &mut [SimulatedObject],
    ) -> Result<(), GraspFailure> {
        let [first, second] = touched.ok_or(GraspFailure::Nothing)?;
        let same = |object: &&mut SimulatedObject| object.body == first && first == second;
        let object = objects
            .iter_mut()
            .find(same)
            .ok_or(GraspFailure::Different)?;
        let name = &object.model.name;
        let beside = || GraspFailure::BesidePad(name.clone());
        let [right, left] = self.pad_contacts(first, physics);
        let contacts = [right.ok_or_else(beside)?, left.ok_or_else(beside)?];
        if self.is_squeezed_out(&contacts) {
            return Err(GraspFailure::Slanted(name.clone()));
        }
        object.state = ObjectState::HeldByArm;
        physics.set_held(first, true);
        let gripper_from_world = self.world_from_gripper().inverse();
        self.grasped = Some(GraspedObject {
            object: object.id,
            body: first,
            gripper_from_object: gripper_from_world * physics.pose(first),
            law: HoldingLaw {
                patches: contacts.map(|contact| PadPatch {
                    middle: gripper_from_world * contact.patch.middle,
                    ..contact.patch
                }),
                friction: self.friction,
                force_n: self.controller.arm().gripper().closing_force_n,
            },
            motion: None,
        });
        Ok(())
    }

    /// True if friction cannot balance the forces of both pads on slanted sides, which push the
    /// object out together. Their torque has turned it by now, until it came to rest.
    fn is_squeezed_out(&self, contacts: &[PadContact; 2]) -> bool {
        let line = contacts[0].patch.middle - contacts[1].patch.middle;
        let line = line.normalize();
        let push = contacts[0].normal + contacts[1].normal;
        let aside = (push - line * push.dot(&line)).norm();
        let facing = (contacts[0].normal - contacts[1].normal).dot(&line);
        let limit_rad = self.friction.atan() + NORMAL_ERROR_RAD;
        aside > facing * limit_rad.tan()
    }

    fn pad_contacts(&self, body: BodyId, physics: &Physics) -> [Option<PadContact>; 2] {
        let pad = self.controller.arm().gripper().pad_in_finger();
        let [.., first, second] = self.poses();
        [first, second].map(|world_from_finger| {
            pad_contact(&pad.transformed(&world_from_finger), body, physics)
        })
    }

    /// Releases the object in the gripper.
    pub(super) fn release(&mut self, physics: &mut Physics, objects: &mut [SimulatedObject]) {
        let Some(grasped) = self.grasped.take() else {
            return;
        };
        physics.set_held(grasped.body, false);
        if let Some(object) = objects.iter_mut().find(|o| o.id == grasped.object) {
            object.state = ObjectState::Moving;
        }
    }
}

/// Contact of a pad: casts rays from its back through its face. `None` where nothing touches it.
fn pad_contact(pad: &OrientedBox, body: BodyId, physics: &Physics) -> Option<PadContact> {
    // In the finger frame x points into the pad, away from the grasped object.
    let inward = pad.frame_from_box * -Vector3::x();
    let half = pad.half_sides_m;
    let reach_m = 2.0 * half.x + TOUCHING_M;
    let mut hits = Vec::new();
    for along in 0..GRID[0] {
        for across in 0..GRID[1] {
            let share = |i: usize, n: usize| (2 * i + 1) as f64 / n as f64 - 1.0;
            let back = Point3::new(
                half.x,
                half.y * share(across, GRID[1]),
                half.z * share(along, GRID[0]),
            );
            let from = pad.frame_from_box * back;
            if let Some((distance_m, normal)) =
                physics.surface_along_ray(body, &from, &inward, reach_m)
            {
                hits.push((distance_m, from + inward * distance_m, normal));
            }
        }
    }
    // The pad gives a little: what is not much farther than the nearest place touches it.
    let nearest_m = hits.iter().map(|hit| hit.0).fold(f64::INFINITY, f64::min);
    hits.retain(|hit| hit.0 < nearest_m + GIVING_M);
    let n = hits.len() as f64;
    let sum = hits
        .iter()
        .fold(Vector3::zeros(), |sum, hit| sum + hit.1.coords);
    let middle = Point3::from(sum / n);
    let distances = hits.iter().map(|hit| (hit.1 - middle).norm());
    let radius_m = (distances.sum::<f64>() / n).max(RADIUS_MIN_M);
    (n > 0.0).then_some(PadContact {
        patch: PadPatch { middle, radius_m },
        normal: hits
            .iter()
            .map(|hit| hit.2)
            .sum::<Vector3<f64>>()
            .normalize(),
    })
}
