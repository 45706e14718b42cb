//! Trial of a transport: plan from one view, carried out beside the trivial rival.

use super::trial_run::{RunOutcome, carry_out};
use crate::arguments::TransportArguments;
use crate::evaluate::arm_motion::arm_of;
use crate::evaluate::world_view::{CAMERA, WorldView};
use evaluation::scene_picture;
use geometry::ConvexPolygon;
use grasp_scene::{SceneBodies, draw_transport, grasp_scene};
use grasping::{
    Grasp, GraspPlanner, GraspScene, GraspSettings, Obstacles, PlacedArm, contact_surface,
};
use nalgebra::{Point2, Point3};
use scene_client::{ModelShelf, PlanningFrame};
use serde::Serialize;
use service::Failure;
use simulated_world::World;
use std::time::Instant;
use transport::{NoTransport, PlaceArea, TransitPath, Transport, TransportPlanner, reach_region};

/// Corners of the place on the table, world, metres: most of what the arm reaches.
const PLACE_M: [[f64; 2]; 4] = [[-0.35, -0.32], [0.25, -0.32], [0.25, 0.12], [-0.35, 0.12]];

/// Outcome of a trial.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum TransportOutcome {
    /// No grasp was planned.
    NoGrasp,
    /// No transport was planned.
    NoTransport,
    /// It was carried out.
    CarriedOut,
}

/// Trial of one object of a scene.
#[derive(Debug, Clone, Serialize)]
pub(super) struct TransportTrial {
    pub(super) kind: &'static str,
    pub(super) seed: u64,
    pub(super) object: u16,
    pub(super) model: String,
    pub(super) outcome: TransportOutcome,
    /// Reason why nothing was carried out.
    pub(super) reason: String,
    /// Kinds of both transits: `over_safe_height` or `random_tree`.
    pub(super) transits: Vec<&'static str>,
    /// Time that the arm needs for both transits, and that of straight motions of the joints.
    pub(super) transit_s: Option<f64>,
    pub(super) straight_s: Option<f64>,
    /// Time of the planning: obstacles, and all transits and places.
    pub(super) obstacles_ms: f64,
    pub(super) transport_ms: f64,
    /// Time of each transit to a grasp, found or not.
    pub(super) transit_ms: Vec<f64>,
    /// Outcome with the planned transits.
    pub(super) run: Option<RunOutcome>,
    /// Outcome with straight motions of the joints in their place.
    pub(super) rival: Option<RunOutcome>,
    pub(super) picture: String,
}

/// Plan of a trial with its inputs.
struct TrialPlan {
    grasp: Option<Grasp>,
    transport: Result<Transport, NoTransport>,
    words: String,
}

/// Runs the trials of a scene: those objects that are nearest to the arm. Each has a picture, PNG.
pub(super) fn run_trials(
    world: &World,
    arguments: &TransportArguments,
) -> Result<Vec<(TransportTrial, Vec<u8>)>, Failure> {
    let view = WorldView::of(world)?;
    let Some(frame) = PlanningFrame::of(&view.snapshot) else {
        return Ok(Vec::new());
    };
    let Some(placed) = arm_of(world, &frame) else {
        return Ok(Vec::new());
    };
    let base = frame.world_from_plan * Point3::from(placed.plan_from_base.translation.vector);
    let mut objects: Vec<(f64, u16, usize)> = world
        .objects()
        .iter()
        .filter_map(|object| {
            let index = view.index_of(object.id)?;
            let place = Point3::from(object.world_from_object.translation.vector);
            Some(((place.xy() - base.xy()).norm(), object.id, index))
        })
        .collect();
    objects.sort_by(|a, b| a.0.total_cmp(&b.0));
    objects.truncate(arguments.objects.into());
    let trials = objects.into_iter().map(|(_, object, index)| {
        run_trial(
            (world, object),
            (&view, index),
            (&frame, &placed),
            arguments,
        )
    });
    trials.collect()
}

fn run_trial(
    (world, object): (&World, u16),
    (view, index): (&WorldView, usize),
    (frame, placed): (&PlanningFrame, &PlacedArm),
    arguments: &TransportArguments,
) -> Result<(TransportTrial, Vec<u8>), Failure> {
    let mut trial = TransportTrial {
        kind: "",
        seed: 0,
        object,
        model: world
            .find(object)
            .map_or_else(String::new, |o| o.model.name.clone()),
        outcome: TransportOutcome::NoGrasp,
        reason: String::new(),
        transits: Vec::new(),
        transit_s: None,
        straight_s: None,
        obstacles_ms: 0.0,
        transport_ms: 0.0,
        transit_ms: Vec::new(),
        run: None,
        rival: None,
        picture: String::new(),
    };
    let bodies = SceneBodies {
        people: Vec::new(),
        robot: world.arm_capsules(),
    };
    let scene = grasp_scene(&view.snapshot, frame, &ModelShelf::default(), &bodies);
    let plan = planned((&scene, index), frame, placed, (arguments, &mut trial));
    if plan.grasp.is_some() || !matches!(plan.transport, Err(NoTransport::NoGrasp)) {
        trial.outcome = TransportOutcome::NoTransport;
    }
    trial.reason = plan.words;
    let drawn = plan.transport.as_ref().ok().zip(plan.grasp.as_ref());
    let rgb = draw_transport(&view.snapshot, frame, placed, index, drawn);
    let (width, height) = (CAMERA.width as usize, CAMERA.height as usize);
    let picture = scene_picture::encode(&rgb, width, height).map_err(Failure::general)?;
    if let Some((transport, grasp)) = drawn {
        trial.outcome = TransportOutcome::CarriedOut;
        let straight = Transport {
            reached: transport::ReachedGrasp {
                grasp: transport.reached.grasp,
                path: direct(&transport.reached.path),
            },
            path: direct(&transport.path),
            placement: transport.placement.clone(),
        };
        trial.transits = [&transport.reached.path, &transport.path]
            .map(|path| path.kind.word())
            .to_vec();
        let seconds =
            |t: &Transport| t.reached.path.duration_s(&placed.arm) + t.path.duration_s(&placed.arm);
        trial.transit_s = Some(seconds(transport));
        trial.straight_s = Some(seconds(&straight));
        trial.run = Some(carry_out(world.clone(), object, (grasp, transport), frame));
        trial.rival = Some(carry_out(world.clone(), object, (grasp, &straight), frame));
    }
    Ok((trial, picture))
}

fn planned(
    (scene, index): (&GraspScene<'_>, usize),
    frame: &PlanningFrame,
    placed: &PlacedArm,
    (arguments, trial): (&TransportArguments, &mut TransportTrial),
) -> TrialPlan {
    let near = Obstacles::of(scene);
    let grasp_planner = GraspPlanner {
        scene,
        obstacles: &near,
        gripper: placed.arm.gripper(),
        arm: Some(placed),
        settings: &GraspSettings::default(),
    };
    let grasps = grasp_planner.plan(index);
    let begun = Instant::now();
    let region = reach_region(placed);
    let obstacles = Obstacles::within(scene, &region);
    trial.obstacles_ms = 1e3 * begun.elapsed().as_secs_f64();
    let planner = TransportPlanner {
        scene,
        obstacles: &obstacles,
        placed,
        seed: arguments.seed,
    };
    let area = area(frame, arguments.arm_opposite);
    let contacts = contact_surface(scene, index);
    let begun = Instant::now();
    let transport = planner.plan((index, &contacts), &grasps.grasps, &area);
    trial.transport_ms = 1e3 * begun.elapsed().as_secs_f64();
    trial.transit_ms = grasps
        .grasps
        .iter()
        .map(|grasp| {
            let begun = Instant::now();
            let _ = planner.reach(std::slice::from_ref(grasp));
            1e3 * begun.elapsed().as_secs_f64()
        })
        .collect();
    let track = scene.objects[index].track;
    let words = match &transport {
        Ok(_) => String::new(),
        Err(reason) => grasps
            .why_none(scene, track)
            .unwrap_or_else(|| reason.words(scene, Some(&area))),
    };
    let chosen = transport.as_ref().map_or(0, |found| found.reached.grasp);
    TrialPlan {
        grasp: grasps.grasps.get(chosen).cloned(),
        transport,
        words,
    }
}

/// Place of the trials, on the side of the arm.
fn area(frame: &PlanningFrame, is_opposite: bool) -> PlaceArea {
    let plan_from_world = frame.world_from_plan.inverse();
    let side = if is_opposite { -1.0 } else { 1.0 };
    let corner = |[x, y]: [f64; 2]| (plan_from_world * Point3::new(side * x, side * y, 0.0)).xy();
    let mut corners: [Point2<f64>; 4] = PLACE_M.map(corner);
    PlaceArea {
        name: "table".to_owned(),
        outline: ConvexPolygon::convex_hull_of(&mut corners),
        height_m: None,
    }
}

/// Trivial rival of a transit: one straight motion of the joints.
fn direct(path: &TransitPath) -> TransitPath {
    let ends = [path.waypoints_rad.first(), path.waypoints_rad.last()];
    TransitPath {
        waypoints_rad: ends.into_iter().flatten().copied().collect(),
        ..path.clone()
    }
}
