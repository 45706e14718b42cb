use super::*;
use crate::NEUTRAL_GREY;
use mutation_fuzzing::{assert_sentence, corruption, flipped_bits, truncations};
use point_cloud::{Point, Rgba};
use proptest::prelude::*;
use std::fmt::Write;

const RED: Rgba = Rgba::opaque(255, 0, 0);
const BLUE: Rgba = Rgba::opaque(0, 0, 255);

/// Foreign OBJ file with all kinds of lines.
const FOREIGN: &str = "# made by hand \\
mtllib ./a b.mtl
o thing
v 0 0 0\r
v 1 0 0 1.0
v 1 1 0 1 0 0
v 0 1 0 0 0.5 1 0.25
vt 0.5 0.5
vn 0 0 1
g group\\
  more
s off
f 1/1/1 2//1 3/1 4
usemtl gold
f -1 -2 -3
f 1 \\
  2 5
v 1e-2 -2 3.5
l 1 2 3
weird line \u{e4}
";

fn read_plain(text: &str) -> Result<Mesh, ModelError> {
    read(text.as_bytes(), &Materials::default())
}

fn materials(library: &str) -> Result<Materials, ModelError> {
    let mut materials = Materials::default();
    materials.read(library.as_bytes()).map(|()| materials)
}

/// Writes a mesh as text with all digits.
fn to_text(mesh: &Mesh) -> String {
    let mut text = String::new();
    for vertex in &mesh.vertices {
        let [r, g, b] = vertex.color.rgb().map(|byte| f64::from(byte) / 255.0);
        writeln!(text, "v {} {} {} {r} {g} {b}", vertex.x, vertex.y, vertex.z).unwrap();
    }
    for [a, b, c] in &mesh.triangles {
        writeln!(text, "f {} {}/1 {}//2", a + 1, b + 1, c + 1).unwrap();
    }
    text
}

fn mesh() -> impl Strategy<Value = Mesh> {
    let finite = || any::<f32>().prop_filter("finite", |value| value.is_finite());
    let vertex = (finite(), finite(), finite(), any::<[u8; 3]>());
    prop::collection::vec(vertex, 1..20).prop_flat_map(|vertices| {
        let n_vertices = vertices.len() as u32;
        let index = || 0..n_vertices;
        prop::collection::vec([index(), index(), index()], 0..20).prop_map(move |triangles| Mesh {
            vertices: vertices
                .iter()
                .map(|&(x, y, z, [r, g, b])| Point {
                    x,
                    y,
                    z,
                    color: Rgba::opaque(r, g, b),
                })
                .collect(),
            triangles,
        })
    })
}

fn check_read_or_explained(bytes: &[u8], materials: &Materials) {
    match read(bytes, materials) {
        Ok(mesh) => {
            let mut indices = mesh.triangles.as_flattened().iter();
            assert!(indices.all(|&index| (index as usize) < mesh.vertices.len()));
            assert!(mesh.vertices.iter().all(Point::is_finite));
        }
        Err(error) => assert_sentence(&error),
    }
    if let Err(error) = material_libraries(bytes) {
        assert_sentence(&error);
    }
}

proptest! {
    #[test]
    fn round_trip_returns_what_was_written(mesh in mesh()) {
        prop_assert_eq!(read_plain(&to_text(&mesh)).unwrap(), mesh);
    }

    #[test]
    fn indices_may_count_backwards(mesh in mesh()) {
        let mut text = String::new();
        let forwards = to_text(&mesh);
        let n_vertices = mesh.vertices.len() as i64;
        for line in forwards.lines().filter(|line| line.starts_with('v')) {
            writeln!(text, "{line}").unwrap();
        }
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|index| i64::from(index) - n_vertices);
            writeln!(text, "f {a}/{a}/{a} {b} {c}").unwrap();
        }
        prop_assert_eq!(read_plain(&text).unwrap(), mesh);
    }

    #[test]
    fn paint_changes_colors_only(mesh in mesh(), names in prop::collection::vec("[a-c]", 20)) {
        let library = materials("newmtl a\nKd 1 0 0\nnewmtl b\nKd 0 0 1\n").unwrap();
        let mut text: String = to_text(&mesh)
            .lines()
            .filter(|line| line.starts_with('v'))
            .map(|line| line.split(' ').take(4).collect::<Vec<_>>().join(" ") + "\n")
            .collect();
        for (name, [a, b, c]) in names.iter().zip(&mesh.triangles) {
            writeln!(text, "usemtl {name}\nf {} {} {}", a + 1, b + 1, c + 1).unwrap();
        }
        let painted = read(text.as_bytes(), &library).unwrap();
        prop_assert_eq!(painted.triangles.len(), mesh.triangles.len());
        for (idx, (triangle, plain)) in painted.triangles.iter().zip(&mesh.triangles).enumerate() {
            let color = library.color(&names[idx]).unwrap_or(NEUTRAL_GREY);
            for (&left, &right) in triangle.iter().zip(plain) {
                let (left, right) = (painted.vertices[left as usize], mesh.vertices[right as usize]);
                prop_assert_eq!((left.x, left.y, left.z), (right.x, right.y, right.z));
                prop_assert_eq!(left.color, color);
            }
        }
    }

    #[test]
    fn a_damaged_file_is_read_or_explained(mesh in mesh(), corruption in corruption()) {
        check_read_or_explained(&corruption.apply(to_text(&mesh).as_bytes()), &Materials::default());
    }

    #[test]
    fn arbitrary_bytes_are_explained(bytes in any::<Vec<u8>>()) {
        check_read_or_explained(&bytes, &Materials::default());
        check_read_or_explained(&[b"v 1 2 3\nf 1 1 1 ", &bytes[..]].concat(), &Materials::default());
        if let Err(error) = Materials::default().read(&bytes) {
            assert_sentence(&error);
        }
    }
}

#[test]
fn a_file_cut_or_flipped_anywhere_is_read_or_explained() {
    let gold = materials("newmtl gold\nKd 1 0.5 0\n").unwrap();
    for file in truncations(FOREIGN.as_bytes()).chain(flipped_bits(FOREIGN.as_bytes())) {
        check_read_or_explained(&file, &gold);
    }
    let library = b"newmtl gold\nKd 1 0.5 0\nmap_Kd a.png\nnewmtl blue\nKd 0.5\n";
    for file in truncations(library).chain(flipped_bits(library)) {
        if let Err(error) = Materials::default().read(&file) {
            assert_sentence(&error);
        }
    }
}

#[test]
fn foreign_lines_are_skipped_and_polygons_cut() {
    let mesh = read_plain(FOREIGN).unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [3, 2, 1], [0, 1, 4]]);
    let colors: Vec<Rgba> = mesh.vertices.iter().map(|vertex| vertex.color).collect();
    let half = Rgba::opaque(0, 128, 255);
    assert_eq!(
        colors,
        [NEUTRAL_GREY, NEUTRAL_GREY, RED, half, NEUTRAL_GREY]
    );
    assert_eq!((mesh.vertices[4].x, mesh.vertices[4].y), (0.01, -2.0));
}

#[test]
fn a_vertex_between_materials_becomes_two() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0 0 1 0\nusemtl a\nf 1 2 3\nusemtl b\nf 3 2 4\n";
    let library = materials("newmtl a\nKd 1 0 0\nnewmtl b\nKd 0 0 7\n").unwrap();
    let mesh = read(text.as_bytes(), &library).unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [4, 5, 3]]);
    let colors: Vec<Rgba> = mesh.vertices.iter().map(|vertex| vertex.color).collect();
    let own = Rgba::opaque(0, 255, 0);
    assert_eq!(colors, [RED, RED, RED, own, BLUE, BLUE]);
}

/// Reads the foreign file with one change, and expects an error with the reason.
#[track_caller]
fn check_refusal(from: &str, to: &str, reason: &str) {
    assert!(FOREIGN.contains(from), "{from}");
    let error = read_plain(&FOREIGN.replacen(from, to, 1)).unwrap_err();
    assert_sentence(&error);
    assert!(error.to_string().contains(reason), "{error} / {reason}");
}

#[test]
fn a_wrong_line_is_refused_with_its_reason() {
    for (from, to, reason) in [
        ("v 0 0 0", "v 0 0", "line 4 of"),
        ("v 0 0 0", "v 0 0 nan", "\"nan\""),
        ("v 0 0 0", "v 0 0 1e39", "not a finite number"),
        ("v 0 0 0", "v 0 0 0 0 0", "x y z"),
        ("v 0 0 0", "v 0 0 0 0 0 0 0 0", "too many numbers"),
        ("1 0 0\n", "255 0 0\n", "from 0 to 1"),
        ("f -1 -2 -3", "f -1 -2 -5", "no vertex -5"),
        ("f -1 -2 -3", "f 0 1 2", "\"0\" is not a corner"),
        ("f -1 -2 -3", "f 1 2", "three corners"),
        ("f -1 -2 -3", "f 1 2 /3", "not a corner"),
        ("f -1 -2 -3", "f 1 2 99999999999999999999", "not a corner"),
        ("f -1 -2 -3", "f 1 2 99999999", "no vertex 99999999"),
        (
            "2 5\n",
            "2 6\n",
            "line 16 of the OBJ file is wrong: there is no vertex 6",
        ),
    ] {
        check_refusal(from, to, reason);
    }
    let error = read_plain("vt 0 0\n").unwrap_err();
    assert!(matches!(error, ModelError::NoVertices), "{error}");
}

#[test]
fn a_wrong_library_is_refused_with_its_reason() {
    for (library, reason) in [
        ("Kd 1 0 0\n", "before the first material"),
        ("newmtl a\nKd 1 0\n", "line 2"),
        ("newmtl a\nKd 1 0 x\n", "\"x\""),
    ] {
        let error = materials(library).unwrap_err();
        assert_sentence(&error);
        assert!(error.to_string().contains(reason), "{error} / {reason}");
    }
    let found = materials("newmtl a\nKd spectral f.rfl\nnewmtl b c\nKd 0.2\n").unwrap();
    assert_eq!(found.color("a"), None);
    assert_eq!(found.color("b c"), Some(Rgba::opaque(51, 51, 51)));
}

#[test]
fn libraries_are_sought_in_the_same_folder_only() {
    let text = b"mtllib a b.mtl\nmtllib d.mtl e.mtl\nmtllib a b.mtl\nmtllib ..\nmtllib\n";
    let names = material_libraries(text).unwrap();
    assert_eq!(names, ["a b.mtl", "d.mtl", "e.mtl", ".."]);
    let many = (0..65).fold(String::new(), |many, idx| {
        many + &format!("mtllib {idx}.mtl\n")
    });
    assert_sentence(&material_libraries(many.as_bytes()).unwrap_err());

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("a.obj", "mtllib ./a b.mtl\nv 0 0 0\nusemtl m\nf 1 1 1\n");
    let model = open(&path).unwrap();
    assert_eq!(model.mesh.vertices[0].color, NEUTRAL_GREY);
    assert!(model.notes[0].contains("a b.mtl") && model.notes[0].contains("missing"));
    write("a b.mtl", "newmtl m\nKd 0 0 1\n");
    let model = open(&path).unwrap();
    assert_eq!(model.mesh.vertices[0].color, BLUE);
    assert!(model.notes.is_empty());
    write("a b.mtl", "newmtl m\nKd blue\n");
    let error = open(&path).unwrap_err();
    assert_sentence(&error);
    assert!(error.to_string().contains("a b.mtl"), "{error}");
    for outside in ["../c.mtl", "/etc/passwd", "C:\\a.mtl", "a/../../b.mtl"] {
        write(
            "a.obj",
            &format!("mtllib {outside}\nv 0 0 0\nusemtl m\nf 1 1 1\n"),
        );
        let notes = open(&path).unwrap().notes;
        assert!(notes[0].contains("leads out of"), "{notes:?}");
    }
}

/// Square with one triangle pair and the whole texture, in the xy plane, 2 x 2.
const SQUARE: &str = "mtllib maps/a.mtl\nv 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nvt 0 0\nvt 1 0\n\
    vt 1 1\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3 4/4\n";

/// Opens a square whose material has this line, beside a texture of four quarters.
fn textured_square(line: &str) -> FileModel {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    std::fs::create_dir(folder.path().join("maps")).unwrap();
    let side = 64;
    let quarters = (0..side * side).map(|i| match (i % side < side / 2, i / side < side / 2) {
        (true, true) => [255, 0, 0],
        (false, true) => [0, 255, 0],
        (true, false) => [0, 0, 255],
        (false, false) => [255; 3],
    });
    let samples: Vec<u8> = quarters.flatten().collect();
    let png = crate::texture::test_png(64, png::ColorType::Rgb, &samples);
    write("maps/four quarters.png", &png);
    write("broken.png", &png[..60]);
    write("old.tga", b"\0\0\x02");
    write("a.obj", SQUARE.as_bytes());
    write(
        "maps/a.mtl",
        format!("newmtl m\nKd 0 0 1\n{line}\n").as_bytes(),
    );
    open(&folder.path().join("a.obj")).unwrap()
}

#[test]
fn textures_are_seen_on_large_triangles() {
    for line in [
        "map_Kd four quarters.png",
        "map_Kd -clamp on -s 1 1 -o 0 0 0 ../maps\\four quarters.png",
    ] {
        let model = textured_square(line);
        assert!(model.notes.is_empty(), "{:?}", model.notes);
        let mesh = model.mesh;
        let n_triangles = mesh.triangles.len();
        assert!((2_000..=20_000).contains(&n_triangles), "{n_triangles}");
        let mut area = 0.0;
        for corners in &mesh.triangles {
            let [a, b, c] = corners.map(|i| mesh.vertices[i as usize].position());
            let normal = (b - a).cross(&(c - a));
            assert!(normal.z > 0.0);
            area += normal.z / 2.0;
        }
        assert!((area - 4.0).abs() < 1e-3, "{area}");
        for vertex in &mesh.vertices {
            let color = match (vertex.x, vertex.y) {
                (x, y) if (x - 1.0).abs() < 0.1 || (y - 1.0).abs() < 0.1 => continue,
                (x, y) if x.min(y) < 0.1 || x.max(y) > 1.9 => continue,
                (x, y) => match (x < 1.0, y > 1.0) {
                    (true, true) => RED,
                    (false, true) => Rgba::opaque(0, 255, 0),
                    (true, false) => BLUE,
                    (false, false) => Rgba::opaque(255, 255, 255),
                },
            };
            assert_eq!(vertex.color, color, "{vertex:?}");
        }
    }
}

#[test]
fn textures_that_cannot_be_used_are_told() {
    for (line, reason) in [
        ("map_Kd missing.png", "missing"),
        ("map_Kd", "leads out"),
        ("map_Kd ../old.tga", "neither PNG nor JPEG"),
        ("map_Kd ../broken.png", "PNG image"),
        ("map_Kd ../../outside.png", "leads out"),
        ("map_Kd /etc/passwd", "leads out"),
        ("map_Kd -s 1 C:\\maps\\a.png", "leads out"),
    ] {
        let model = textured_square(line);
        assert_eq!(model.notes.len(), 1);
        assert!(
            model.notes[0].contains(reason),
            "{:?} / {reason}",
            model.notes
        );
        assert_eq!(model.mesh.triangles.len(), 2);
        assert!(
            model
                .mesh
                .vertices
                .iter()
                .all(|vertex| vertex.color == BLUE)
        );
    }
}

#[test]
fn fuzz_obj_files() {
    let seeds = [FOREIGN.as_bytes().to_vec(), SQUARE.as_bytes().to_vec()];
    let library = materials("newmtl m\nmap_Kd -o 1 a.png\nnewmtl gold\nKd 1 0.5 0\n").unwrap();
    mutation_fuzzing::fuzz(&seeds, |bytes| check_read_or_explained(bytes, &library));
}
