//! Trial of a grasp: plan from one view, approach, close, lift, hold.

use super::box_rival::rival_grasp;
use super::mujoco_judge::{JudgedGrasp, MujocoJudge, Verdict};
use super::trial_scene::world;
use crate::evaluate::arm_motion::{arm_of, command};
use crate::evaluate::world_view::{CAMERA, WorldView};
use arm_kinematics::GripperModel;
use evaluation::scene_picture;
use grasp_scene::{SceneBodies, draw_grasp, grasp_scene};
use grasping::{Grasp, GraspPlan, GraspPlanner, GraspSettings, Obstacles, hand_boxes, lowest_m};
use nalgebra::{Translation3, UnitQuaternion, Vector3};
use random::Random;
use scene_client::{ModelShelf, PlanningFrame};
use serde::Serialize;
use service::Failure;
use simulated_world::{ArmCommand, ModelChoice, ModelLibrary, STEPS_PER_SECOND, World};
use std::time::Instant;

/// Time for which the lifted object must be held, seconds.
const HELD_S: u32 = 1;
/// Begin of the sentence with which the simulated arm tells that it was stopped.
const STOPPED: &str = "the arm stopped";
/// Greatest shift along each axis, metres, and turn about each, radians, of a spoiled grasp.
const SPOILED_SHIFT_M: f64 = 0.03;
const SPOILED_TURN_RAD: f64 = 0.5;
/// Least height of the hand of a spoiled grasp over the table, metres.
const OVER_TABLE_M: f64 = 0.005;
/// Stream of the random numbers of the spoiling.
const SPOILING_STREAM: u64 = 0x7370_6f69;
/// Share of the lift by which the object must have risen.
const LIFTED_SHARE: f64 = 0.8;

/// Outcome of a trial.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum GraspOutcome {
    /// Lifted and held.
    Lifted,
    /// Detection did not find the object.
    NotDetected,
    /// No grasp was planned.
    NoGrasp,
    /// The arm has no way to the grasp.
    OutOfReach,
    /// The arm was stopped on its way to the grasp.
    NotReached,
    /// The fingers did not hold the object.
    NotHeld,
    /// The object was lost on the way up.
    Lost,
}

/// Trial of one object in one pose.
#[derive(Debug, Clone, Serialize)]
pub(super) struct GraspTrial {
    pub(super) object: String,
    pub(super) seed: u64,
    pub(super) outcome: GraspOutcome,
    /// Reason of a failure.
    pub(super) reason: String,
    /// Verdict of MuJoCo about the grasp that was tried.
    pub(super) mujoco: Option<bool>,
    pub(super) mujoco_reason: String,
    /// The same grasp, shifted and turned at random.
    pub(super) spoiled: Option<SpoiledTrial>,
    /// Verdict of MuJoCo about the grasp of the trivial rival.
    pub(super) rival_mujoco: Option<bool>,
    /// Score of the grasp that was tried, 0 to 1.
    pub(super) score: Option<f64>,
    /// Direction of approach.
    pub(super) approach: Option<&'static str>,
    pub(super) width_mm: Option<f64>,
    pub(super) n_grasps: usize,
    pub(super) n_rejected: usize,
    /// Time of the planning, milliseconds.
    pub(super) planning_ms: f64,
    /// Picture with the planned grasp, relative to the output folder.
    pub(super) picture: String,
}

/// Trial of a grasp that was shifted and turned at random, to compare the judges.
#[derive(Debug, Clone, Serialize)]
pub(super) struct SpoiledTrial {
    /// Outcome by our simulator.
    pub(super) outcome: GraspOutcome,
    pub(super) reason: String,
    /// Verdict of MuJoCo.
    pub(super) mujoco: bool,
    pub(super) mujoco_reason: String,
}

/// Runs the trial of an object in the pose of a seed; the second value is a picture, PNG.
pub(super) fn run_trial(
    model: &ModelChoice,
    seed: u64,
    library: ModelLibrary,
    mujoco: Option<&MujocoJudge>,
) -> Result<(GraspTrial, Vec<u8>), Failure> {
    let mut world = world(model, seed, library)?;
    let object = &world.objects()[0];
    let (id, name) = (object.id, object.model.name.clone());
    let view = WorldView::of(&world)?;
    let target = view.index_of(id);
    let mut trial = GraspTrial {
        object: name,
        seed,
        outcome: GraspOutcome::NotDetected,
        reason: String::new(),
        mujoco: None,
        mujoco_reason: String::new(),
        spoiled: None,
        rival_mujoco: None,
        score: None,
        approach: None,
        width_mm: None,
        n_grasps: 0,
        n_rejected: 0,
        planning_ms: 0.0,
        picture: String::new(),
    };
    let Some(frame) = PlanningFrame::of(&view.snapshot) else {
        return Ok((trial, Vec::new()));
    };
    let grasp = planned((&view, target), &frame, &world, &mut trial);
    let gripper = GripperModel::JACO_LIKE;
    let rgb = draw_grasp(&view.snapshot, &frame, &gripper, target, grasp.as_ref());
    let (width, height) = (CAMERA.width as usize, CAMERA.height as usize);
    let picture = scene_picture::encode(&rgb, width, height).map_err(Failure::general)?;
    if let (Some(judge), Some(target)) = (mujoco, target) {
        let rival = rival_grasp(&view.snapshot, target, &gripper, friction(&world));
        trial.rival_mujoco = Some(match rival {
            Some(rival) => judge.judge(&world, id, &gripper, &rival)?.held,
            None => false,
        });
    }
    if let Some(grasp) = grasp {
        if let Some(judge) = mujoco {
            let verdict = judged(judge, &world, id, &grasp, &frame)?;
            trial.mujoco = Some(verdict.held);
            trial.mujoco_reason = verdict.reason;
            trial.spoiled = Some(run_spoiled(
                judge,
                &world,
                id,
                &spoiled(&grasp, &frame, seed),
                &frame,
            )?);
        }
        (trial.outcome, trial.reason) = match carry_out(&mut world, id, &grasp, &frame) {
            Ok(()) => (GraspOutcome::Lifted, String::new()),
            Err(failed) => failed,
        };
    }
    Ok((trial, picture))
}

/// Plans the best grasp of the trial's object, and notes what was planned.
fn planned(
    (view, target): (&WorldView, Option<usize>),
    frame: &PlanningFrame,
    world: &World,
    trial: &mut GraspTrial,
) -> Option<Grasp> {
    let target = target?;
    let begun = Instant::now();
    let scene = grasp_scene(
        &view.snapshot,
        frame,
        &ModelShelf::default(),
        &SceneBodies::default(),
    );
    let obstacles = Obstacles::of(&scene);
    let placed = arm_of(world, frame)?;
    let planner = GraspPlanner {
        scene: &scene,
        obstacles: &obstacles,
        gripper: placed.arm.gripper(),
        arm: Some(&placed),
        settings: &GraspSettings::default(),
    };
    let plan: GraspPlan = planner.plan(target);
    trial.planning_ms = 1e3 * begun.elapsed().as_secs_f64();
    trial.outcome = GraspOutcome::NoGrasp;
    trial.n_grasps = plan.grasps.len();
    trial.n_rejected = plan.rejected.len();
    let track = view.snapshot.objects[target].track;
    trial.reason = plan.why_none(&scene, track).unwrap_or_default();
    let grasp = plan.grasps.into_iter().next()?;
    trial.score = Some(grasp.score);
    trial.approach = Some(grasp.kind().words());
    trial.width_mm = Some(1e3 * grasp.width_m);
    Some(grasp)
}

/// Verdict of MuJoCo about a grasp, with the pads' friction of the simulation.
fn judged(
    judge: &MujocoJudge,
    world: &World,
    object: u16,
    grasp: &Grasp,
    frame: &PlanningFrame,
) -> Result<Verdict, Failure> {
    let asked = JudgedGrasp {
        world_from_tool: frame.world_from_plan * grasp.plan_from_tool,
        opening_m: grasp.opening_m,
        approach_m: grasp.approach_m,
        friction: friction(world),
    };
    judge.judge(world, object, &GripperModel::JACO_LIKE, &asked)
}

/// Grasp that is shifted and turned at random, over the table; about every second one fails.
fn spoiled(grasp: &Grasp, frame: &PlanningFrame, seed: u64) -> Grasp {
    let mut random = Random::substream(seed, SPOILING_STREAM);
    let mut between = |most: f64| random.between(-most, most);
    let shift = Translation3::new(
        between(SPOILED_SHIFT_M),
        between(SPOILED_SHIFT_M),
        between(SPOILED_SHIFT_M),
    );
    let turn = Vector3::from_fn(|_, _| between(SPOILED_TURN_RAD));
    let spoiling = shift * UnitQuaternion::from_scaled_axis(turn);
    let pose = grasp.plan_from_tool * spoiling;
    let low_m = frame.table_in_plan.map(|table| {
        let hand = hand_boxes(&GripperModel::JACO_LIKE, grasp.opening_m);
        let heights = hand.map(|body| lowest_m(&body.transformed(&pose), &table));
        heights.into_iter().fold(f64::INFINITY, f64::min)
    });
    // One arm stops before the table, the other presses on it.
    let up_m = (OVER_TABLE_M - low_m.unwrap_or(OVER_TABLE_M)).max(0.0);
    Grasp {
        plan_from_tool: Translation3::new(0.0, 0.0, up_m) * pose,
        joints: None,
        ..grasp.clone()
    }
}

/// Lets both judges carry out a spoiled grasp.
fn run_spoiled(
    judge: &MujocoJudge,
    world: &World,
    object: u16,
    grasp: &Grasp,
    frame: &PlanningFrame,
) -> Result<SpoiledTrial, Failure> {
    let verdict = judged(judge, world, object, grasp, frame)?;
    let (outcome, reason) = match carry_out(&mut world.clone(), object, grasp, frame) {
        Ok(()) => (GraspOutcome::Lifted, String::new()),
        Err(failed) => failed,
    };
    Ok(SpoiledTrial {
        outcome,
        reason,
        mujoco: verdict.held,
        mujoco_reason: verdict.reason,
    })
}

/// Friction between pads and object, as the simulation draws it.
fn friction(world: &World) -> f64 {
    let friction = world.pad_friction();
    friction.unwrap_or(GripperModel::JACO_LIKE.pad_friction)
}

/// Carries out a grasp; the failure has its class and its reason.
fn carry_out(
    world: &mut World,
    object: u16,
    grasp: &Grasp,
    frame: &PlanningFrame,
) -> Result<(), (GraspOutcome, String)> {
    let z_of = |world: &World| {
        let object = world.find(object);
        object.map_or(f64::NEG_INFINITY, |o| o.world_from_object.translation.z)
    };
    let begin_m = z_of(world);
    let world_from_tool = frame.world_from_plan * grasp.plan_from_tool;
    let straight = |world_from_gripper| ArmCommand::MoveTo {
        world_from_gripper,
        is_straight: true,
    };
    let not_reached = |reason: String| {
        let is_stopped = reason.starts_with(STOPPED);
        let outcome = if is_stopped {
            GraspOutcome::NotReached
        } else {
            GraspOutcome::OutOfReach
        };
        (outcome, reason)
    };
    command(world, &ArmCommand::OpenTo(grasp.opening_m)).map_err(not_reached)?;
    if let Some(joints) = &grasp.joints {
        let angles_rad = joints.approach_rad.into();
        command(world, &ArmCommand::MoveJoints(angles_rad)).map_err(not_reached)?;
    } else {
        let back = Translation3::new(0.0, 0.0, -grasp.approach_m);
        let begin = ArmCommand::MoveTo {
            world_from_gripper: world_from_tool * back,
            is_straight: false,
        };
        command(world, &begin).map_err(not_reached)?;
    }
    command(world, &straight(world_from_tool)).map_err(not_reached)?;
    let not_held = |reason| (GraspOutcome::NotHeld, reason);
    let status = command(world, &ArmCommand::Close).map_err(not_held)?;
    if status.holds != Some(object) {
        return Err(not_held("the fingers hold something else".to_owned()));
    }
    let mut lifted = world_from_tool;
    lifted.translation.z += grasp.lift_m;
    let lost = |reason| (GraspOutcome::Lost, reason);
    command(world, &straight(lifted)).map_err(lost)?;
    for _ in 0..HELD_S * STEPS_PER_SECOND {
        world.step();
    }
    let risen_m = z_of(world) - begin_m;
    if risen_m < LIFTED_SHARE * grasp.lift_m {
        return Err(lost(format!("it rose by {:.0} mm", 1e3 * risen_m)));
    }
    Ok(())
}
