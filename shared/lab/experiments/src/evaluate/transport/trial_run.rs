//! Run of a planned transport in the simulated world, and what it did to the other objects.

use crate::evaluate::arm_motion::command;
use evaluation::disturbance::{TIPPED_RAD, is_disturbed, tipped_rad};
use geometry::RigidTransform;
use grasping::Grasp;
use nalgebra::{Translation3, Vector3};
use scene_client::PlanningFrame;
use serde::Serialize;
use simulated_world::{ArmCommand, STEPS_PER_SECOND, World};
use transport::{TransitPath, Transport};

/// Distance from the planned place within which the object must stand, metres.
const PLACED_M: f64 = 0.025;
/// Time after the release until the world is judged, seconds.
const SETTLING_S: u32 = 2;

/// Part of a transport that was reached.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum RunStage {
    /// The way to the object was not completed.
    OnTheWay,
    /// The fingers did not hold the object.
    NotHeld,
    /// It was lost, or the arm was stopped, with the object in the hand.
    Carrying,
    /// It was set down, and does not stand where it should.
    Misplaced,
    /// It stands at its place.
    Placed,
}

/// Outcome of a run.
#[derive(Debug, Clone, Serialize)]
pub(super) struct RunOutcome {
    pub(super) stage: RunStage,
    /// Reason of a failure.
    pub(super) reason: String,
    /// Names of the other objects that were moved by more than a centimetre, or tipped.
    pub(super) disturbed: Vec<String>,
}

/// Carries out a transport in a world.
pub(super) fn carry_out(
    mut world: World,
    object: u16,
    (grasp, transport): (&Grasp, &Transport),
    frame: &PlanningFrame,
) -> RunOutcome {
    let before: Vec<(u16, RigidTransform)> = poses(&world);
    // What moves without the arm was not moved by it.
    let mut alone = world.clone();
    let done = run(&mut world, object, (grasp, transport), frame);
    let (stage, reason) = done.err().unwrap_or((RunStage::Placed, String::new()));
    for _ in 0..SETTLING_S * STEPS_PER_SECOND {
        world.step();
    }
    while alone.time_s() < world.time_s() {
        alone.step();
    }
    let mut outcome = RunOutcome {
        stage,
        reason,
        disturbed: Vec::new(),
    };
    for (id, pose) in before {
        let Some(now) = world.find(id) else {
            continue;
        };
        if id != object {
            let undisturbed = alone
                .find(id)
                .map_or(pose, |object| object.world_from_object);
            let is_still = !is_disturbed(&pose, &undisturbed);
            if is_still && is_disturbed(&pose, &now.world_from_object) {
                outcome.disturbed.push(now.model.name.clone());
            }
        } else if outcome.stage == RunStage::Placed
            && let Some(reason) = misplaced(&pose, &now.world_from_object, transport, grasp, frame)
        {
            outcome.stage = RunStage::Misplaced;
            outcome.reason = reason;
        }
    }
    outcome
}

fn poses(world: &World) -> Vec<(u16, RigidTransform)> {
    let objects = world.objects().iter();
    objects
        .map(|object| (object.id, object.world_from_object))
        .collect()
}

/// Reason why an object does not stand where it should; `None` when it does.
fn misplaced(
    before: &RigidTransform,
    after: &RigidTransform,
    transport: &Transport,
    grasp: &Grasp,
    frame: &PlanningFrame,
) -> Option<String> {
    let world = frame.world_from_plan;
    let moved = transport.placement.plan_from_tool * grasp.plan_from_tool.inverse();
    let planned = world * moved * world.inverse() * before;
    let off_m = (planned.translation.vector - after.translation.vector).norm();
    let tipped_deg = tipped_rad(before, after).to_degrees();
    (off_m > PLACED_M || tipped_deg.to_radians() > TIPPED_RAD).then(|| {
        format!(
            "{:.0} mm off its place, tipped by {tipped_deg:.0}°",
            1e3 * off_m
        )
    })
}

fn run(
    world: &mut World,
    object: u16,
    (grasp, transport): (&Grasp, &Transport),
    frame: &PlanningFrame,
) -> Result<(), (RunStage, String)> {
    let straight = |plan_from_tool: &RigidTransform| ArmCommand::MoveTo {
        world_from_gripper: frame.world_from_plan * plan_from_tool,
        is_straight: true,
    };
    let up = Translation3::from(Vector3::z() * grasp.lift_m);
    let on_the_way = |reason| (RunStage::OnTheWay, reason);
    command(world, &ArmCommand::OpenTo(grasp.opening_m)).map_err(on_the_way)?;
    follow(world, &transport.reached.path).map_err(on_the_way)?;
    command(world, &straight(&grasp.plan_from_tool)).map_err(on_the_way)?;
    let not_held = |reason| (RunStage::NotHeld, reason);
    let closed = command(world, &ArmCommand::Close).map_err(not_held)?;
    if closed.holds != Some(object) {
        return Err(not_held("the fingers do not hold it".to_owned()));
    }
    let carrying = |reason| (RunStage::Carrying, reason);
    command(world, &straight(&(up * grasp.plan_from_tool))).map_err(carrying)?;
    follow(world, &transport.path).map_err(carrying)?;
    let placement = &transport.placement;
    let down = command(world, &straight(&placement.plan_from_tool)).map_err(carrying)?;
    if down.holds != Some(object) {
        return Err(carrying("it was lost on the way".to_owned()));
    }
    let misplaced = |reason| (RunStage::Misplaced, reason);
    command(world, &ArmCommand::OpenTo(placement.opening_m)).map_err(misplaced)?;
    let back = Translation3::new(0.0, 0.0, -placement.way_m);
    command(world, &straight(&(placement.plan_from_tool * back))).map_err(misplaced)?;
    Ok(())
}

/// Moves the arm along a path.
fn follow(world: &mut World, path: &TransitPath) -> Result<(), String> {
    for joints in path.waypoints_rad.iter().skip(1) {
        command(world, &ArmCommand::MoveJoints((*joints).into()))?;
    }
    Ok(())
}
