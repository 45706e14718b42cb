//! Plan of a transport: transit to a grasp, transit with the object, and its place.

use crate::carried_load::CarriedLoad;
use crate::place_area::PlaceArea;
use crate::place_plan::PlacePlan;
use crate::placing::{GraspedObject, PlacePose, PlacingPlanner};
use crate::transit::{NoTransit, TransitPath, TransitPlanner};
use grasping::{ContactPoint, Grasp, GraspScene, Obstacles, PlacedArm};
use nalgebra::{Point3, Vector3};

/// Length beyond the arm's reach of what it may hold, metres.
const BEYOND_REACH_M: f64 = 0.3;

/// Box around everything that an arm can touch, two corners, frame of planning, metres.
pub fn reach_region(placed: &PlacedArm) -> [Point3<f64>; 2] {
    let dimensions = placed.arm.dimensions();
    let shoulder = placed.plan_from_base * Point3::new(0.0, 0.0, dimensions.base_m);
    let reach = Vector3::repeat(dimensions.reach_m() + BEYOND_REACH_M);
    [shoulder - reach, shoulder + reach]
}

/// Planner of transports in a scene.
#[derive(Clone, Copy)]
pub struct TransportPlanner<'a> {
    /// Scene.
    pub scene: &'a GraspScene<'a>,
    /// Obstacles within the arm's reach.
    pub obstacles: &'a Obstacles,
    /// Arm.
    pub placed: &'a PlacedArm,
    /// Seed of the random trees.
    pub seed: u64,
}

/// Grasp that the arm can move to.
#[derive(Debug, Clone, PartialEq)]
pub struct ReachedGrasp {
    /// Index of the grasp.
    pub grasp: usize,
    /// Path from where the arm stands to the begin of the approach.
    pub path: TransitPath,
}

/// Transport of an object to a place.
#[derive(Debug, Clone, PartialEq)]
pub struct Transport {
    /// Grasp, and the path to it.
    pub reached: ReachedGrasp,
    /// Path with the object, from the end of the lift to over the place.
    pub path: TransitPath,
    /// Place.
    pub placement: PlacePose,
}

/// Reason why there is no transport.
#[derive(Debug, Clone, PartialEq)]
pub enum NoTransport {
    /// No grasp is there, or none was planned for the arm.
    NoGrasp,
    /// No grasp can be moved to.
    NoWayToGrasp(NoTransit),
    /// No place is free.
    NoPlace(PlacePlan),
    /// No place can be moved to with the object.
    NoWayToPlace(NoTransit),
}

impl TransportPlanner<'_> {
    /// First of the grasps that the arm can move to from where it stands, with open fingers.
    ///
    /// # Errors
    /// The reason of the best grasp.
    pub fn reach(&self, grasps: &[Grasp]) -> Result<ReachedGrasp, NoTransport> {
        let mut reason = None;
        for (index, grasp) in grasps.iter().enumerate() {
            match self.reach_one(grasp) {
                Ok(path) => return Ok(ReachedGrasp { grasp: index, path }),
                Err(failed) => reason = reason.or(Some(failed)),
            }
        }
        Err(reason.unwrap_or(NoTransport::NoGrasp))
    }

    fn reach_one(&self, grasp: &Grasp) -> Result<TransitPath, NoTransport> {
        let joints = grasp.joints.ok_or(NoTransport::NoGrasp)?;
        let transit = self.transit(grasp.opening_m, None);
        let path = transit.plan(&self.placed.joints_rad, &joints.approach_rad);
        path.map_err(NoTransport::NoWayToGrasp)
    }

    /// Transport of an object of the scene, with its surface, to an area by the best grasp for which
    /// everything can be done.
    ///
    /// # Errors
    /// The reason of the grasp that came farthest.
    pub fn plan(
        &self,
        (object, contacts): (usize, &[ContactPoint]),
        grasps: &[Grasp],
        area: &PlaceArea,
    ) -> Result<Transport, NoTransport> {
        let mut reason = NoTransport::NoGrasp;
        for (index, grasp) in grasps.iter().enumerate() {
            let failed = match self.reach_one(grasp) {
                Ok(path) => {
                    let reached = ReachedGrasp { grasp: index, path };
                    match self.carry((object, contacts), grasp, area) {
                        Ok((path, placement)) => {
                            return Ok(Transport {
                                reached,
                                path,
                                placement,
                            });
                        }
                        Err(failed) => failed,
                    }
                }
                Err(failed) => failed,
            };
            if failed.stage() > reason.stage() {
                reason = failed;
            }
        }
        Err(reason)
    }

    /// Path with the object in the hand, and its place.
    fn carry(
        &self,
        (index, contacts): (usize, &[ContactPoint]),
        grasp: &Grasp,
        area: &PlaceArea,
    ) -> Result<(TransitPath, PlacePose), NoTransport> {
        let object = GraspedObject {
            index,
            contacts,
            grasp,
        };
        let placing = PlacingPlanner {
            scene: self.scene,
            obstacles: self.obstacles,
            placed: self.placed,
        };
        let mut places = placing.plan(&object, area);
        if places.placements.is_empty() {
            return Err(NoTransport::NoPlace(places));
        }
        let joints = grasp.joints.ok_or(NoTransport::NoGrasp)?;
        let load = CarriedLoad::of(contacts, &grasp.plan_from_tool, Some(index));
        let transit = self.transit(grasp.width_m, load.as_ref());
        let mut reason = None;
        for placement in places.placements.drain(..) {
            match transit.plan(&joints.lift_rad, &placement.above_rad) {
                Ok(path) => return Ok((path, placement)),
                Err(failed) => reason = reason.or(Some(failed)),
            }
        }
        Err(reason.map_or(NoTransport::NoGrasp, NoTransport::NoWayToPlace))
    }

    fn transit<'a>(&'a self, opening_m: f64, load: Option<&'a CarriedLoad>) -> TransitPlanner<'a> {
        TransitPlanner {
            scene: self.scene,
            obstacles: self.obstacles,
            placed: self.placed,
            opening_m,
            load,
            seed: self.seed,
        }
    }
}

impl NoTransport {
    /// Part of the transport that failed: later ones say more.
    fn stage(&self) -> u8 {
        match self {
            Self::NoGrasp => 0,
            Self::NoWayToGrasp(_) => 1,
            Self::NoPlace(_) => 2,
            Self::NoWayToPlace(_) => 3,
        }
    }

    /// Reason as a sentence, with the names of the things of a scene.
    pub fn words(&self, scene: &GraspScene<'_>, area: Option<&PlaceArea>) -> String {
        match self {
            Self::NoGrasp => "no grasp that the arm reaches is known".to_owned(),
            Self::NoWayToGrasp(reason) => {
                let words = reason.words(scene);
                let advice = match reason {
                    NoTransit::StartBlocked(_) => "; move it away first, as by `tabula arm home`",
                    NoTransit::GoalBlocked(_) | NoTransit::NoPath { .. } => "",
                };
                format!("no way to a grasp: {words}{advice}")
            }
            Self::NoPlace(places) => area
                .and_then(|area| places.why_none(scene, area))
                .unwrap_or_else(|| "no place is free".to_owned()),
            Self::NoWayToPlace(reason) => {
                format!(
                    "no way to the place with the object: {}",
                    reason.words(scene)
                )
            }
        }
    }
}
