//! `tabula grasp plan`: grasps of an object, by what the camera shows of it.

mod arm_and_people;
mod grasp_document;
mod grasp_text;

use crate::arguments::GraspArguments;
use crate::awaited_snapshot::awaited_snapshot;
use crate::png_file;
use crate::presence::require_daemon;
use arm_and_people::ArmAndPeople;
use arm_kinematics::GripperModel;
use channel::{Domain, Role, RunFolder};
use command_line::{Output, StopSignal};
use control_client::TrackScope;
use grasp_document::GraspDocument;
use grasp_scene::{draw_grasp, grasp_scene};
use grasping::{GraspPlanner, Obstacles};
use scene_client::{DaemonModels, ModelShelf, PlanningFrame, Snapshot, SnapshotReceiver};
use service::{CommonArguments, Configuration, Failure, exit_code};
use std::process::ExitCode;
use std::time::Instant;

/// Section of the configuration with the gripper.
const GRIPPER_SECTION: &str = "gripper";

/// Plans the grasps of an object; without any the exit code is that of a refusal.
pub(crate) fn run(
    common: &CommonArguments,
    arguments: &GraspArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    if let Some(file) = &arguments.picture {
        dataset::check_output(file).map_err(Failure::usage)?;
    }
    let stop = StopSignal::install()?;
    let gripper = gripper(common)?;
    require_daemon(&common.domain)?;
    let track = arguments.track.resolve(common, TrackScope::LOOK, None)?;
    let domain = Domain::join(&common.domain, &RunFolder::of_user(), Role::Guest)?;
    let mut receiver = SnapshotReceiver::new(&domain)?;
    let mut bodies = ArmAndPeople::new(&domain)?;
    let Some(snapshot) = awaited_snapshot(&mut receiver, &stop)? else {
        return Ok(ExitCode::SUCCESS);
    };
    bodies.receive()?;
    let document = planned(&snapshot, track, (common, arguments), (&gripper, &bodies))?;
    output.answer(&document, || grasp_text::text(&document));
    Ok(if document.grasps.is_empty() {
        ExitCode::from(exit_code::REFUSED)
    } else {
        ExitCode::SUCCESS
    })
}

/// Gripper of the configuration.
fn gripper(common: &CommonArguments) -> Result<GripperModel, Failure> {
    let found = Configuration::find(common.config.as_deref(), common.home().path())?;
    Ok(found.section(GRIPPER_SECTION)?)
}

fn planned(
    snapshot: &Snapshot,
    track: u64,
    (common, arguments): (&CommonArguments, &GraspArguments),
    (gripper, bodies): (&GripperModel, &ArmAndPeople),
) -> Result<GraspDocument, Failure> {
    let begun = Instant::now();
    let object = seen_object(snapshot, track)?;
    let frame = PlanningFrame::of(snapshot)
        .ok_or_else(|| Failure::general("the image has no depth; see `tabula status`"))?;
    let mut notes = frame.notes.clone();
    let mut shelf = ModelShelf::default();
    if let Err(failure) = shelf.refresh(snapshot, || DaemonModels::connect(common)) {
        notes.push(format!("the stored models are not used: {failure}"));
    }
    let scene = grasp_scene(snapshot, &frame, &shelf, &bodies.in_world);
    let obstacles = Obstacles::of(&scene);
    let arm = bodies.placed(*gripper, snapshot, &frame, &mut notes);
    let settings = arguments.settings();
    let planner = GraspPlanner {
        scene: &scene,
        obstacles: &obstacles,
        gripper,
        arm: arm.as_ref(),
        settings: &settings,
    };
    let plan = planner.plan(object);
    if let Some(file) = &arguments.picture {
        let rgb = draw_grasp(snapshot, &frame, gripper, Some(object), plan.grasps.first());
        let camera = &snapshot.camera;
        png_file::write(file, camera.width as usize, camera.height as usize, &rgb)?;
    }
    let mut document = grasp_document::document(snapshot, object, (&scene, &plan), &frame);
    document.notes = notes;
    document.processing_ms = 1e3 * begun.elapsed().as_secs_f64();
    Ok(document)
}

/// Index of the object of a track that is seen.
fn seen_object(snapshot: &Snapshot, track: u64) -> Result<usize, Failure> {
    let mut objects = snapshot.objects.iter();
    let index = objects.position(|object| object.track == track);
    let index = index.filter(|index| !snapshot.objects[*index].points.is_empty());
    index.ok_or_else(|| {
        let sentence = format!(
            "object {track} is not seen in this frame, so that nothing can be said about grasps; see \
             `tabula objects`"
        );
        Failure::new(exit_code::REFUSED, sentence)
    })
}
