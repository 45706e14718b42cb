//! Fit of the hand to an object: opening, contact and friction of the pads at a tool pose.

use crate::contact_point::{ContactEvidence, ContactPoint};
use crate::hand_boxes::hand_boxes;
use crate::rejection::Rejection;
use arm_kinematics::GripperModel;
use geometry::RigidTransform;
use nalgebra::Point3;

/// Clearances between an open finger and the object that are tried, metres, the safest first.
const CLEARANCES_M: [f64; 4] = [CLEARANCE_MAX_M, 0.014, 0.008, 0.004];
/// Greatest clearance between an open finger and the object, metres.
pub(crate) const CLEARANCE_MAX_M: f64 = 0.022;
/// Depth below the first contact within which a pad touches, metres: it yields, and the camera has
/// noise.
const PATCH_M: f64 = 0.004;
/// Cosine from which on a surface counts as one that the pad presses on: others, such as the top of a
/// flat thing, end at the contact.
const FACING_COUNTED: f64 = 0.5;
/// Weight of a point of the contour in the mean of the normals, over one of the surface.
const CONTOUR_WEIGHT: f64 = 4.0;
/// Number of points beyond which the surface of an object begins: fewer are noise.
const N_OUTLIERS: usize = 2;
/// Cells of a pad, along and across.
const PAD_CELLS: [usize; 2] = [6, 4];
/// Least share of a pad's cells that must touch.
const OVERLAP_MIN: f64 = 0.04;
/// Number of the object's points in a finger or the palm from which on it is hit: fewer are noise.
const N_HIT: usize = 2;

/// Contact points of an object in the frame of a tool.
#[derive(Debug, Default)]
pub(crate) struct ContactsInTool {
    /// Contacts between or beside the pads.
    at_pads: Vec<PadContact>,
    /// Places that the hand may hit.
    near_hand: Vec<[f32; 3]>,
}

/// Fit of the hand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct HandFit {
    /// Shift of the tool along its closing direction after which both pads touch at once, metres.
    pub(crate) shift_m: f64,
    /// Opening before the grasp, metres.
    pub(crate) opening_m: f64,
    /// Distance between the pads when they touch, metres.
    pub(crate) width_m: f64,
    /// Touching share of the pad that touches less, 0 to 1.
    pub(crate) overlap: f64,
    /// Mean cosine between normals and pad, of the worse pad.
    pub(crate) facing: f64,
    /// Middle of what the pads touch, y and z of the tool, metres: zero for centred pads.
    pub(crate) middle_m: [f64; 2],
}

/// Contact point in single precision: thousands are moved into the frame of each tool pose.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PackedContact {
    position: [f32; 3],
    normal: [f32; 3],
    is_contour: bool,
}

impl From<&ContactPoint> for PackedContact {
    fn from(contact: &ContactPoint) -> Self {
        Self {
            position: contact.position.coords.cast::<f32>().into(),
            normal: contact.normal.cast::<f32>().into(),
            is_contour: contact.evidence == ContactEvidence::Contour,
        }
    }
}

#[inline]
fn dot(a: &[f32; 3], b: &[f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Contact point in the frame of the tool.
#[derive(Debug, Clone, Copy)]
struct PadContact {
    place: Point3<f64>,
    /// Normal along the closing direction.
    normal_x: f64,
    is_contour: bool,
}

/// Contact of one pad.
struct PadPatch {
    overlap: f64,
    facing: f64,
    middle_m: [f64; 2],
}

impl ContactsInTool {
    /// Fills in the contacts of an object for a tool pose.
    pub(crate) fn fill(
        &mut self,
        contacts: &[PackedContact],
        plan_from_tool: &RigidTransform,
        gripper: &GripperModel,
    ) {
        let tool_from_plan = plan_from_tool.inverse();
        let rotation = tool_from_plan.rotation.to_rotation_matrix();
        let offset = tool_from_plan.translation.vector.cast::<f32>();
        let row = |i: usize| -> [f32; 3] { rotation.matrix().row(i).transpose().cast().into() };
        let (closing, across, forward) = (row(0), row(1), row(2));
        let boxes = hand_boxes(gripper, 0.0);
        let half_width_m = boxes.iter().map(|body| body.half_sides_m.y);
        let half_width_m = half_width_m.fold(0.0, f64::max) as f32;
        let tip_m = 0.5 * gripper.pad_length_m as f32;
        let half_pad_m = 0.5 * gripper.pad_width_m as f32;
        self.at_pads.clear();
        self.near_hand.clear();
        for contact in contacts {
            let y = dot(&across, &contact.position) + offset.y;
            if y.abs() > half_width_m {
                continue;
            }
            let z = dot(&forward, &contact.position) + offset.z;
            if z > tip_m {
                continue;
            }
            let x = dot(&closing, &contact.position) + offset.x;
            self.near_hand.push([x, y, z]);
            if y.abs() <= half_pad_m && z >= -tip_m {
                self.at_pads.push(PadContact {
                    place: Point3::new(x, y, z).cast(),
                    normal_x: dot(&closing, &contact.normal).into(),
                    is_contour: contact.is_contour,
                });
            }
        }
    }

    /// Fits the hand around a pair of contacts whose distance is known. The pads close on what is
    /// between them, wherever it first touches.
    pub(crate) fn fit(
        &self,
        gripper: &GripperModel,
        pair_width_m: f64,
        facing_min: f64,
    ) -> Result<HandFit, Rejection> {
        let mut reason = Rejection::HitsObject;
        for clearance_m in CLEARANCES_M {
            let half_m = 0.5 * pair_width_m + clearance_m;
            let Some([low_m, high_m]) = self.between_pads(half_m) else {
                return Err(Rejection::LittleContact);
            };
            let width_m = high_m - low_m;
            let opening_m = (width_m + 2.0 * clearance_m).min(gripper.max_opening_m);
            if width_m + CLEARANCES_M[3] > gripper.max_opening_m {
                return Err(Rejection::TooWide {
                    width_m,
                    limit_m: gripper.max_opening_m - CLEARANCES_M[3],
                });
            }
            let shift_m = 0.5 * (low_m + high_m);
            if self.hits_hand(gripper, opening_m, shift_m) {
                continue;
            }
            let patches = [
                self.patch(gripper, low_m, -1.0),
                self.patch(gripper, high_m, 1.0),
            ];
            let overlap = patches[0].overlap.min(patches[1].overlap);
            let facing = patches[0].facing.min(patches[1].facing);
            if facing < facing_min {
                reason = Rejection::Slips;
                continue;
            }
            if overlap < OVERLAP_MIN {
                reason = Rejection::LittleContact;
                continue;
            }
            return Ok(HandFit {
                shift_m,
                opening_m,
                width_m,
                overlap,
                facing,
                middle_m: [0, 1].map(|i| patches[0].middle_m[i].midpoint(patches[1].middle_m[i])),
            });
        }
        Err(reason)
    }

    /// Least and greatest coordinate along the closing direction of what is between the open pads.
    pub(crate) fn extent(&self, gripper: &GripperModel) -> Option<[f64; 2]> {
        self.between_pads(0.5 * gripper.max_opening_m)
    }

    /// Least and greatest coordinate along the closing direction of what is between the pads;
    /// `None` without anything.
    fn between_pads(&self, half_m: f64) -> Option<[f64; 2]> {
        // The outermost points, ascending towards the middle.
        let mut ends_m = [[f64::INFINITY; N_OUTLIERS + 1]; 2];
        for PadContact { place, .. } in &self.at_pads {
            if place.x.abs() <= half_m {
                insert(&mut ends_m[0], place.x);
                insert(&mut ends_m[1], -place.x);
            }
        }
        let [low_m, high_m] = ends_m.map(|ends| ends[N_OUTLIERS]);
        (low_m < -high_m).then_some([low_m, -high_m])
    }

    /// True if the object reaches into a finger, the palm or the hand.
    fn hits_hand(&self, gripper: &GripperModel, opening_m: f64, shift_m: f64) -> bool {
        let [finger, _, rail, hand] = hand_boxes(gripper, opening_m);
        let (inner_m, outer_m) = (
            finger.centre().x - finger.half_sides_m.x,
            finger.centre().x + finger.half_sides_m.x,
        );
        let rail_back_m = rail.centre().z - rail.half_sides_m.z;
        let mut n_hit = 0;
        for [x, y, z] in &self.near_hand {
            let (beside_m, across_m) = ((f64::from(*x) - shift_m).abs(), f64::from(y.abs()));
            let z = f64::from(*z);
            let is_hit = if z > -gripper.palm_m {
                (inner_m..outer_m).contains(&beside_m) && across_m < finger.half_sides_m.y
            } else if z > rail_back_m {
                beside_m < rail.half_sides_m.x && across_m < rail.half_sides_m.y
            } else {
                beside_m < hand.half_sides_m.x && across_m < hand.half_sides_m.y
            };
            n_hit += usize::from(is_hit);
        }
        n_hit >= N_HIT
    }

    /// Contact of the pad whose face is at `at_m` along `side`.
    fn patch(&self, gripper: &GripperModel, at_m: f64, side: f64) -> PadPatch {
        let mut is_touched = [[false; PAD_CELLS[1]]; PAD_CELLS[0]];
        let (mut weights, mut facing, mut sum_m) = (0.0_f64, 0.0, [0.0; 2]);
        for contact in &self.at_pads {
            let place = &contact.place;
            let below_m = side * (at_m - place.x);
            // Beyond the pad is the other part of an object whose rim is grasped.
            if !(-PATCH_M..=PATCH_M).contains(&below_m) {
                continue;
            }
            let cosine = side * contact.normal_x;
            if cosine < FACING_COUNTED {
                continue;
            }
            let cell = |along_m: f64, length_m: f64, n: usize| {
                let share = along_m / length_m + 0.5;
                ((share * n as f64) as usize).min(n - 1)
            };
            let along = cell(place.z, gripper.pad_length_m, PAD_CELLS[0]);
            let across = cell(place.y, gripper.pad_width_m, PAD_CELLS[1]);
            is_touched[along][across] = true;
            // The pad presses least on what it only just touches, and a normal of the contour does
            // not mix the faces that meet there.
            let weight = 1.0 - 0.9 * below_m.max(0.0) / PATCH_M;
            let weight = weight
                * if contact.is_contour {
                    CONTOUR_WEIGHT
                } else {
                    1.0
                };
            weights += weight;
            facing += weight * cosine;
            sum_m = [sum_m[0] + weight * place.y, sum_m[1] + weight * place.z];
        }
        let n_touched = is_touched.iter().flatten().filter(|is| **is).count();
        let overlap = n_touched as f64 / (PAD_CELLS[0] * PAD_CELLS[1]) as f64;
        PadPatch {
            overlap,
            facing: facing / weights.max(0.1),
            middle_m: sum_m.map(|sum_m| sum_m / weights.max(0.1)),
        }
    }
}

/// Keeps the least values in ascending order.
fn insert(least: &mut [f64], value: f64) {
    // Most values are not among the least.
    if least.last().is_none_or(|last| value >= *last) {
        return;
    }
    let at = least.partition_point(|known| *known <= value);
    if let Some(rest) = least.get_mut(at..) {
        rest.rotate_right(1.min(rest.len()));
        if let Some(first) = rest.first_mut() {
            *first = value;
        }
    }
}
