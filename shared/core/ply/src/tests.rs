use super::*;
use crate::NEUTRAL_GREY;
use mutation_fuzzing::{assert_sentence, corruption};
use point_cloud::{Point, Rgba};
use proptest::prelude::*;

const ENCODINGS: [Encoding; 3] = [
    Encoding::Ascii,
    Encoding::BinaryLittleEndian,
    Encoding::BinaryBigEndian,
];

fn mesh() -> impl Strategy<Value = Mesh> {
    let finite = || any::<f32>().prop_filter("finite", |value| value.is_finite());
    let vertex =
        (finite(), finite(), finite(), any::<[u8; 3]>()).prop_map(|(x, y, z, [r, g, b])| Point {
            x,
            y,
            z,
            color: Rgba::opaque(r, g, b),
        });
    prop::collection::vec(vertex, 0..20).prop_flat_map(|vertices| {
        let n_vertices = vertices.len() as u32;
        let index = || 0..n_vertices.max(1);
        let n_triangles = if vertices.is_empty() { 0..1 } else { 0..20 };
        prop::collection::vec([index(), index(), index()], n_triangles).prop_map(move |triangles| {
            Mesh {
                vertices: vertices.clone(),
                triangles,
            }
        })
    })
}

proptest! {
    #[test]
    fn round_trip_returns_what_was_written(mesh in mesh()) {
        for encoding in ENCODINGS {
            prop_assert_eq!(&read(&write(mesh.view(), encoding).unwrap()).unwrap(), &mesh);
        }
    }

    #[test]
    fn a_damaged_file_is_read_or_explained(mesh in mesh(), corruptions in [corruption(), corruption(), corruption()]) {
        for (encoding, corruption) in ENCODINGS.into_iter().zip(corruptions) {
            let file = corruption.apply(&write(mesh.view(), encoding).unwrap());
            match read(&file) {
                Ok(mesh) => {
                    let mut indices = mesh.triangles.as_flattened().iter();
                    prop_assert!(indices.all(|&index| (index as usize) < mesh.vertices.len()));
                    prop_assert!(mesh.vertices.iter().all(Point::is_finite));
                }
                Err(error) => assert_sentence(&error),
            }
        }
    }

    #[test]
    fn a_binary_file_cut_anywhere_is_explained(mesh in mesh(), at in any::<prop::sample::Index>()) {
        for encoding in [Encoding::BinaryBigEndian, Encoding::BinaryLittleEndian] {
            let file = write(mesh.view(), encoding).unwrap();
            assert_sentence(&read(&file[..at.index(file.len())]).unwrap_err());
        }
    }

    #[test]
    fn arbitrary_bytes_are_explained(bytes in any::<Vec<u8>>()) {
        assert_sentence(&read(&bytes).unwrap_err());
        let header = b"ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\n\
            property list uchar char l\nproperty double y\nproperty float z\nelement face 2\n\
            property list uchar uchar vertex_index\nend_header\n";
        if let Err(error) = read(&[&header[..], &bytes].concat()) {
            assert_sentence(&error);
        }
    }
}

/// Foreign PLY file with additional properties, elements and polygons.
const FOREIGN: &str = "ply\r
format ascii 1.0\r
comment made by hand
obj_info more words
element material 1
property list uchar float shine
property int id
element vertex 5
property double z
property float nx
property float32 y
property list uchar int neighbours
property float x
property uint8 alpha
element face 2
property uchar flags
property list uint8 uint16 vertex_index
property list uchar float texcoord
element edge 0
property int vertex1
end_header
2 0.5 0.25 7

1 0 2 2 8 9 3 255
1 0 2 0 4 255
1 0 2 0 5 255
1 0 2 0 6e0 255
1 0 2 0 7 255
0 3 0 1 2 0
0 5 4 3 2 1 0 2 0.5 0.5
";

#[test]
fn foreign_elements_are_skipped_and_polygons_cut() {
    let mesh = read(FOREIGN.as_bytes()).unwrap();
    let xs: Vec<f32> = mesh.vertices.iter().map(|vertex| vertex.x).collect();
    assert_eq!(xs, [3.0, 4.0, 5.0, 6.0, 7.0]);
    assert_eq!(
        mesh.vertices[0],
        Point {
            x: 3.0,
            y: 2.0,
            z: 1.0,
            color: NEUTRAL_GREY
        }
    );
    assert_eq!(mesh.triangles, [[0, 1, 2], [4, 3, 2], [4, 2, 1], [4, 1, 0]]);
}

/// Reads the foreign file with one change, and expects an error with the reason.
#[track_caller]
fn check_refusal(from: &str, to: &str, reason: &str) {
    assert!(FOREIGN.contains(from), "{from}");
    let error = read(FOREIGN.replacen(from, to, 1).as_bytes()).unwrap_err();
    assert_sentence(&error);
    assert!(error.to_string().contains(reason), "{error} / {reason}");
}

#[test]
fn a_wrong_header_is_refused_with_its_reason() {
    for (from, to, reason) in [
        ("ply\r", "plyx", "not a PLY file"),
        ("end_header", "end_head", "no line of a PLY header"),
        ("ascii 1.0", "ascii 2.0", "version 1.0"),
        ("format ascii 1.0\r\n", "", "format"),
        ("ascii", "binary", "binary_little_endian"),
        ("element edge", "element face", "twice"),
        ("property float x", "property float y", "twice"),
        ("property float x", "property float w", "x, y and z"),
        ("property float x", "property int x", "float or double"),
        (
            "property uint8 alpha",
            "property uint8 red",
            "red, green and blue",
        ),
        ("int id", "integer id", "no type of number"),
        (
            "list uchar float shine",
            "list float float shine",
            "counted by an integer",
        ),
        ("vertex_index", "vertices", "needs one list"),
        ("texcoord", "vertex_indices", "needs one list"),
        ("element vertex 5", "element vertex -5", "not a count"),
        (
            "element vertex 5",
            "element vertex 6",
            "row 5 of element \"vertex\"",
        ),
        (
            "element vertex 5",
            "element vertex 4",
            "row 0 of element \"face\"",
        ),
        (
            "element vertex 5",
            "element vertex 99999999",
            "16777216 vertices",
        ),
        (
            "element edge 0",
            "element edge 99999999999999999999",
            "not a count",
        ),
        (
            "element edge 0",
            "element edge 18446744073709551615",
            "\"edge\" is complete",
        ),
        ("element edge 0", "element edge 1", "\"edge\" is complete"),
        ("element face 2", "element face 1", "goes on behind"),
    ] {
        check_refusal(from, to, reason);
    }
}

#[test]
fn a_wrong_row_is_refused_with_its_reason() {
    for (from, to, reason) in [
        ("5 4 3 2 1 0", "5 5 3 2 1 0", "no vertex 5"),
        ("5 4 3 2 1 0", "6 4 3 2 1 0", "row 1 of element \"face\""),
        ("3 0 1 2", "2 0 1", "at least three"),
        ("1 0 2 0 4", "1 0 2 0 inf", "not finite"),
        ("1 0 2 0 4", "1 0 2 0 4x", "\"4x\""),
        ("1 0 2 0 4 255", "1 0 2 0 4 256", "\"256\""),
        ("2 0.5 0.25 7", "-2 0.5 0.25 7", "\"-2\""),
    ] {
        check_refusal(from, to, reason);
    }
}

#[test]
fn rows_without_properties_do_not_cost_time() {
    let file = "ply\nformat binary_little_endian 1.0\nelement nothing 18446744073709551615\n\
        element vertex 0\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    assert_eq!(read(file.as_bytes()).unwrap(), Mesh::default());
}

#[test]
fn invalid_content_is_not_written() {
    let vertices = [Point::default(); 3];
    for mesh in [
        MeshView {
            vertices: &vertices,
            triangles: &[[0, 1, 3]],
        },
        MeshView {
            vertices: &[Point::without_depth(NEUTRAL_GREY)],
            triangles: &[],
        },
    ] {
        assert_sentence(&write(mesh, Encoding::Ascii).unwrap_err());
    }
}
