//! `tabula grasp plan`: grasps of an object, by what the camera shows of it.

pub(crate) mod grasp_document;
mod grasp_text;

use crate::arguments::GraspArguments;
use crate::arm_scene::{prepared, receive, seen_object};
use crate::png_file;
use crate::transit_document;
use arm_scene::ArmScene;
use command_line::Output;
use control_client::TrackScope;
use grasp_document::GraspDocument;
use grasp_scene::draw_grasp;
use grasping::{Grasp, GraspPlan, GraspScene};
use service::{CommonArguments, Failure, exit_code};
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;
use transport::ReachedGrasp;

/// Plans the grasps of an object; without any the exit code is that of a refusal.
pub(crate) fn run(
    common: &CommonArguments,
    arguments: &GraspArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let (stop, configuration) = prepared(common, arguments.picture.as_deref())?;
    let track = arguments.track.resolve(common, TrackScope::LOOK, None)?;
    let Some(arm_scene) = receive(common, &configuration, &stop)? else {
        return Ok(ExitCode::SUCCESS);
    };
    let document = document(&arm_scene, track, arguments)?;
    output.answer(&document, || grasp_text::text(&document));
    Ok(if document.grasps.is_empty() {
        ExitCode::from(exit_code::REFUSED)
    } else {
        ExitCode::SUCCESS
    })
}

fn document(
    arm_scene: &ArmScene,
    track: u64,
    arguments: &GraspArguments,
) -> Result<GraspDocument, Failure> {
    let begun = Instant::now();
    let object = seen_object(arm_scene, track)?;
    let scene = arm_scene.scene();
    let mut plan = arm_scene.grasps(&scene, object, &arguments.settings());
    let mut notes = arm_scene.notes.clone();
    let reached = reached(arm_scene, &scene, &mut plan, &mut notes);
    if let Some(file) = &arguments.picture {
        draw(arm_scene, object, plan.grasps.first(), file)?;
    }
    let snapshot = &arm_scene.snapshot;
    let mut document =
        grasp_document::document(snapshot, object, (&scene, &plan), &arm_scene.frame);
    document.path = reached
        .zip(arm_scene.arm.as_ref())
        .map(|(reached, placed)| transit_document::path(&reached.path, &placed.arm));
    document.notes = notes;
    document.processing_ms = 1e3 * begun.elapsed().as_secs_f64();
    Ok(document)
}

/// First grasp to which the arm finds a way, which becomes the first of the plan. Notes tell where it
/// was not the best one, or where there is none.
fn reached(
    arm_scene: &ArmScene,
    scene: &GraspScene<'_>,
    plan: &mut GraspPlan,
    notes: &mut Vec<String>,
) -> Option<ReachedGrasp> {
    if arm_scene.arm.is_none() || plan.grasps.is_empty() {
        return None;
    }
    match arm_scene.reach(scene, &plan.grasps) {
        Ok(reached) => {
            if reached.grasp > 0 {
                notes.push(format!(
                    "the arm finds no way to the {} grasps with better scores",
                    reached.grasp
                ));
                plan.grasps[..=reached.grasp].rotate_right(1);
            }
            Some(reached)
        }
        Err(reason) => {
            notes.push(reason.words(scene, None));
            None
        }
    }
}

/// Writes a picture of an object and of a grasp.
pub(crate) fn draw(
    arm_scene: &ArmScene,
    object: usize,
    grasp: Option<&Grasp>,
    file: &Path,
) -> Result<(), Failure> {
    let (snapshot, gripper) = (&arm_scene.snapshot, &arm_scene.gripper);
    let rgb = draw_grasp(snapshot, &arm_scene.frame, gripper, Some(object), grasp);
    write_picture(arm_scene, &rgb, file)
}

/// Writes a picture of the size of the camera's image, three bytes a pixel.
pub(crate) fn write_picture(arm_scene: &ArmScene, rgb: &[u8], file: &Path) -> Result<(), Failure> {
    let camera = &arm_scene.snapshot.camera;
    png_file::write(file, camera.width as usize, camera.height as usize, rgb)
}
