//! Documents of support surfaces, with the objects that they carry.

use super::rounding::rounded;
use crate::{SceneObject, SceneSummary, WireSurface};
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
fn carrier(scene: &SceneSummary, object: &SceneObject) -> Option<usize> {
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
