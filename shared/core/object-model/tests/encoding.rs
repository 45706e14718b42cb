//! Encoding of object models: round trip, wrong values, hostile bytes and their memory.
#![cfg(test)]

use allocation_counter::CountingAllocator;
use geometry::RigidTransform;
use mutation_fuzzing::{assert_sentence, fuzz, truncations};
use nalgebra::{Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use object_model::{
    DirectionSphere, Error, ModelMesh, ModelView, ObjectModel, RefusedView, UnseenDirections,
};
use point_cloud::Vertex;
use random::Random;

#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

/// Memory that decoding may request for each byte of a document, and beyond. The decoder reserves
/// at most 1 MiB for a list, whatever length it announces, and there are two.
const REQUESTED_PER_BYTE: u64 = 20;
const REQUESTED_BEYOND: u64 = 3 << 20;

/// Surface of random vertices with a view and a refused one.
fn model(n_vertices: u32, seed: u64) -> ObjectModel {
    let mut random = Random::from_seed(seed);
    let mut unit = || {
        let mut coordinate = || random.between(-1.0, 1.0) as f32;
        Vector3::new(coordinate(), coordinate(), 1.5).normalize()
    };
    let vertices = (0..n_vertices).map(|number| Vertex {
        position: Point3::from(0.1 * unit()),
        normal: unit(),
        color: [number as u8, (number >> 8) as u8, 7],
    });
    let vertices = vertices.collect();
    let rotation = UnitQuaternion::from_euler_angles(0.1, 0.2, 0.3);
    ObjectModel {
        mesh: ModelMesh {
            vertices,
            triangles: (2..n_vertices)
                .map(|third| [third - 2, third - 1, third])
                .collect(),
        },
        views: vec![ModelView {
            object_from_camera: RigidTransform::from_parts(
                Translation3::new(0.1, -0.2, 0.8),
                rotation,
            ),
            captured_ns: 5,
            n_points: 4321,
            new_surface_share: 0.25,
        }],
        refused: vec![RefusedView {
            captured_ns: 9,
            reason: "its pose contradicts the surface".into(),
        }],
        is_closed_loop: true,
        unseen: UnseenDirections::of(DirectionSphere::Icosphere162, |d| d.z < -0.5),
    }
}

fn refused(bytes: &[u8]) -> String {
    let error = ObjectModel::from_bytes(bytes).unwrap_err();
    assert_sentence(&error);
    error.to_string()
}

#[test]
fn models_survive_their_encoding() {
    for n_vertices in [0, 1, 3, 1000] {
        let model = model(n_vertices, 1);
        let bytes = model.to_bytes().unwrap();
        assert_eq!(ObjectModel::from_bytes(&bytes).unwrap(), model);
        assert_eq!(bytes, model.to_bytes().unwrap(), "the encoding is unique");
    }
}

#[test]
fn summary_counts_and_measures() {
    let mut model = model(1000, 2);
    model.mesh.vertices[5].position = Point3::new(-0.5, 0.0, 0.0);
    model.mesh.vertices[6].position = Point3::new(0.75, 0.0, 0.0);
    let summary = model.summary();
    assert!((summary.extents_m[0] - 1.25).abs() < 1e-9, "{summary:?}");
    assert_eq!((summary.n_vertices, summary.n_triangles), (1000, 998));
    assert_eq!((summary.n_views, summary.n_refused), (1, 1));
    assert!((summary.completeness - model.unseen.completeness()).abs() < 1e-12);
    let empty = self::model(0, 1).summary();
    assert!(empty.extents_m.iter().all(|extent| *extent == 0.0));
}

#[test]
fn ply_holds_the_coloured_surface() {
    let model = model(50, 3);
    let mesh = ply::read(&model.to_ply().unwrap()).unwrap();
    assert_eq!(mesh.triangles, model.mesh.triangles);
    for (point, vertex) in mesh.vertices.iter().zip(&model.mesh.vertices) {
        assert_eq!(
            [point.x, point.y, point.z],
            <[f32; 3]>::from(vertex.position)
        );
        assert_eq!(point.color.rgb(), vertex.color);
    }
}

#[test]
fn wrong_values_are_neither_written_nor_read() {
    type Spoil = fn(&mut ObjectModel);
    let spoils: [(&str, Spoil); 12] = [
        ("vertex 3", |m| m.mesh.vertices[3].position.x = f32::NAN),
        ("vertex 4", |m| {
            m.mesh.vertices[4].position.y = f32::INFINITY;
        }),
        ("vertex 5", |m| m.mesh.vertices[5].position.z = -101.0),
        ("normal of vertex 6", |m| m.mesh.vertices[6].normal *= 0.5),
        ("normal of vertex 7", |m| {
            m.mesh.vertices[7].normal.x = f32::NAN;
        }),
        ("vertex that is not there", |m| m.mesh.triangles[2][1] = 50),
        ("names a vertex twice", |m| m.mesh.triangles[2] = [4, 9, 4]),
        ("place that is not finite", |m| {
            m.views[0].object_from_camera.translation.x = f64::NAN;
        }),
        ("no unit quaternion", |m| {
            let double = Quaternion::new(2.0, 0.0, 0.0, 0.0);
            m.views[0].object_from_camera.rotation = UnitQuaternion::new_unchecked(double);
        }),
        ("not between 0 and 1", |m| {
            m.views[0].new_surface_share = f32::NAN;
        }),
        ("control character", |m| {
            m.refused[0].reason = "a\u{1b}[2J".into();
        }),
        ("too long", |m| m.refused[0].reason = "x".repeat(257)),
    ];
    for (expected, spoil) in spoils {
        let mut model = model(50, 4);
        spoil(&mut model);
        let error = model.to_bytes().unwrap_err();
        assert_sentence(&error);
        assert!(error.to_string().contains(expected), "{error}");
    }
}

/// Replaces bytes that occur once.
fn replaced(bytes: &[u8], old: &[u8], new: &[u8]) -> Vec<u8> {
    let places: Vec<usize> = (0..=bytes.len() - old.len())
        .filter(|&place| bytes[place..].starts_with(old))
        .collect();
    assert_eq!(places.len(), 1, "{old:?}");
    [&bytes[..places[0]], new, &bytes[places[0] + old.len()..]].concat()
}

#[test]
fn wrong_bytes_are_refused_with_the_reason() {
    let model = model(50, 5);
    let bytes = model.to_bytes().unwrap();
    let direction: Vec<u8> = model.unseen.directions()[0]
        .iter()
        .flat_map(|coordinate| coordinate.to_le_bytes())
        .collect();
    let other: Vec<u8> = model.unseen.directions()[1]
        .iter()
        .flat_map(|coordinate| coordinate.to_le_bytes())
        .collect();
    let first_triangle: Vec<u8> = [0u32, 1, 2, 1]
        .iter()
        .flat_map(|i| i.to_le_bytes())
        .collect();
    let far_triangle: Vec<u8> = [0u32, 1, 99, 1]
        .iter()
        .flat_map(|i| i.to_le_bytes())
        .collect();
    let vertex: Vec<u8> = model.mesh.vertices[8]
        .position
        .iter()
        .flat_map(|coordinate| coordinate.to_le_bytes())
        .collect();
    for (expected, wrong) in [
        ("no object model", b"ply\n".to_vec()),
        ("no object model", Vec::new()),
        ("version 2", [&bytes[..1], &[2], &bytes[2..]].concat()),
        ("something follows", [&bytes[..], &[0]].concat()),
        ("ends too early", bytes[..bytes.len() - 1].to_vec()),
        ("vertex 8", replaced(&bytes, &vertex, &[0xff; 12])),
        (
            "not one of its sphere",
            replaced(&bytes, &direction, &[0; 12]),
        ),
        ("named twice", replaced(&bytes, &direction, &other)),
        (
            "not there, of 50",
            replaced(&bytes, &first_triangle, &far_triangle),
        ),
        (
            "part of it is missing",
            replaced(&bytes, b"normals", b"nirmals"),
        ),
        (
            "not 42 or 162",
            replaced(&bytes, b"n_directions\x18\xa2", b"n_directions\x18\xa3"),
        ),
    ] {
        let sentence = refused(&wrong);
        assert!(sentence.contains(expected), "{expected}: {sentence}");
    }
}

#[test]
fn cut_models_are_refused() {
    for cut in truncations(&model(4, 6).to_bytes().unwrap()) {
        refused(&cut);
    }
}

/// Bytes requested while a document is decoded.
fn requested(bytes: &[u8]) -> u64 {
    let before = CountingAllocator::counts_of_thread().1;
    let decoded = ObjectModel::from_bytes(bytes);
    let after = CountingAllocator::counts_of_thread().1;
    drop(decoded);
    after - before
}

fn check_memory(bytes: &[u8]) {
    let most = REQUESTED_PER_BYTE * bytes.len() as u64 + REQUESTED_BEYOND;
    let requested = requested(bytes);
    assert!(requested <= most, "{requested} bytes for {}", bytes.len());
}

#[test]
fn memory_is_proportional_to_the_bytes() {
    check_memory(&model(100_000, 7).to_bytes().unwrap());
    // Announced lengths that are not there: bytes, a text, and lists.
    let bytes = model(50, 7).to_bytes().unwrap();
    let huge = |major: u8| [&[major | 0x1b], &[0x7f; 8][..]].concat();
    let (bytes_of, list_of) = (huge(0x40), huge(0x80));
    for (old, new) in [
        (&b"colors\x58\x96"[..], [&b"colors"[..], &bytes_of].concat()),
        (&b"views\x81"[..], [&b"views"[..], &list_of].concat()),
        (&b"refused\x81"[..], [&b"refused"[..], &list_of].concat()),
    ] {
        let hostile = replaced(&bytes, old, &new);
        refused(&hostile);
        check_memory(&hostile);
    }
}

#[test]
fn fuzz_object_models() {
    let seeds: Vec<_> = [0, 1, 5, 40]
        .map(|n| model(n, u64::from(n)).to_bytes().unwrap())
        .into();
    fuzz(&seeds, |bytes| {
        check_memory(bytes);
        match ObjectModel::from_bytes(bytes) {
            // Whatever is read can be shown, exported, and written again.
            Ok(model) => {
                assert!(
                    model
                        .summary()
                        .extents_m
                        .iter()
                        .all(|extent| extent.is_finite())
                );
                assert!(model.unseen.in_words().len() <= 6);
                ply::read(&model.to_ply().unwrap()).unwrap();
                let again = ObjectModel::from_bytes(&model.to_bytes().unwrap()).unwrap();
                assert_eq!(again, model);
            }
            Err(error @ Error::Ply(_)) => panic!("{error}"),
            Err(error) => assert_sentence(&error),
        }
    });
}
