//! Tests of model files: accepted, repaired with a note, or rejected with a message.

#![expect(clippy::unwrap_used, reason = "a failing set-up must fail the test")]

use dataset::mesh::MeshView;
use dataset::ply::{self, Encoding};
use point_cloud::{Point, Rgba};
use simulated_world::{
    ModelChoice, ModelLibrary, ModelSource, ObjectModel, ObjectPlacement, ObjectPlan, ObjectState,
    Scene, SceneKind, World,
};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tempfile::TempDir;

fn vertex([x, y, z]: [f32; 3]) -> Point {
    Point {
        x,
        y,
        z,
        color: Rgba::opaque(180, 40, 40),
    }
}

/// Corners and faces of a box around the origin.
fn cuboid(sides: [f32; 3]) -> (Vec<Point>, Vec<[u32; 3]>) {
    let side = |i: usize, axis: usize| (if i >> axis & 1 == 0 { -0.5 } else { 0.5 }) * sides[axis];
    let corners = (0..8).map(|i| vertex([side(i, 0), side(i, 1), side(i, 2)]));
    let faces = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let triangles = faces
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    (corners.collect(), triangles.collect())
}

/// Sphere mesh with this number of rings and segments.
fn ball(radius: f32, n_rings: u32, n_segments: u32) -> (Vec<Point>, Vec<[u32; 3]>) {
    let at = |ring: u32, segment: u32| {
        let up = (ring as f32 / n_rings as f32 - 0.5) * std::f32::consts::PI;
        let around = segment as f32 / n_segments as f32 * std::f32::consts::TAU;
        vertex([
            radius * up.cos() * around.cos(),
            radius * up.cos() * around.sin(),
            radius * up.sin(),
        ])
    };
    let mut vertices = vec![at(0, 0), at(n_rings, 0)];
    for ring in 1..n_rings {
        vertices.extend((0..n_segments).map(|segment| at(ring, segment)));
    }
    let index = |ring: u32, segment: u32| match ring {
        0 => 0,
        ring if ring == n_rings => 1,
        ring => 2 + (ring - 1) * n_segments + segment % n_segments,
    };
    let cells = (0..n_rings).flat_map(|ring| (0..n_segments).map(move |segment| (ring, segment)));
    let triangles = cells.flat_map(|(ring, segment)| {
        let [a, b] = [index(ring, segment), index(ring, segment + 1)];
        let [c, d] = [index(ring + 1, segment), index(ring + 1, segment + 1)];
        [[a, b, d], [a, d, c]]
    });
    let has_area = |t: &[u32; 3]| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
    (vertices, triangles.filter(has_area).collect())
}

fn ply_bytes((vertices, triangles): &(Vec<Point>, Vec<[u32; 3]>)) -> Vec<u8> {
    let view = MeshView {
        vertices,
        triangles,
    };
    ply::write(view, Encoding::BinaryLittleEndian).unwrap()
}

fn file(folder: &TempDir, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

/// Loads a model; returns its notes, or the error message.
fn load(path: &Path) -> Result<(Arc<ObjectModel>, String), String> {
    let mut library = ModelLibrary::generated();
    let model = library.load(&ModelChoice::File(path.to_owned()));
    let model = model.map_err(|error| error.to_string())?;
    Ok((model, library.take_notes().join("\n")))
}

fn assert_refused(path: &Path, expected: &str) {
    let message = load(path).unwrap_err();
    let name = path.file_name().unwrap().to_string_lossy();
    assert!(
        message.contains(&*name) && message.contains(expected),
        "{message}"
    );
}

/// World with this model put down in the middle of the table.
fn world_with(path: &Path) -> World {
    let scene = Scene {
        objects: vec![ObjectPlan {
            model: ModelChoice::File(path.to_owned()),
            placement: ObjectPlacement::Upright {
                position_m: [0.0, 0.0],
                yaw_rad: 0.0,
                raised_m: 0.0,
            },
        }],
        ..Scene::default()
    };
    World::new(scene, ModelLibrary::generated()).unwrap()
}

#[test]
fn model_in_metres_is_unchanged_and_settles() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, "007_Red Cube.ply", ply_bytes(&cuboid([0.06; 3])));
    let (model, notes) = load(&path).unwrap();
    assert_eq!(notes, "");
    assert_eq!(model.name, "007_Red Cube");
    assert_eq!(model.category, "red-cube");
    assert!((model.half_sides_m.max() - 0.03).abs() < 1e-6);
    let world = world_with(&path);
    let object = &world.objects()[0];
    assert_eq!(object.state, ObjectState::Settled);
    let height_m = object.world_from_object.translation.z - world.scene().table.height_m;
    assert!((height_m - 0.03).abs() < 0.002, "{height_m}");
}

#[test]
fn model_in_millimetres_is_scaled_and_centred_with_a_note() {
    let folder = tempfile::tempdir().unwrap();
    let (mut vertices, triangles) = cuboid([60.0, 40.0, 80.0]);
    for vertex in &mut vertices {
        vertex.x += 500.0;
    }
    let path = file(&folder, "box.ply", ply_bytes(&(vertices, triangles)));
    let (model, notes) = load(&path).unwrap();
    assert!(notes.contains("millimetres"), "{notes}");
    let expected = nalgebra::Vector3::new(0.03, 0.02, 0.04);
    assert!((model.half_sides_m - expected).norm() < 1e-5);
}

#[test]
fn model_with_an_open_mesh_is_accepted_with_a_note() {
    let folder = tempfile::tempdir().unwrap();
    let (vertices, mut triangles) = cuboid([0.08; 3]);
    triangles.truncate(10);
    let path = file(&folder, "open.ply", ply_bytes(&(vertices, triangles)));
    let (_, notes) = load(&path).unwrap();
    assert!(notes.contains("holes"), "{notes}");
    assert_eq!(world_with(&path).objects()[0].state, ObjectState::Settled);
}

#[test]
fn model_from_an_obj_file_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let (vertices, triangles) = cuboid([0.05, 0.07, 0.1]);
    let mut text = String::new();
    for v in &vertices {
        writeln!(text, "v {} {} {}", v.x, v.y, v.z).unwrap();
    }
    for [a, b, c] in &triangles {
        writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1).unwrap();
    }
    let path = file(&folder, "brick.obj", text);
    let (model, notes) = load(&path).unwrap();
    assert_eq!(notes, "");
    assert!((model.half_sides_m.z - 0.05).abs() < 1e-6);
}

/// Binary STL of these triangles.
fn stl_bytes((vertices, triangles): &(Vec<Point>, Vec<[u32; 3]>)) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for corners in triangles {
        bytes.extend([0; 12]);
        let corners = corners.map(|i| vertices[i as usize]);
        let numbers = corners.iter().flat_map(|v| [v.x, v.y, v.z]);
        bytes.extend(numbers.flat_map(f32::to_le_bytes));
        bytes.extend([0; 2]);
    }
    bytes
}

#[test]
fn model_from_an_stl_file_is_closed_and_grey() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(
        &folder,
        "brick.stl",
        stl_bytes(&cuboid([50.0, 70.0, 100.0])),
    );
    let (model, notes) = load(&path).unwrap();
    assert!(
        notes.contains("millimetres") && notes.lines().count() == 1,
        "{notes}"
    );
    assert!(model.mesh.diagnostics().is_sound());
    assert!(model.mesh.vertices.iter().all(|v| v.color == [128; 3]));
}

#[test]
fn model_of_doubled_faces_is_reduced_with_a_note() {
    let folder = tempfile::tempdir().unwrap();
    let (vertices, triangles) = ball(0.05, 160, 128);
    let n = triangles.len();
    assert!(n > 40_000);
    let twice = triangles
        .iter()
        .flat_map(|&[a, b, c]| [[a, b, c], [b, c, a]]);
    let soup = (vertices.clone(), twice.collect());
    let (model, notes) = load(&file(&folder, "twice.stl", stl_bytes(&soup))).unwrap();
    assert!(
        notes.contains(&format!("its {n} doubled faces were dropped")),
        "{notes}"
    );
    let (single, expected) = load(&file(
        &folder,
        "once.stl",
        stl_bytes(&(vertices, triangles)),
    ))
    .unwrap();
    // Apart from the doubled faces there is nothing to tell but what there is of the single ones.
    let rest = notes
        .lines()
        .skip(1)
        .map(|line| line.replace("twice", "once"));
    assert_eq!(rest.collect::<Vec<_>>().join("\n"), expected);
    assert_eq!(model.mesh.triangles.len(), single.mesh.triangles.len());
    let [volume, expected] = [&model, &single].map(|model| model.mesh.signed_volume());
    assert!(
        (volume / expected - 1.0).abs() < 1e-3,
        "{volume} {expected}"
    );
}

#[test]
fn model_with_a_million_triangles_is_decimated_with_a_note() {
    let folder = tempfile::tempdir().unwrap();
    let fine = ball(0.05, 600, 1001);
    assert!(fine.1.len() > 1_190_000);
    let path = file(&folder, "ball.ply", ply_bytes(&fine));
    let (model, notes) = load(&path).unwrap();
    assert!(notes.contains("were reduced to"), "{notes}");
    assert!(model.mesh.triangles.len() <= 20_000);
    assert!(model.mesh.triangles.len() > 2_000);
    for vertex in &model.mesh.vertices {
        let radius = vertex.position.coords.norm();
        assert!((radius - 0.05).abs() < 0.001, "{radius}");
    }
}

#[test]
fn model_file_without_an_object_is_rejected_with_a_message() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |name: &str, bytes: Vec<u8>, expected: &str| {
        assert_refused(&file(&folder, name, bytes), expected);
    };
    refused("tiny.ply", ply_bytes(&cuboid([1e-4; 3])), "longest side");
    refused("house.ply", ply_bytes(&cuboid([9e6; 3])), "longest side");
    let points = (cuboid([0.1; 3]).0, Vec::new());
    refused("points.ply", ply_bytes(&points), "no faces");
    let whole = ply_bytes(&cuboid([0.08; 3]));
    for share in [1, 2, 3] {
        let cut = whole[..whole.len() * share / 4].to_vec();
        refused(&format!("cut{share}.ply"), cut, "cannot be read");
    }
    refused("text.ply", b"once upon a time\n".to_vec(), "cannot be read");
    refused("empty.ply", Vec::new(), "cannot be read");
    refused("picture.jpg", whole, "cannot be read");
    refused("text.obj", b"once upon a time\n".to_vec(), "");
    assert_refused(&folder.path().join("missing.ply"), "cannot be read");
}

#[test]
fn model_with_a_flat_mesh_is_rejected() {
    let folder = tempfile::tempdir().unwrap();
    let sheet = ply_bytes(&cuboid([0.08, 0.08, 0.0]));
    assert_refused(&file(&folder, "flat.ply", sheet), "flat");
}

#[test]
fn model_vertices_that_are_not_finite_are_rejected_or_skipped() {
    let folder = tempfile::tempdir().unwrap();
    let (vertices, triangles) = cuboid([0.08; 3]);
    for bad in ["nan", "inf", "-inf", "1e39"] {
        let mut text = String::from(
            "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\n\
             property float z\nelement face 12\nproperty list uchar int vertex_indices\n\
             end_header\n",
        );
        for (i, v) in vertices.iter().enumerate() {
            let x = if i == 3 {
                bad.to_owned()
            } else {
                v.x.to_string()
            };
            writeln!(text, "{x} {} {}", v.y, v.z).unwrap();
        }
        for [a, b, c] in &triangles {
            writeln!(text, "3 {a} {b} {c}").unwrap();
        }
        match load(&file(&folder, "bad.ply", text)) {
            Ok((model, notes)) => {
                let vertices = &model.mesh.vertices;
                let is_finite = |v: &mesh::Vertex| v.position.iter().all(|x| x.is_finite());
                assert!(vertices.iter().all(is_finite), "{bad}");
                assert!(notes.contains("holes"), "{bad}: {notes}");
            }
            Err(message) => assert!(message.contains("bad.ply"), "{message}"),
        }
    }
}

#[test]
fn model_folder_is_listed_in_order_and_an_empty_one_is_rejected() {
    let folder = tempfile::tempdir().unwrap();
    let source = ModelSource::Folder(folder.path().to_owned());
    let message = ModelLibrary::open(&source).unwrap_err().to_string();
    assert!(message.contains("no models"), "{message}");
    for name in ["10_b.ply", "2_a.ply", "notes.txt"] {
        file(&folder, name, ply_bytes(&cuboid([0.05; 3])));
    }
    let library = ModelLibrary::open(&source).unwrap();
    let categories: Vec<_> = library
        .all(1, 0)
        .iter()
        .map(ModelChoice::category)
        .collect();
    assert_eq!(categories, ["a", "b"]);
    assert_eq!(library.choose(5, 3).len(), 5);
    let missing = ModelSource::Folder(folder.path().join("missing"));
    let message = ModelLibrary::open(&missing).unwrap_err().to_string();
    assert!(message.contains("missing"), "{message}");
}

/// Folder of scanned household models.
fn household_models() -> PathBuf {
    test_data::path("household-models")
}

#[test]
#[ignore = "needs TABULA_DATA"]
fn model_scans_form_a_crowded_table() {
    let source = ModelSource::Folder(household_models());
    let mut library = ModelLibrary::open(&source).unwrap();
    let scene = Scene::generate(SceneKind::Clutter, 15, 3, &mut library).unwrap();
    let is_file = |plan: &ObjectPlan| matches!(plan.model, ModelChoice::File(_));
    assert!(scene.objects.len() == 15 && scene.objects.iter().all(is_file));
    let world = World::new(scene, library).unwrap();
    let on_table = world.objects().iter();
    let n_on_table = on_table.filter(|o| o.state != ObjectState::OnFloor).count();
    assert!(n_on_table >= 13, "{n_on_table}");
}

#[test]
#[ignore = "needs TABULA_DATA"]
fn model_scans_load_in_metres_and_settle() {
    let source = ModelSource::Folder(household_models());
    let mut library = ModelLibrary::open(&source).unwrap();
    let choices = library.all(1, 0);
    assert_eq!(choices.len(), 51);
    let mut faults = Vec::new();
    for choice in choices {
        let ModelChoice::File(path) = &choice else {
            panic!("{choice:?}");
        };
        let model = library.load(&choice).unwrap();
        let longest_m = 2.0 * model.half_sides_m.max();
        let world = world_with(path);
        let object = &world.objects()[0];
        if !(0.02..0.6).contains(&longest_m) || object.state != ObjectState::Settled {
            let state = object.state.word();
            faults.push(format!("{}: {longest_m:.3} m, {state}", model.name));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn model_from_a_dae_file_has_the_unit_and_axis_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let (vertices, triangles) = cuboid([5.0, 10.0, 7.0]);
    let numbers: Vec<_> = vertices.iter().flat_map(|v| [v.x, v.y, v.z]).collect();
    let words = |numbers: &[f32]| {
        numbers
            .iter()
            .map(f32::to_string)
            .collect::<Vec<_>>()
            .join(" ")
    };
    let corners: Vec<_> = triangles.as_flattened().iter().map(|&i| i as f32).collect();
    let text = format!(
        "<COLLADA><asset><unit meter=\"0.01\"/><up_axis>Y_UP</up_axis></asset>\
         <library_geometries><geometry id=\"g\"><mesh><source id=\"s\"><float_array>{}\
         </float_array><technique_common><accessor stride=\"3\"/></technique_common></source>\
         <vertices id=\"v\"><input semantic=\"POSITION\" source=\"#s\"/></vertices><triangles>\
         <input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>{}</p></triangles></mesh>\
         </geometry></library_geometries></COLLADA>",
        words(&numbers),
        words(&corners)
    );
    let (model, notes) = load(&file(&folder, "brick.dae", text)).unwrap();
    assert_eq!(notes, "");
    assert!((model.half_sides_m.z - 0.05).abs() < 1e-6);
}
