//! Planning of grasps: pairs of contacts, directions of approach, fit of the hand, collisions and
//! reach.

use crate::antipodal_pairs::{AntipodalPair, antipodal_pairs};
use crate::approach_directions::{approaches, levelled, tool_pose};
use crate::contact_point::ContactEvidence;
use crate::grasp_plan::{Grasp, GraspPlan, RejectedGrasp, ScoreFactors};
use crate::grasp_scene::GraspScene;
use crate::grasp_settings::GraspSettings;
use crate::hand_boxes::{closing_boxes, hand_boxes, lowest_m, swept_back};
use crate::hand_fit::{CLEARANCE_MAX_M, ContactsInTool, HandFit};
use crate::object_estimate::{ObjectEstimate, contact_surface};
use crate::obstacles::{Obstacle, Obstacles};
use crate::reach::{GraspWays, PlacedArm, reach};
use crate::rejection::{GraspPhase, Rejection};
use crate::squeeze_pairs::squeeze_pairs;
use crate::surroundings::{SURFACE_CLEARANCE_M, Surroundings};
use arm_kinematics::GripperModel;
use geometry::{OrientedBox, RigidTransform};
use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use std::f64::consts::PI;

/// Number of pairs to which hands are fitted.
const N_PAIRS: usize = 45;
/// Least cosine between pad and surface in a squeeze, and the friction that counts for it, before the
/// object has turned.
const SQUEEZE_FACING_MIN: f64 = 0.6;
const SQUEEZE_FRICTION: f64 = 0.16;
/// Share of the pads' friction that is relied on: a wet or dusty surface has less.
const RELIED_FRICTION: f64 = 0.7;
/// Distance of the centre of mass from the line between the pads at which the balance is 0.6,
/// metres. Chosen.
const LEVER_M: f64 = 0.05;
/// Distance of the middle of the contact from that of the pads at which the score is 0.6, metres.
const OFF_CENTRE_M: f64 = 0.012;
/// Number of times that a hand is moved towards the middle of its contact.
const N_CENTRINGS: usize = 2;
/// Touching share of the pads from which on the contact is full.
const OVERLAP_FULL: f64 = 0.7;
/// Acceleration against which the fingers hold by friction, m/s²: gravity and a brisk motion.
const HELD_M_S2: f64 = 9.81 + 2.0;
/// Least value of a factor, before a root is taken of it: one weak point alone forbids no grasp.
const FACTOR_MIN: f64 = 0.04;
/// Number of places on the way up at which the hand is tested.
const N_LIFT_STEPS: i32 = 3;
/// Number of rejected grasps that are kept.
const N_REJECTED_MAX: usize = 200;

/// Planner of the grasps of a scene.
#[derive(Clone, Copy)]
pub struct GraspPlanner<'a> {
    /// Scene.
    pub scene: &'a GraspScene<'a>,
    /// Obstacles of the scene.
    pub obstacles: &'a Obstacles,
    /// Gripper.
    pub gripper: &'a GripperModel,
    /// Arm; without one nothing is said about reach.
    pub arm: Option<&'a PlacedArm>,
    /// Settings.
    pub settings: &'a GraspSettings,
}

/// Grasp whose hand fits, before collisions and reach.
struct FittedGrasp {
    grasp: Grasp,
    fit: HandFit,
    pair: AntipodalPair,
    order: usize,
}

impl GraspPlanner<'_> {
    /// Plans the grasps of the object with an index in the scene.
    pub fn plan(&self, object: usize) -> GraspPlan {
        let estimate = ObjectEstimate::of(contact_surface(self.scene, object), self.settings);
        let surroundings =
            Surroundings::new(self.scene, self.obstacles, object, &estimate.contacts);
        let mut plan = GraspPlan::default();
        let heavy = self.too_heavy(estimate.mass_kg);
        let mut unfit = Vec::new();
        let fitted = self.fitted(&estimate, &surroundings, &mut unfit);
        let cover = surroundings.cover(&estimate.contacts);
        let mut in_tool = ContactsInTool::default();
        for fitted in fitted.into_iter().take(self.settings.n_tested_max) {
            let tested = match (cover, &heavy) {
                (Some(by), _) => Err(Rejection::Covered { by }),
                (None, Some(heavy)) => Err(heavy.clone()),
                (None, None) => {
                    let grasp = self.centred(&mut in_tool, &fitted, (&estimate, &surroundings));
                    self.tested(grasp, &surroundings)
                }
            };
            let plan_from_tool = fitted.grasp.plan_from_tool;
            match tested {
                Ok(grasp) => plan.grasps.push(grasp),
                Err(reason) => plan.rejected.push(RejectedGrasp {
                    plan_from_tool,
                    reason,
                }),
            }
            if plan.grasps.len() >= self.settings.n_wanted {
                break;
            }
        }
        plan.grasps.sort_by(|a, b| b.score.total_cmp(&a.score));
        plan.rejected.append(&mut unfit);
        plan.rejected.truncate(N_REJECTED_MAX);
        plan
    }

    /// Grasps whose hand fits the object, best first.
    fn fitted(
        &self,
        estimate: &ObjectEstimate,
        surroundings: &Surroundings<'_>,
        unfit: &mut Vec<RejectedGrasp>,
    ) -> Vec<FittedGrasp> {
        let facing_min = self.facing_min();
        let contacts = &estimate.contacts;
        let width_max_m = self.gripper.max_opening_m;
        let (pairs, too_wide) = antipodal_pairs(contacts, width_max_m, facing_min);
        if let Some(pair) = too_wide.filter(|_| pairs.is_empty()) {
            unfit.extend(
                approaches(&pair.closing)
                    .first()
                    .map(|approach| RejectedGrasp {
                        plan_from_tool: tool_pose(&pair, approach),
                        reason: Rejection::TooWide {
                            width_m: pair.width_m,
                            limit_m: width_max_m,
                        },
                    }),
            );
        }
        let mut fitted = Vec::new();
        let mut in_tool = ContactsInTool::default();
        let levelled = pairs.iter().take(N_PAIRS).flat_map(levelled);
        let squeezes = squeeze_pairs(&estimate.packed, &estimate.centre_of_mass, self.gripper);
        for pair in &levelled.chain(squeezes).collect::<Vec<_>>() {
            for approach in approaches(&pair.closing) {
                let plan_from_tool =
                    self.over_carrier(&tool_pose(pair, &approach), pair.width_m, surroundings);
                in_tool.fill(&estimate.packed, &plan_from_tool, self.gripper);
                match in_tool.fit(self.gripper, pair.width_m, self.facing_min_of(pair)) {
                    Ok(fit) => fitted.push(FittedGrasp {
                        grasp: self.grasp(&plan_from_tool, &fit, pair, estimate),
                        pair: *pair,
                        fit,
                        order: fitted.len(),
                    }),
                    Err(reason) => unfit.push(RejectedGrasp {
                        plan_from_tool,
                        reason,
                    }),
                }
            }
        }
        fitted.sort_by(|a, b| {
            let by_score = b.score_if_centred().total_cmp(&a.score_if_centred());
            by_score.then(a.order.cmp(&b.order))
        });
        fitted
    }

    /// Grasp whose hand is moved until the pads touch with their middles, as long as that fits and
    /// makes it better.
    fn centred(
        &self,
        in_tool: &mut ContactsInTool,
        fitted: &FittedGrasp,
        (estimate, surroundings): (&ObjectEstimate, &Surroundings<'_>),
    ) -> Grasp {
        let (mut fit, mut best) = (fitted.fit, fitted.grasp.clone());
        for _ in 0..N_CENTRINGS {
            let [y_m, z_m] = fit.middle_m;
            let moved = best.plan_from_tool * Translation3::new(0.0, y_m, z_m);
            let moved = self.over_carrier(&moved, fit.width_m, surroundings);
            in_tool.fill(&estimate.packed, &moved, self.gripper);
            let facing_min = self.facing_min_of(&fitted.pair);
            let next = in_tool.fit(self.gripper, fit.width_m, facing_min);
            let Ok(next) = next else {
                break;
            };
            let grasp = self.grasp(&moved, &next, &fitted.pair, estimate);
            if grasp.score <= best.score {
                break;
            }
            (fit, best) = (next, grasp);
        }
        best
    }

    /// Cosine of the friction cone that is relied on.
    fn facing_min(&self) -> f64 {
        (RELIED_FRICTION * self.gripper.pad_friction).atan().cos()
    }

    /// Least cosine between pad and surface: that of the friction cone, and a wider one for a squeeze,
    /// in which the object turns.
    fn facing_min_of(&self, pair: &AntipodalPair) -> f64 {
        if pair.is_squeeze {
            SQUEEZE_FACING_MIN
        } else {
            self.facing_min()
        }
    }

    /// Reason why a mass cannot be held by friction; `None` when it can.
    fn too_heavy(&self, mass_kg: f64) -> Option<Rejection> {
        let friction = RELIED_FRICTION * self.gripper.pad_friction;
        let held_n = 2.0 * friction * self.gripper.closing_force_n;
        (mass_kg * HELD_M_S2 > held_n).then_some(Rejection::TooHeavy { mass_kg })
    }

    /// Tool pose, moved back along the approach where the hand would touch the surface that carries
    /// the object, as long as the pads reach the contacts.
    fn over_carrier(
        &self,
        plan_from_tool: &RigidTransform,
        width_m: f64,
        surroundings: &Surroundings<'_>,
    ) -> RigidTransform {
        let Some(plane) = surroundings.carrier_plane() else {
            return *plan_from_tool;
        };
        let down = -(plan_from_tool.rotation * Vector3::z()).dot(&plane.normal);
        if down < 0.3 {
            return *plan_from_tool;
        }
        let opening_m = (width_m + 2.0 * CLEARANCE_MAX_M).min(self.gripper.max_opening_m);
        let boxes = hand_boxes(self.gripper, opening_m);
        let heights = boxes
            .iter()
            .map(|body| lowest_m(&body.transformed(plan_from_tool), plane));
        let low_m = heights.fold(f64::INFINITY, f64::min);
        let back_m = ((SURFACE_CLEARANCE_M - low_m) / down).max(0.0);
        let reach_m = 0.5 * self.gripper.pad_length_m - 0.003;
        plan_from_tool * Translation3::new(0.0, 0.0, -back_m.min(reach_m))
    }

    fn grasp(
        &self,
        plan_from_tool: &RigidTransform,
        fit: &HandFit,
        pair: &AntipodalPair,
        estimate: &ObjectEstimate,
    ) -> Grasp {
        let plan_from_tool = plan_from_tool * Translation3::new(fit.shift_m, 0.0, 0.0);
        let facing_min = self.facing_min();
        let off = estimate.centre_of_mass - Point3::from(plan_from_tool.translation.vector);
        let closing = plan_from_tool.rotation * Vector3::x();
        let mut lever = off - closing * off.dot(&closing);
        lever.z = 0.0;
        let lever_m = lever.norm();
        let clearance_m = 0.5 * (fit.opening_m - fit.width_m);
        let off_centre_m = fit.middle_m[0].hypot(fit.middle_m[1]);
        let least = if pair.is_squeeze {
            SQUEEZE_FRICTION
        } else {
            FACTOR_MIN
        };
        let margin = (fit.facing - facing_min) / (1.0 - facing_min);
        let factors = ScoreFactors {
            friction: margin.clamp(least, 1.0).sqrt(),
            contact: (fit.overlap / OVERLAP_FULL).clamp(FACTOR_MIN, 1.0),
            centring: (-0.5 * (off_centre_m / OFF_CENTRE_M).powi(2)).exp(),
            balance: (-0.5 * (lever_m / LEVER_M).powi(2)).exp(),
            evidence: match pair.evidence {
                ContactEvidence::Model | ContactEvidence::Seen | ContactEvidence::Contour => 1.0,
                ContactEvidence::Mirrored => 0.7,
            },
            room: (clearance_m / CLEARANCE_MAX_M)
                .clamp(FACTOR_MIN, 1.0)
                .sqrt(),
            seen_way: 1.0,
        };
        Grasp {
            plan_from_tool,
            opening_m: fit.opening_m,
            width_m: fit.width_m,
            approach_m: self.settings.approach_m,
            lift_m: self.settings.lift_m,
            score: factors.product(),
            factors,
            evidence: pair.evidence,
            joints: None,
        }
    }

    /// Grasp that hits nothing and that the arm can reach.
    fn tested(
        &self,
        mut grasp: Grasp,
        surroundings: &Surroundings<'_>,
    ) -> Result<Grasp, Rejection> {
        self.check_collisions(&grasp, surroundings)?;
        let swept = self.approach_boxes(&grasp);
        let share = surroundings.unseen_share(&swept);
        if share > self.settings.unseen_max {
            return Err(Rejection::Unseen { share });
        }
        grasp.factors.seen_way = 1.0 - self.settings.unseen_cost * share;
        grasp.score = grasp.factors.product();
        if grasp.score < self.settings.score_min {
            return Err(Rejection::Weak { score: grasp.score });
        }
        if let Some(placed) = self.arm {
            let ways = GraspWays {
                approach_m: grasp.approach_m,
                lift_m: grasp.lift_m,
            };
            // The fingers are alike: the hand may be turned by half a turn.
            let half_turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), PI);
            let turned = grasp.plan_from_tool * half_turn;
            let found = reach(placed, &grasp.plan_from_tool, ways, surroundings);
            let joints = match found {
                Ok(joints) => joints,
                Err(reason) => {
                    let joints = reach(placed, &turned, ways, surroundings);
                    let joints = joints.map_err(|_| reason)?;
                    grasp.plan_from_tool = turned;
                    joints
                }
            };
            grasp.joints = Some(joints);
        }
        Ok(grasp)
    }

    /// Boxes that the open hand passes through on its approach, frame of planning.
    fn approach_boxes(&self, grasp: &Grasp) -> [OrientedBox; 4] {
        hand_boxes(self.gripper, grasp.opening_m)
            .map(|body| swept_back(&body, grasp.approach_m).transformed(&grasp.plan_from_tool))
    }

    fn check_collisions(
        &self,
        grasp: &Grasp,
        surroundings: &Surroundings<'_>,
    ) -> Result<(), Rejection> {
        let hit = |what: Obstacle, phase: GraspPhase| Rejection::Hits { what, phase };
        for body in self.approach_boxes(grasp) {
            if let Some(what) = surroundings.hit_by_box(&body) {
                return Err(hit(what, GraspPhase::Approach));
            }
        }
        for body in closing_boxes(self.gripper, grasp.opening_m, grasp.width_m) {
            let body = body.transformed(&grasp.plan_from_tool);
            if let Some(what) = surroundings.hit_by_box(&body) {
                return Err(hit(what, GraspPhase::Closing));
            }
        }
        let held = hand_boxes(self.gripper, grasp.width_m);
        for step in 1..=N_LIFT_STEPS {
            let up_m = grasp.lift_m * f64::from(step) / f64::from(N_LIFT_STEPS);
            let pose = Translation3::new(0.0, 0.0, up_m) * grasp.plan_from_tool;
            for body in &held {
                if let Some(what) = surroundings.hit_by_box(&body.transformed(&pose)) {
                    return Err(hit(what, GraspPhase::Lift));
                }
            }
        }
        Ok(())
    }
}

impl FittedGrasp {
    /// Score without the distance of the contact from the middle of the pads, which moving the
    /// hand may mend.
    fn score_if_centred(&self) -> f64 {
        self.grasp.score / self.grasp.factors.centring.max(1e-9)
    }
}
