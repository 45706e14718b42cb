use super::*;
use crate::NEUTRAL_GREY;
use mutation_fuzzing::{assert_sentence, corruption, flipped_bits, fuzz, truncations};
use point_cloud::Point;
use proptest::prelude::*;
use std::fmt::Write;

type Corners = [[f32; 3]; 3];

/// Tetrahedron, counter-clockwise seen from outside.
const TETRAHEDRON: [Corners; 4] = {
    let [o, x, y, z] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    [[o, y, x], [o, x, z], [o, z, y], [x, y, z]]
};

fn binary(header: &[u8], triangles: &[Corners]) -> Vec<u8> {
    let mut file = header.to_vec();
    file.resize(80, b' ');
    file.extend((triangles.len() as u32).to_le_bytes());
    for corners in triangles {
        file.extend([0; 12]);
        let numbers = corners.as_flattened().iter();
        file.extend(numbers.flat_map(|number| number.to_le_bytes()));
        file.extend([7, 7]);
    }
    file
}

fn text(triangles: &[Corners]) -> String {
    let mut text = "solid a thing\n".to_owned();
    for corners in triangles {
        text += " facet normal 0 0 nan\r\n  outer loop\n";
        for [x, y, z] in corners {
            writeln!(text, "   vertex {x} {y:e}\t{z}").unwrap();
        }
        text += "  endloop\n ENDFACET\n\n";
    }
    text + "endsolid a thing"
}

fn corners() -> impl Strategy<Value = Vec<Corners>> {
    // Few different numbers, so that corners are shared.
    let number = || prop::sample::select(vec![0.0_f32, -0.0, 1.5, -2.25, 1e-30, 3e38]);
    let corner = move || [number(), number(), number()];
    prop::collection::vec([corner(), corner(), corner()], 0..20)
}

fn check_read_or_explained(bytes: &[u8]) {
    match read(bytes) {
        Ok(mesh) => {
            let mut indices = mesh.triangles.as_flattened().iter();
            assert!(indices.all(|&index| (index as usize) < mesh.vertices.len()));
            assert!(mesh.vertices.iter().all(Point::is_finite));
        }
        Err(error) => assert_sentence(&error),
    }
}

proptest! {
    #[test]
    fn both_encodings_keep_every_corner(triangles in corners()) {
        let mesh = read(&binary(b"", &triangles)).unwrap();
        prop_assert_eq!(&read(text(&triangles).as_bytes()).unwrap(), &mesh);
        prop_assert_eq!(mesh.triangles.len(), triangles.len());
        for (found, given) in mesh.triangles.iter().zip(&triangles) {
            for (&index, &[x, y, z]) in found.iter().zip(given) {
                let vertex = mesh.vertices[index as usize];
                prop_assert_eq!((vertex.x, vertex.y, vertex.z), (x, y, z));
            }
        }
        for (index, vertex) in mesh.vertices.iter().enumerate() {
            prop_assert!(!mesh.vertices[..index].contains(vertex), "welded");
        }
    }

    #[test]
    fn a_damaged_file_is_read_or_explained(triangles in corners(), corruptions in [corruption(), corruption()]) {
        check_read_or_explained(&corruptions[0].apply(&binary(b"solid", &triangles)));
        check_read_or_explained(&corruptions[1].apply(text(&triangles).as_bytes()));
    }

    #[test]
    fn arbitrary_bytes_are_explained(bytes in any::<Vec<u8>>()) {
        check_read_or_explained(&bytes);
        check_read_or_explained(&[b"solid\n", &bytes[..]].concat());
    }
}

#[test]
fn fuzz_stl_files() {
    let seeds = [
        binary(b"made by hand", &TETRAHEDRON),
        text(&TETRAHEDRON).into_bytes(),
    ];
    fuzz(&seeds, check_read_or_explained);
}

#[test]
fn a_closed_surface_is_grey_and_shares_its_corners() {
    // A header that begins as a text file does.
    for file in [
        binary(b"solid", &TETRAHEDRON),
        text(&TETRAHEDRON).into_bytes(),
    ] {
        let mesh = read(&file).unwrap();
        assert_eq!((mesh.vertices.len(), mesh.triangles.len()), (4, 4));
        assert!(
            mesh.vertices
                .iter()
                .all(|vertex| vertex.color == NEUTRAL_GREY)
        );
    }
}

#[test]
fn a_file_cut_or_flipped_anywhere_is_read_or_explained() {
    let (binary, text) = (binary(b"", &TETRAHEDRON), text(&TETRAHEDRON));
    for file in truncations(&binary) {
        assert_sentence(&read(&file).unwrap_err());
    }
    for file in truncations(text.as_bytes()).chain(flipped_bits(text.as_bytes())) {
        check_read_or_explained(&file);
    }
    flipped_bits(&binary).for_each(|file| check_read_or_explained(&file));
}

#[test]
fn a_wrong_file_is_refused_with_its_reason() {
    let whole = text(&TETRAHEDRON);
    for (from, to, reason) in [
        ("vertex 0 0e0\t0", "vertex 0 0", "line 4 of"),
        ("vertex 0 0e0\t0", "vertex 0 0 nan", "\"nan\""),
        ("vertex 0 0e0\t0", "vertex 0 0 0 0", "three numbers"),
        ("vertex 0 0e0\t0", "", "three vertices"),
        ("endloop", "vertex 1 2 3", "\"vertex\" is not expected"),
        ("facet", "face", "\"face\""),
        ("endsolid", "", "\"a\""),
        ("endsolid a thing", "", "\"endsolid\""),
    ] {
        assert!(whole.contains(from), "{from}");
        let error = read(whole.replacen(from, to, 1).as_bytes()).unwrap_err();
        assert_sentence(&error);
        assert!(error.to_string().contains(reason), "{error} / {reason}");
    }
    let mut file = binary(b"", &TETRAHEDRON);
    let announced_too_many = {
        let mut file = file.clone();
        file[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
        file
    };
    let not_finite = {
        let mut file = file.clone();
        file[84 + 50 + 12..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
        file
    };
    file.push(0);
    for (file, reason) in [
        (announced_too_many, "4294967295 triangles and ends after 4"),
        (not_finite, "triangle 1"),
        (file, "goes on behind"),
        (b"ply\n".to_vec(), "not an STL file"),
        (Vec::new(), "not an STL file"),
    ] {
        let error = read(&file).unwrap_err();
        assert_sentence(&error);
        assert!(error.to_string().contains(reason), "{error} / {reason}");
    }
}
