//! Documents of support surfaces, with the objects that they carry.

use super::rounding::rounded;
use crate::{RejectedCandidate, SceneObject, SceneSummary, SurfaceKind, WireSurface};
use nalgebra::{Point3, Vector3};
use scene_document::SurfaceDocument;

/// Greatest depth of the base of an object below the surface that carries it, metres: boxes and
/// planes are off by the error of the camera's pose. Chosen.
const BELOW_MAX_M: f64 = 0.05;

/// Documents of the surfaces of a scene, each with the objects on and over it.
pub(super) fn surfaces(scene: &SceneSummary, objects: &[SceneObject]) -> Vec<SurfaceDocument> {
    let valid = scene.surfaces().iter();
    let mut documents: Vec<SurfaceDocument> = valid.filter_map(document).collect();
    for object in objects {
        if let Some(surface) = carrier(scene, object) {
            documents[surface].track_ids.push(object.track_id);
        }
    }
    documents
}

fn document(surface: &WireSurface) -> Option<SurfaceDocument> {
    let kind = surface.checked_kind()?;
    let [x, y, z, offset_m] = surface.plane;
    let corners = surface.corners_m().iter();
    let finite = corners.filter(|corner| corner.iter().all(|value| value.is_finite()));
    Some(SurfaceDocument {
        kind: kind.word().to_owned(),
        normal: [x, y, z],
        offset_m,
        outline_m: finite.map(|corner| corner.map(rounded)).collect(),
        n_samples: surface.n_samples,
        track_ids: Vec::new(),
    })
}

/// Highest surface that carries objects under an object, by its number among the valid ones;
/// `None` without one.
pub fn carrier(scene: &SceneSummary, object: &SceneObject) -> Option<usize> {
    let pose = object.pose.checked()?;
    let half_sides = object.size_m.map(|side| 0.5 * f64::from(side));
    let base_m = |surface: &WireSurface| {
        let [x, y, z, offset_m] = surface.plane;
        let normal = Vector3::new(x, y, z);
        let in_box = pose.rotation.inverse() * normal;
        let reach_m: f64 = (0..3)
            .map(|axis| in_box[axis].abs() * half_sides[axis])
            .sum();
        normal.dot(&(pose * Point3::origin()).coords) + offset_m - reach_m
    };
    let valid = scene
        .surfaces()
        .iter()
        .filter_map(|one| Some((one, one.checked_kind()?)));
    let under = valid
        .enumerate()
        .filter(|(_, (_, kind))| kind.carries_objects());
    let under = under.map(|(number, (surface, _))| (number, base_m(surface)));
    let under = under.filter(|(_, base_m)| *base_m >= -BELOW_MAX_M);
    under
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(number, _)| number)
}

/// Name of the surface of a rejected candidate in a sentence: "the table", or another level by its
/// height over or under the table at the candidate.
pub(super) fn name(scene: &SceneSummary, candidate: &RejectedCandidate) -> String {
    let table = || "the table".to_owned();
    let valid = |surface: Option<&WireSurface>| {
        surface.and_then(|surface| Some((surface.checked_kind()?, surface.plane)))
    };
    let of_table = valid(scene.surfaces().first());
    let of_candidate = valid(scene.surfaces().get(candidate.surface as usize));
    let (Some((_, lower)), Some((kind, upper))) = (of_table, of_candidate) else {
        return table();
    };
    let place = Point3::from(candidate.pose.position_m);
    let height_m =
        |[x, y, z, offset_m]: [f64; 4]| Vector3::new(x, y, z).dot(&place.coords) + offset_m;
    let gap_cm = 100.0 * (height_m(lower) - height_m(upper));
    match kind {
        SurfaceKind::Table => table(),
        _ if !gap_cm.is_finite() => format!("another {}", kind.word()),
        _ if gap_cm < 0.0 => format!("the level {:.0} cm below the table", -gap_cm),
        _ => format!("the level {gap_cm:.0} cm above the table"),
    }
}
