use super::*;
use crate::NEUTRAL_GREY;
use mutation_fuzzing::{assert_sentence, flipped_bits, fuzz, truncations};
use point_cloud::{Point, Rgba};
use std::fmt::Write;

/// Document with a square of triangles and a polygon, placed by nodes.
const FOREIGN: &str = include_str!("test_square.dae");

fn check_read_or_explained(bytes: &[u8]) {
    match read(bytes) {
        Ok(model) => {
            let mesh = model.mesh;
            let mut indices = mesh.triangles.as_flattened().iter();
            assert!(indices.all(|&index| (index as usize) < mesh.vertices.len()));
            assert!(mesh.vertices.iter().all(Point::is_finite));
        }
        Err(error) => assert_sentence(&error),
    }
}

#[test]
fn nodes_place_geometries_in_unit_and_axis_of_the_file() {
    let model = read(FOREIGN.as_bytes()).unwrap();
    assert_eq!((model.unit_m, model.up), (Some(0.01), Some(UpAxis::Z)));
    assert!(model.notes.is_empty(), "{:?}", model.notes);
    let mesh = model.mesh;
    assert_eq!(mesh.triangles.len(), 6);
    let corners = |i: usize| mesh.triangles[i].map(|v| mesh.vertices[v as usize]);
    // Moved by 1 along x, then turned by 90 degrees, then lifted.
    let expected = [[0.0, 1.0, 5.0], [0.0, 3.0, 5.0], [-2.0, 3.0, 5.0]];
    for (found, [x, y, z]) in corners(0).iter().zip(expected) {
        let off = [found.x - x, found.y - y, found.z - z];
        assert!(off.iter().all(|off| off.abs() < 1e-6), "{found:?}");
        assert_eq!(found.color, NEUTRAL_GREY, "its texture is not read");
    }
    assert!(
        corners(1)
            .iter()
            .all(|v| v.color == Rgba::opaque(255, 0, 0))
    );
    for i in 0..6 {
        let [a, b, c] = corners(i).map(|v| v.position());
        assert!(
            (b - a).cross(&(c - a)).z > 0.0,
            "a mirrored face keeps its front"
        );
    }
}

#[test]
fn textures_come_from_the_folder() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.dae");
    std::fs::write(&path, FOREIGN).unwrap();
    let model = open(&path).unwrap();
    assert!(model.notes[0].contains("a b.png") && model.notes[0].contains("missing"));
    std::fs::create_dir(folder.path().join("maps")).unwrap();
    let samples = [[0, 0, 255]; 64 * 64];
    let png = crate::texture::test_png(64, png::ColorType::Rgb, samples.as_flattened());
    std::fs::write(folder.path().join("maps/a b.png"), png).unwrap();
    let model = open(&path).unwrap();
    assert!(model.notes.is_empty(), "{:?}", model.notes);
    let mesh = model.mesh;
    assert!(mesh.triangles.len() > 100 && mesh.triangles.len() <= 20_000);
    let n_of = |color: Rgba| mesh.vertices.iter().filter(|v| v.color == color).count();
    assert!(n_of(Rgba::opaque(0, 0, 255)) > 100 && n_of(Rgba::opaque(255, 0, 0)) >= 8);
    let outside = FOREIGN.replace("maps/a%20b.png", "file:///etc/passwd");
    std::fs::write(&path, outside).unwrap();
    let notes = open(&path).unwrap().notes;
    assert!(notes[0].contains("leads out of"), "{notes:?}");
}

#[test]
fn files_without_a_scene_unit_or_axis_are_read() {
    let (start, rest) = FOREIGN.split_once("<library_nodes>").unwrap();
    assert!(!rest.is_empty());
    let (head, tail) = start.split_once("<asset>").unwrap();
    let tail = tail.split_once("</asset>").unwrap().1;
    let model = read(format!("{head}{tail}</COLLADA>").as_bytes()).unwrap();
    assert_eq!((model.unit_m, model.up), (None, Some(UpAxis::Y)));
    assert_eq!(model.mesh.triangles.len(), 3);
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
fn a_wrong_file_is_refused_with_its_reason() {
    for (from, to, reason) in [
        ("<p>0 0 1 1 2 2</p>", "<p>0 0 1 1 4 2</p>", "no vertex 4"),
        ("<p>0 0 1 1 2 2</p>", "<p>0 0 1 1 -2 2</p>", "\"-2\""),
        ("<vcount>4<", "<vcount>5<", "last polygon"),
        ("<vcount>4<", "<vcount>4294967295<", "last polygon"),
        ("2 2 0 0 2 0<", "2 2 0 0 2 x<", "\"x\""),
        ("2 2 0 0 2 0<", "2 2 0 0 2 inf<", "not finite"),
        ("<translate>0 0 5", "<translate>0 0", "2 numbers"),
        ("<translate>0 0 5", "<translate>0 0 1e300", "not finite"),
        ("offset=\"1\"", "offset=\"1000000000\"", "offset"),
        ("stride=\"3\"", "stride=\"-3\"", "stride"),
        (
            "semantic=\"VERTEX\"",
            "semantic=\"NORMAL\"",
            "no input VERTEX",
        ),
        (
            "<instance_geometry url=\"#square\">",
            "<instance_geometry url=\"#a\">",
            "no triangles",
        ),
        ("<instance_node url=\"#shared\"/>", "</node>", "not XML"),
    ] {
        check_refusal(from, to, reason);
    }
    for (text, reason) in [
        ("<svg/>", "no COLLADA"),
        ("", "not XML"),
        ("\u{0}", "not XML"),
    ] {
        let error = read(text.as_bytes()).unwrap_err();
        assert_sentence(&error);
        assert!(error.to_string().contains(reason), "{error}");
    }
    assert_sentence(&read(&[0xff]).unwrap_err());
}

#[test]
fn hostile_files_cost_no_more_than_a_message() {
    let laughs =
        "<!DOCTYPE a [<!ENTITY a \"aaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;&a;&a;\">]>\n<COLLADA";
    check_refusal("<COLLADA", laughs, "document type");
    // A node that places itself, and nodes that double again and again.
    let endless = "<node id=\"shared\"><instance_node url=\"#shared\"/>";
    check_refusal("<node id=\"shared\">", endless, "in one another");
    let mut doubling = String::from("<library_nodes>");
    for i in 0..60 {
        let next = format!("<instance_node url=\"#n{}\"/>", i + 1);
        write!(doubling, "<node id=\"n{i}\">{next}{next}</node>").unwrap();
    }
    let text = FOREIGN.replacen("<library_nodes>", &doubling, 1);
    let text = text.replacen(
        "url=\"#shared\"/></node></node>",
        "url=\"#n0\"/></node></node>",
        1,
    );
    let error = read(text.as_bytes()).unwrap_err();
    assert!(error.to_string().contains("65536 in all"), "{error}");
    let deep = "<node>".repeat(1_000_000);
    check_read_or_explained(format!("<COLLADA>{deep}").as_bytes());
    let closed = "</node>".repeat(1_000_000);
    check_read_or_explained(format!("<COLLADA>{deep}{closed}</COLLADA>").as_bytes());
}

#[test]
fn a_file_cut_or_flipped_anywhere_is_read_or_explained() {
    for file in truncations(FOREIGN.as_bytes()).chain(flipped_bits(FOREIGN.as_bytes())) {
        check_read_or_explained(&file);
    }
}

#[test]
fn fuzz_dae_files() {
    fuzz(&[FOREIGN.as_bytes().to_vec()], check_read_or_explained);
}
