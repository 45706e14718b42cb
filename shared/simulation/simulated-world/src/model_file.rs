//! Import of model files: validation, scaling and convex decomposition.

use crate::error::Error;
use crate::glam_conversion::point_to_glam;
use crate::model_import::{FileFrame, ModelImport};
use crate::object_model::{ModelOrigin, ObjectModel, compound_shape, half_sides};
use mesh::{ConvexPart, Surface, Triangle, TriangleMesh, Vertex};
use nalgebra::{Point3, Vector3};
use rapier3d::parry::transformation::vhacd::{VHACD, VHACDParameters};
use std::path::{Path, PathBuf};

/// Greatest number of triangles of a model; finer meshes are decimated. Chosen.
const TRIANGLES_MAX: usize = 20_000;
/// Number of triangles of the mesh that is decomposed into convex parts. Chosen.
const TRIANGLES_FOR_PARTS: usize = 2_000;
/// Least ratio of the shortest to the longest side; thinner meshes are rejected as flat. Chosen.
const FLAT_SHARE: f32 = 1e-3;
/// Crease angle: sharper edges keep separate normals, radians. Chosen.
const CREASE_RAD: f32 = 0.9;
/// Mean density of the convex parts, kg/m³; most objects are hollow. Chosen.
const DENSITY_KG_M3: f64 = 300.0;
/// Limits of the estimated mass, kilograms. Chosen.
const MASS_RANGE_KG: [f64; 2] = [0.01, 3.0];
/// Coulomb friction coefficient of imported models. Chosen.
const FRICTION: f64 = 0.5;
/// Voxel resolution of the convex decomposition along the longest side. Chosen.
const PARTS_RESOLUTION: u32 = 32;
/// Concavity that is left undivided, as a share of the size. Chosen.
const PARTS_CONCAVITY: f32 = 0.02;

/// Model files of a folder in natural order.
pub(crate) fn list(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    let models =
        dataset::model_folder::list(folder).map_err(|error| Error::unreadable(folder, &error))?;
    Ok(models.into_iter().map(|model| model.path).collect())
}

/// Sentence about the models of a folder in formats that are not read; `None` if there are none.
///
/// # Errors
/// [`Error::Unreadable`] for a folder that cannot be read.
pub(crate) fn unread_note(folder: &Path) -> Result<Option<String>, Error> {
    let unread =
        dataset::model_folder::unread(folder).map_err(|error| Error::unreadable(folder, &error))?;
    let Some(first) = unread.first() else {
        return Ok(None);
    };
    let and_others = match unread.len() {
        1 => "is".to_owned(),
        n => format!("and {} others are", n - 1),
    };
    Ok(Some(format!(
        "the model {first} {and_others} left out: only PLY, OBJ, STL and DAE are read; convert the others"
    )))
}

/// Imports a model: turns it upright, scales it to metres, centres it and decomposes it into convex
/// parts. Adds one sentence per change to `notes`.
///
/// # Errors
/// [`Error::Unreadable`] or [`Error::Model`] for an unusable file.
pub(crate) fn open(
    path: &Path,
    import: ModelImport,
    notes: &mut Vec<String>,
) -> Result<ObjectModel, Error> {
    let model =
        dataset::model_folder::open(path).map_err(|error| Error::unreadable(path, &error))?;
    let frame = FileFrame {
        unit_m: model.unit_m,
        up: model.up,
        may_be_y_up: path
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("obj")),
    };
    let read = model.mesh;
    let (category, name) = category_and_name(path);
    let wrong = |cause: String| Error::Model {
        name: path.display().to_string(),
        cause,
    };
    let note = |text: String| format!("the model {name}: {text}");
    let mut mesh = valid_faces(&read);
    if mesh.triangles.is_empty() {
        return Err(wrong(
            "it has no faces; export it as a triangle mesh".into(),
        ));
    }
    notes.extend(model.notes.into_iter().map(note));
    notes.extend(clean(&mut mesh).into_iter().map(note));
    let n_whole = mesh.triangles.len();
    let mut mesh = mesh.decimate(TRIANGLES_MAX);
    if n_whole > TRIANGLES_MAX {
        notes.push(note(format!(
            "its {n_whole} triangles were reduced to {}",
            mesh.triangles.len()
        )));
    }
    let guessed = import.apply(&mut mesh, frame).map_err(wrong)?;
    notes.extend(guessed.into_iter().map(note));
    let sides = mesh
        .bounds()
        .map_or_else(Vector3::zeros, |bounds| bounds.sides());
    if sides.min() < FLAT_SHARE * sides.max() {
        return Err(wrong("it is flat; an object needs three dimensions".into()));
    }
    notes.extend(surface_faults(&mesh).into_iter().map(note));
    mesh.recentre();
    mesh.smooth_normals(CREASE_RAD);
    let parts = convex_decomposition(&mesh);
    let shape =
        compound_shape(&parts).ok_or_else(|| wrong("none of its parts has a volume".into()))?;
    let volume_m3 = f64::from(shape.mass_properties(1.0).mass());
    Ok(ObjectModel {
        category,
        name: name.clone(),
        origin: ModelOrigin::File(path.to_owned()),
        half_sides_m: half_sides(&mesh),
        mass_kg: (volume_m3 * DENSITY_KG_M3).clamp(MASS_RANGE_KG[0], MASS_RANGE_KG[1]),
        friction: FRICTION,
        mesh,
        convex_parts: parts,
        shape,
    })
}

/// Welds the vertices and drops doubled faces; returns a sentence if there were any.
pub(crate) fn clean(mesh: &mut TriangleMesh) -> Option<String> {
    mesh.weld();
    let n_dropped = mesh.drop_doubled_faces();
    (n_dropped > 0).then(|| format!("its {n_dropped} doubled faces were dropped"))
}

/// Surface defects: open and non-manifold edges, one sentence each.
fn surface_faults(mesh: &TriangleMesh) -> Vec<String> {
    let found = mesh.diagnostics();
    let mut faults = Vec::new();
    if found.n_boundary_edges > 0 {
        faults.push(format!(
            "its surface has holes, {} open edges; one sees through them",
            found.n_boundary_edges
        ));
    }
    if found.n_non_manifold_edges > 0 {
        faults.push(format!(
            "its surface is not manifold, {} edges have more than two faces; it is used as it is",
            found.n_non_manifold_edges
        ));
    }
    faults
}

/// Category and name of a model file: `mug` and `025_mug` for `025_mug.ply`; `b-cups` for
/// `065-b_cups.ply`, whose letter tells it from the other cups. A category name consists of lower
/// case letters, digits and hyphens.
pub(crate) fn category_and_name(path: &Path) -> (String, String) {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let plain = |c: char| {
        if c.is_ascii_alphanumeric() {
            c.to_ascii_lowercase()
        } else {
            '-'
        }
    };
    let (_, name) = dataset::model_folder::number_and_name(&stem);
    let category = name.chars().map(plain).collect();
    (category, stem.into_owned())
}

/// Mesh of the valid faces: existing, finite corners and a positive area.
pub(crate) fn valid_faces(read: &dataset::mesh::Mesh) -> TriangleMesh {
    let vertices = read.vertices.iter().map(|point| Vertex {
        position: Point3::new(point.x, point.y, point.z),
        normal: Vector3::z(),
        color: point.color.rgb(),
    });
    let is_finite = |&index: &u32| {
        let corner = read.vertices.get(index as usize);
        corner.is_some_and(point_cloud::Point::is_finite)
    };
    let corner = |index: u32| read.vertices[index as usize].position();
    let has_area = |t: &&[u32; 3]| {
        let [a, b, c] = t.map(corner);
        (b - a).cross(&(c - a)).norm() > 0.0
    };
    let triangles = read.triangles.iter();
    let triangles = triangles
        .filter(|t| t.iter().all(is_finite))
        .filter(has_area);
    TriangleMesh {
        vertices: vertices.collect(),
        triangles: triangles
            .map(|&vertices| Triangle {
                vertices,
                surface: 0,
            })
            .collect(),
        surfaces: vec![Surface::MATTE],
    }
}

/// Convex decomposition for the physics (Mamou 2016, volumetric).
fn convex_decomposition(mesh: &TriangleMesh) -> Vec<ConvexPart> {
    let coarse = mesh.decimate(TRIANGLES_FOR_PARTS);
    let points: Vec<_> = coarse
        .vertices
        .iter()
        .map(|v| point_to_glam(&v.position))
        .collect();
    let triangles: Vec<[u32; 3]> = coarse.triangles.iter().map(|t| t.vertices).collect();
    let parameters = VHACDParameters {
        resolution: PARTS_RESOLUTION,
        concavity: PARTS_CONCAVITY,
        max_convex_hulls: 24,
        ..VHACDParameters::default()
    };
    let found = VHACD::decompose(&parameters, &points, &triangles, false);
    let hulls = found.compute_convex_hulls(1);
    let hulls = hulls.into_iter().map(|(points, _)| {
        ConvexPart::around(points.iter().map(|p| Point3::new(p.x, p.y, p.z)).collect())
    });
    mesh::simplify_contact_faces(hulls.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn category_is_the_file_name_without_its_number() {
        for (file, category) in [
            ("025_mug.ply", "mug"),
            ("065-b_cups.ply", "b-cups"),
            ("0012.obj", "0012"),
            ("3d_puzzle.ply", "3d-puzzle"),
            ("Tea Cup.ply", "tea-cup"),
            ("12-mug.stl", "mug"),
        ] {
            assert_eq!(category_and_name(Path::new(file)).0, category);
        }
    }
}
