//! Grasp test: overlap of the pads with the object, and friction cone.

use super::{GraspedObject, SimulatedArm};
use crate::physics::{BodyId, Physics};
use crate::scene_object::{ObjectState, SimulatedObject};
use geometry::OrientedBox;
use nalgebra::{Point3, Vector3};
use std::fmt;

/// Number of ray samples on a pad, along and across. Chosen.
const GRID: [usize; 2] = [9, 5];
/// Greatest distance of the object's surface from a pad sample that touches it, metres. Chosen.
const TOUCHING_M: f64 = 0.004;
/// Least share of a pad's samples that must touch the object. Chosen.
const OVERLAP_MIN: f64 = 0.2;
/// Least mean cosine between pad and surface normals: the friction cone of rubber with a
/// coefficient of about 0.8.
const FACING_MIN: f64 = 0.78;

/// Grasp failure of closed fingers.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum GraspFailure {
    /// Fingers that met each other without an object.
    Nothing,
    /// Fingers that touch different objects.
    Different,
    /// Too little overlap of a pad with the named object; the smaller share of both pads.
    Overlap(String, f64),
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
            Self::Overlap(name, share) => write!(
                f,
                "the fingers closed on {name} with only {:.0} % of a pad, which does not hold it",
                share * 100.0
            ),
            Self::Slanted(name) => write!(
                f,
                "the fingers closed on slanted sides of {name}, which slips out"
            ),
        }
    }
}

/// Contact of a pad with an object: touching share and mean cosine.
struct PadContact {
    overlap: f64,
    facing: f64,
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
        let contacts = self.pad_contacts(first, physics);
        let overlap = contacts.iter().map(|c| c.overlap).fold(1.0, f64::min);
        if overlap < OVERLAP_MIN {
            return Err(GraspFailure::Overlap(name.clone(), overlap));
        }
        if contacts.iter().any(|contact| contact.facing < FACING_MIN) {
            return Err(GraspFailure::Slanted(name.clone()));
        }
        object.state = ObjectState::HeldByArm;
        physics.set_held(first, true);
        self.grasped = Some(GraspedObject {
            object: object.id,
            body: first,
            gripper_from_object: self.world_from_gripper().inv_mul(&physics.pose(first)),
        });
        Ok(())
    }

    fn pad_contacts(&self, body: BodyId, physics: &Physics) -> [PadContact; 2] {
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

/// Contact of a pad: casts rays from its back through its face.
fn pad_contact(pad: &OrientedBox, body: BodyId, physics: &Physics) -> PadContact {
    // In the finger frame x points into the pad, away from the grasped object.
    let inward = pad.frame_from_box * -Vector3::x();
    let half = pad.half_sides_m;
    let reach_m = 2.0 * half.x + TOUCHING_M;
    let (mut n_touching, mut facing) = (0, 0.0);
    for along in 0..GRID[0] {
        for across in 0..GRID[1] {
            let share = |i: usize, n: usize| (2 * i + 1) as f64 / n as f64 - 1.0;
            let from = pad.frame_from_box
                * Point3::new(
                    half.x,
                    half.y * share(across, GRID[1]),
                    half.z * share(along, GRID[0]),
                );
            if let Some(normal) = physics.surface_normal_along_ray(body, &from, &inward, reach_m) {
                n_touching += 1;
                facing += -normal.dot(&inward);
            }
        }
    }
    PadContact {
        overlap: f64::from(n_touching) / (GRID[0] * GRID[1]) as f64,
        facing: if n_touching > 0 {
            facing / f64::from(n_touching)
        } else {
            0.0
        },
    }
}
