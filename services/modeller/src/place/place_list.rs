//! `tabula place list`: places of the configuration, with their surfaces and the arm's reach.

use super::places;
use crate::arm_scene::{prepared, receive};
use arm_scene::ArmScene;
use command_line::{Output, format_table};
use grasp_scene::PlaceConfig;
use grasping::{GraspScene, PlacedArm};
use serde::Serialize;
use service::{CommonArguments, Failure};
use std::process::ExitCode;
use transport::{PlaceArea, reached_share};

/// JSON document of `tabula place list`.
#[derive(Serialize)]
struct PlaceListDocument {
    places: Vec<PlaceRow>,
    notes: Vec<String>,
}

/// One place.
#[derive(Serialize)]
struct PlaceRow {
    name: String,
    categories: Vec<String>,
    /// Corners in the world.
    outline_m: Vec<[f64; 2]>,
    /// Surface that is seen there; `None` when none is.
    surface: Option<String>,
    /// Height of that surface in the world.
    height_m: Option<f64>,
    /// Share of the area over whose surface the arm reaches, 0 to 1; `None` without an arm or a
    /// surface.
    reached: Option<f64>,
}

/// Runs `tabula place list`.
pub(crate) fn run(common: &CommonArguments, output: &Output) -> Result<ExitCode, Failure> {
    let (stop, configuration) = prepared(common, None)?;
    let places = places(&configuration)?;
    let Some(arm_scene) = receive(common, &configuration, &stop)? else {
        return Ok(ExitCode::SUCCESS);
    };
    let scene = arm_scene.scene();
    let rows = places
        .iter()
        .map(|(name, place)| row(name, place, (&arm_scene, &scene)));
    let document = PlaceListDocument {
        places: rows.collect(),
        notes: arm_scene.notes.clone(),
    };
    output.answer(&document, || text(&document));
    Ok(ExitCode::SUCCESS)
}

fn row(
    name: &str,
    place: &PlaceConfig,
    (arm_scene, scene): (&ArmScene, &GraspScene<'_>),
) -> PlaceRow {
    let area = place.area(name, &arm_scene.frame);
    let surface = area.surface(scene);
    let height_m = surface.map(|(_, middle)| (arm_scene.frame.world_from_plan * middle).z);
    let reached = |placed: &PlacedArm, area: &PlaceArea| reached_share(placed, area, scene);
    PlaceRow {
        name: name.to_owned(),
        categories: place.categories.clone(),
        outline_m: place.outline.clone(),
        surface: surface.map(|(index, _)| scene.surfaces[index].name.clone()),
        height_m,
        reached: surface
            .and(arm_scene.arm.as_ref())
            .map(|placed| reached(placed, &area)),
    }
}

fn text(document: &PlaceListDocument) -> String {
    let notes = document.notes.iter().map(|note| format!("note: {note}"));
    if document.places.is_empty() {
        let none = "no place is known; write [places.NAME] into the configuration".to_owned();
        return std::iter::once(none)
            .chain(notes)
            .collect::<Vec<_>>()
            .join("\n");
    }
    let header = ["place", "for", "surface", "height (m)", "in reach"];
    let rows = document.places.iter().map(|place| {
        vec![
            place.name.clone(),
            place.categories.join(", "),
            place
                .surface
                .clone()
                .unwrap_or_else(|| "not seen".to_owned()),
            place
                .height_m
                .map_or_else(String::new, |m| format!("{m:.3}")),
            place
                .reached
                .map_or_else(String::new, |share| format!("{:.0} %", 100.0 * share)),
        ]
    });
    let table = format_table(&header, &rows.collect::<Vec<_>>());
    std::iter::once(table)
        .chain(notes)
        .collect::<Vec<_>>()
        .join("\n")
}
