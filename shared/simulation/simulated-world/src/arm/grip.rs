//! Whether closed fingers hold an object.

use super::{Gripped, SimulatedArm};
use crate::physics::{BodyId, Physics};
use crate::world::{ObjectState, SceneObject};
use geometry::OrientedBox;
use nalgebra::{Point3, Vector3};
use std::fmt;

/// Points of a pad that are looked at, along and across.
const GRID: [usize; 2] = [9, 5];
/// A pad's point lies on the object when its surface is this near, metres.
const TOUCHING_M: f64 = 0.004;
/// Least share of a pad that must lie on the object.
const OVERLAP_MIN: f64 = 0.2;
/// Most that the surface under a pad may be turned away from it: the friction
/// cone of rubber with a coefficient of about 0.8, cosine.
const FACING_MIN: f64 = 0.78;

/// Why fingers that have closed hold nothing.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum GripFailure {
    /// They have met each other.
    Nothing,
    /// They touch different objects.
    Different,
    /// Too little of the pads lies on the object, share of the worse pad.
    Overlap(String, f64),
    /// The surfaces under the pads are slanted; the object slips.
    Slanted(String),
}

impl fmt::Display for GripFailure {
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

/// What a pad finds on an object.
struct PadContact {
    overlap: f64,
    facing: f64,
}

impl SimulatedArm {
    /// The bodies that both fingers touch: one that both do, or else one each.
    pub(super) fn touched_by_both(&self, physics: &Physics) -> Option<[BodyId; 2]> {
        let [.., first, second] = self.bodies.as_slice() else {
            return None;
        };
        let of_second: Vec<BodyId> = physics.touched_by(*second).collect();
        let mut either = None;
        for body in physics.touched_by(*first) {
            if of_second.contains(&body) {
                return Some([body; 2]);
            }
            either = either.or(Some([body, *of_second.first()?]));
        }
        either
    }

    /// Takes hold of what the fingers have closed on, or says why not.
    pub(super) fn try_to_hold(
        &mut self,
        touched: Option<[BodyId; 2]>,
        physics: &mut Physics,
        objects: &mut [SceneObject],
    ) {
        if let Err(failure) = self.hold(touched, physics, objects) {
            self.failure = Some(failure.to_string());
        }
    }

    fn hold(
        &mut self,
        touched: Option<[BodyId; 2]>,
        physics: &mut Physics,
        objects: &mut [SceneObject],
    ) -> Result<(), GripFailure> {
        let [first, second] = touched.ok_or(GripFailure::Nothing)?;
        let same = |object: &&mut SceneObject| object.body == first && first == second;
        let object = objects
            .iter_mut()
            .find(same)
            .ok_or(GripFailure::Different)?;
        let name = &object.model.name;
        let contacts = self.pad_contacts(first, physics);
        let overlap = contacts.iter().map(|c| c.overlap).fold(1.0, f64::min);
        if overlap < OVERLAP_MIN {
            return Err(GripFailure::Overlap(name.clone(), overlap));
        }
        if contacts.iter().any(|contact| contact.facing < FACING_MIN) {
            return Err(GripFailure::Slanted(name.clone()));
        }
        object.state = ObjectState::HeldByArm;
        physics.set_held(first, true);
        self.gripped = Some(Gripped {
            object: object.id,
            body: first,
            gripper_from_object: self.world_from_gripper().inv_mul(&physics.pose(first)),
        });
        Ok(())
    }

    fn pad_contacts(&self, body: BodyId, physics: &Physics) -> [PadContact; 2] {
        let pad = self.motion.arm().gripper().pad_in_finger();
        let [.., first, second] = self.poses();
        [first, second].map(|world_from_finger| {
            pad_contact(&pad.transformed(&world_from_finger), body, physics)
        })
    }

    /// Lets go of what is held.
    pub(super) fn release(&mut self, physics: &mut Physics, objects: &mut [SceneObject]) {
        let Some(gripped) = self.gripped.take() else {
            return;
        };
        physics.set_held(gripped.body, false);
        if let Some(object) = objects.iter_mut().find(|o| o.id == gripped.object) {
            object.state = ObjectState::Moving;
        }
    }
}

/// Looks along rays from the back of the pad through its face.
fn pad_contact(pad: &OrientedBox, body: BodyId, physics: &Physics) -> PadContact {
    // In a finger's frame x points into the pad, away from what is grasped.
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
            if let Some(normal) = physics.surface_along(body, &from, &inward, reach_m) {
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
