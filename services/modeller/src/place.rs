//! `tabula place plan` and `tabula place list`: transport of an object to a place of the
//! configuration, and the places themselves.

mod place_document;
mod place_list;
mod place_text;

pub(crate) use place_list::run as run_list;

use crate::arguments::PlaceArguments;
use crate::arm_scene::{prepared, receive, seen_object};
use crate::grasp;
use arm_scene::ArmScene;
use command_line::Output;
use control_client::TrackScope;
use grasp_scene::{PLACES_SECTION, PlaceConfig, Places, draw_transport};
use grasping::{Grasp, GraspSettings};
use place_document::PlaceDocument;
use service::{CommonArguments, Configuration, Failure, exit_code};
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;
use transport::Transport;

/// Plans the transport of an object; without one the exit code is that of a refusal.
pub(crate) fn run(
    common: &CommonArguments,
    arguments: &PlaceArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let (stop, configuration) = prepared(common, arguments.picture.as_deref())?;
    let places = places(&configuration)?;
    let track = arguments.track.resolve(common, TrackScope::LOOK, None)?;
    let Some(arm_scene) = receive(common, &configuration, &stop)? else {
        return Ok(ExitCode::SUCCESS);
    };
    let document = document(&arm_scene, track, (arguments, &places))?;
    output.answer(&document, || place_text::text(&document));
    Ok(if document.transport.is_none() {
        ExitCode::from(exit_code::REFUSED)
    } else {
        ExitCode::SUCCESS
    })
}

/// Places of the configuration.
fn places(configuration: &Configuration) -> Result<Places, Failure> {
    let by_name = configuration.section(PLACES_SECTION)?;
    let wrong = |cause: String| configuration.wrong(PLACES_SECTION, &[], cause);
    Ok(Places::checked(by_name).map_err(wrong)?)
}

/// Place that was asked for, or that of the object's category.
fn chosen<'a>(
    places: &'a Places,
    given: Option<&'a str>,
    label: Option<&str>,
) -> Result<(&'a str, &'a PlaceConfig), Failure> {
    let refused = |sentence: String| Failure::new(exit_code::REFUSED, sentence);
    if places.iter().next().is_none() {
        return Err(refused(
            "no place is known; write [places.NAME] into the configuration, see `tabula config \
             explain places.NAME.outline`"
                .to_owned(),
        ));
    }
    let name = given.or_else(|| places.of_category(label)).ok_or_else(|| {
        let what = label.map_or_else(
            || "an unknown object".to_owned(),
            |label| format!("a {label}"),
        );
        refused(format!(
            "no place has {what}; name one with --at, `tabula place list` shows them"
        ))
    })?;
    let place = places.get(name).ok_or_else(|| {
        let known: Vec<&str> = places.iter().map(|(name, _)| name).collect();
        refused(format!(
            "there is no place {name:?}; the places are {}",
            known.join(", ")
        ))
    })?;
    Ok((name, place))
}

fn document(
    arm_scene: &ArmScene,
    track: u64,
    (arguments, places): (&PlaceArguments, &Places),
) -> Result<PlaceDocument, Failure> {
    let begun = Instant::now();
    let object = seen_object(arm_scene, track)?;
    let label = arm_scene.snapshot.objects[object].label.as_deref();
    let (name, place) = chosen(places, arguments.at.as_deref(), label)?;
    let mut document = PlaceDocument::new(&arm_scene.snapshot, object, name);
    document.notes.clone_from(&arm_scene.notes);
    let scene = arm_scene.scene();
    let grasps = arm_scene.grasps(&scene, object, &GraspSettings::default());
    let area = place.area(name, &arm_scene.frame);
    let planned = arm_scene.transport(&scene, object, &grasps, &area);
    if let Some((transport, placed)) = planned.as_ref().ok().zip(arm_scene.arm.as_ref()) {
        document.set(transport, &grasps, (&arm_scene.frame, &placed.arm));
    }
    document.sentence = planned.as_ref().err().map(|reason| {
        let why_no_grasp = grasps.why_none(&scene, track);
        why_no_grasp.unwrap_or_else(|| reason.words(&scene, Some(&area)))
    });
    if let Some(file) = &arguments.picture {
        draw(
            arm_scene,
            object,
            planned
                .as_ref()
                .ok()
                .map(|planned| (planned, &grasps.grasps[planned.reached.grasp])),
            file,
        )?;
    }
    document.processing_ms = 1e3 * begun.elapsed().as_secs_f64();
    Ok(document)
}

/// Writes a picture of an object and its transport by a grasp.
fn draw(
    arm_scene: &ArmScene,
    object: usize,
    planned: Option<(&Transport, &Grasp)>,
    file: &Path,
) -> Result<(), Failure> {
    let Some(placed) = &arm_scene.arm else {
        return grasp::draw(arm_scene, object, None, file);
    };
    let rgb = draw_transport(
        &arm_scene.snapshot,
        &arm_scene.frame,
        placed,
        object,
        planned,
    );
    grasp::write_picture(arm_scene, &rgb, file)
}
