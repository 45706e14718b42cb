//! Properties of all instances of all categories: geometry, mass, physics parts.

use household::{Category, Object, categories, category, generate};
use mesh::MAX_HULL_POINTS;
use nalgebra::Point3;
use std::collections::HashSet;

const N_INSTANCES: u64 = 20;

/// Checks a property of all categories and reports the first fault of each.
fn check(n_instances: u64, is_true: impl Fn(&Object) -> Result<(), String>) {
    let mut faults = Vec::new();
    for category in categories() {
        let fault = (0..n_instances).find_map(|instance| {
            let fault = is_true(&generate(category, instance)).err()?;
            Some(format!("{} {instance}: {fault}", category.name))
        });
        faults.extend(fault);
    }
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

fn ensure(is_true: bool, fault: impl FnOnce() -> String) -> Result<(), String> {
    if is_true { Ok(()) } else { Err(fault()) }
}

#[test]
fn category_names_are_unique_and_valid_keys() {
    let names: HashSet<&str> = categories().iter().map(|category| category.name).collect();
    assert_eq!(names.len(), categories().len());
    assert!(names.len() >= 51);
    for name in names {
        let fits = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
        assert!(name.chars().all(fits), "{name}");
        assert_eq!(category(name).map(|category| category.name), Some(name));
    }
    assert!(category("no-such-thing").is_none());
}

#[test]
fn meshes_are_sound() {
    check(N_INSTANCES, |object| {
        let found = object.mesh.diagnostics();
        ensure(found.is_sound(), || format!("{found:?}"))
    });
}

#[test]
fn mesh_parts_face_outwards() {
    check(N_INSTANCES / 3, |object| {
        let parts = object.mesh.connected_components();
        let inward = parts.iter().find(|part| part.signed_volume() <= 0.0);
        ensure(inward.is_none(), || {
            format!("{:?}", inward.and_then(mesh::TriangleMesh::bounds))
        })
    });
}

#[test]
fn normals_have_unit_length_and_face_outwards() {
    check(N_INSTANCES / 3, |object| {
        let vertices = &object.mesh.vertices;
        let n_wrong = object.mesh.triangles.iter().filter(|triangle| {
            let [a, b, c] = triangle.vertices.map(|i| vertices[i as usize]);
            let face = (b.position - a.position).cross(&(c.position - a.position));
            let is_wrong =
                |n: nalgebra::Vector3<f32>| (n.norm() - 1.0).abs() > 1e-3 || n.dot(&face) < 0.0;
            [a, b, c].iter().any(|vertex| is_wrong(vertex.normal))
        });
        let n_wrong = n_wrong.count();
        ensure(n_wrong == 0, || format!("{n_wrong} faces"))
    });
}

#[test]
fn object_origin_is_the_box_centre_and_sizes_are_realistic() {
    check(N_INSTANCES, |object| {
        let bounds = object.mesh.bounds().ok_or("no mesh")?;
        ensure(bounds.centre().coords.norm() < 1e-5, || {
            format!("centre at {}", bounds.centre())
        })?;
        let mut sides_mm: Vec<f32> = bounds.sides().iter().map(|side| side * 1000.0).collect();
        sides_mm.sort_by(|a, b| b.total_cmp(a));
        let (_, ranges) = SIDES_MM
            .iter()
            .find(|(name, _)| *name == object.category)
            .ok_or("not in the table of sizes")?;
        let fits =
            |(side, (low, high)): (&f32, &(u32, u32))| (*low as f32..=*high as f32).contains(side);
        ensure(sides_mm.iter().zip(ranges).all(fits), || {
            format!("{sides_mm:.0?} mm instead of {ranges:?}")
        })
    });
}

#[test]
fn object_masses_are_realistic() {
    check(N_INSTANCES / 3, |object| {
        let is_possible = (0.005..3.0).contains(&object.mass_kg);
        ensure(is_possible, || format!("{} kg", object.mass_kg))?;
        ensure((0.2..=0.8).contains(&object.friction), || {
            format!("friction {}", object.friction)
        })
    });
}

#[test]
fn mesh_triangle_counts_are_within_limits() {
    check(N_INSTANCES, |object| {
        let n = object.mesh.triangles.len();
        ensure((100..=9200).contains(&n), || format!("{n} triangles"))
    });
}

#[test]
fn convex_parts_are_few_and_cover_the_body() {
    check(N_INSTANCES / 3, |object| {
        let n_parts = object.convex_parts.len();
        ensure((1..=32).contains(&n_parts), || format!("{n_parts} parts"))?;
        for part in &object.convex_parts {
            let n = part.points.len();
            ensure((4..=MAX_HULL_POINTS).contains(&n), || format!("{n} points"))?;
            let is_finite = part.points.iter().all(|p| p.iter().all(|x| x.is_finite()));
            ensure(is_finite, || format!("{part:?}"))?;
        }
        let is_near = |p: &Point3<f32>| {
            let mut parts = object.convex_parts.iter();
            parts.any(|part| part.distance(p) < allowed_gap_m(object))
        };
        let sample: Vec<_> = body(object).step_by(17).collect();
        let far = sample.into_iter().find(|p| !is_near(p));
        ensure(far.is_none(), || {
            let gap = far.map(|p| distance(object, &p) * 1000.0);
            format!("{gap:.1?} mm at {far:.3?}")
        })
    });
}

/// Corners of all triangles that are not decoration.
fn body(object: &Object) -> impl Iterator<Item = Point3<f32>> {
    let is_body = |i: &usize| object.decoration.iter().all(|range| !range.contains(i));
    let triangles = object.mesh.triangles.iter().enumerate();
    triangles
        .filter(move |(i, _)| is_body(i))
        .flat_map(|(_, triangle)| triangle.vertices)
        .map(|i| object.mesh.vertices[i as usize].position)
}

#[test]
fn convex_parts_share_the_lowest_point_of_the_mesh() {
    check(N_INSTANCES, |object| {
        let lowest = |z: &mut dyn Iterator<Item = f32>| z.fold(f32::MAX, f32::min);
        let seen = lowest(&mut object.mesh.vertices.iter().map(|v| v.position.z));
        let points = object.convex_parts.iter().flat_map(|part| &part.points);
        let stands = lowest(&mut points.map(|p| p.z));
        ensure((seen - stands).abs() < 0.0035, || {
            format!("{:.1} mm below its parts", (stands - seen) * 1000.0)
        })
    });
}

#[test]
fn convex_parts_stay_within_the_bounding_box() {
    check(N_INSTANCES / 3, |object| {
        let sides = object.mesh.bounds().ok_or("no mesh")?.sides();
        let points = object.convex_parts.iter().flat_map(|part| &part.points);
        let out = points
            .map(|p| (p.coords.abs() - sides / 2.0).max())
            .fold(0.0, f32::max);
        ensure(out < 0.006, || format!("{:.1} mm", out * 1000.0))
    });
}

#[test]
fn vessels_are_hollow() {
    for name in [
        "bowl",
        "mug",
        "pitcher",
        "vase",
        "pencil-cup",
        "pan",
        "open-box",
    ] {
        for instance in 0..N_INSTANCES {
            let object = generate(category(name).unwrap(), instance);
            let points = object.mesh.vertices.iter().map(|vertex| vertex.position);
            // The middle of the wall, not of the box, which the handle shifts.
            let high = points.clone().map(|p| p.z).fold(f32::MIN, f32::max);
            let low = points.map(|p| p.z).fold(f32::MAX, f32::min);
            let foot = object
                .mesh
                .vertices
                .iter()
                .filter(|v| v.position.z < low + 0.001);
            let middle = mesh::Bounds::of(foot.map(|v| v.position)).unwrap().centre();
            let at = Point3::new(middle.x, middle.y, low + 0.62 * (high - low));
            let gap = distance(&object, &at);
            assert!(gap > 0.006, "{name} {instance}: {:.1} mm", gap * 1000.0);
        }
    }
}

#[test]
fn generation_is_deterministic_and_instances_differ() {
    for category in categories() {
        let make = |instance| generate(category, instance);
        assert_eq!(make(7), make(7), "{}", category.name);
        let sizes: HashSet<[u32; 3]> = (0..N_INSTANCES).map(|i| sides_bits(category, i)).collect();
        assert_eq!(sizes.len() as u64, N_INSTANCES, "{}", category.name);
        let color = |i| mean_color(&make(i)).map(|c| (c / 4.0) as u32);
        let colors: HashSet<[u32; 3]> = (0..N_INSTANCES).map(color).collect();
        assert!(
            colors.len() >= 6,
            "{}: {} colours",
            category.name,
            colors.len()
        );
    }
}

fn sides_bits(category: &Category, instance: u64) -> [u32; 3] {
    let bounds = generate(category, instance).mesh.bounds();
    let sides = bounds.map_or_else(nalgebra::Vector3::zeros, |bounds| bounds.sides());
    [sides.x, sides.y, sides.z].map(f32::to_bits)
}

fn mean_color(object: &Object) -> [f32; 3] {
    let vertices = &object.mesh.vertices;
    let mean = |i: usize| {
        let sum: f32 = vertices.iter().map(|v| f32::from(v.color[i])).sum();
        sum / vertices.len() as f32
    };
    [mean(0), mean(1), mean(2)]
}

fn distance(object: &Object, point: &Point3<f32>) -> f32 {
    let distances = object.convex_parts.iter().map(|part| part.distance(point));
    distances.fold(f32::INFINITY, f32::min)
}

/// Greatest distance between surface and convex parts, metres; wires and lips are simplified.
fn allowed_gap_m(object: &Object) -> f32 {
    match object.category {
        "whisk" | "pitcher" => 0.012,
        _ => 0.0075,
    }
}

/// Sides of the bounding box, longest first, as ranges in millimetres.
const SIDES_MM: &[(&str, [(u32, u32); 3])] = &[
    ("bowl", [(116, 192), (116, 192), (51, 85)]),
    ("mug", [(100, 132), (81, 109), (72, 95)]),
    ("teacup", [(128, 155), (128, 155), (56, 72)]),
    ("plate", [(184, 275), (184, 275), (21, 31)]),
    ("goblet", [(137, 186), (62, 83), (62, 82)]),
    ("teapot", [(190, 245), (117, 160), (113, 154)]),
    ("pitcher", [(168, 229), (139, 182), (98, 128)]),
    ("vase", [(187, 278), (88, 137), (88, 135)]),
    ("flowerpot", [(101, 150), (101, 150), (87, 134)]),
    ("pot", [(214, 278), (146, 209), (78, 168)]),
    ("pan", [(306, 393), (155, 206), (43, 60)]),
    ("kettle", [(164, 222), (159, 202), (125, 163)]),
    ("tray", [(253, 348), (176, 244), (41, 59)]),
    ("rolling-pin", [(302, 380), (40, 58), (40, 58)]),
    ("bottle", [(233, 317), (62, 85), (62, 85)]),
    ("soda-can", [(112, 155), (51, 68), (51, 68)]),
    ("tin-can", [(68, 124), (68, 94), (56, 93)]),
    ("jar", [(82, 134), (62, 89), (62, 89)]),
    ("shampoo", [(160, 241), (61, 89), (34, 54)]),
    ("spray-bottle", [(189, 232), (93, 107), (50, 65)]),
    ("salt-shaker", [(68, 99), (36, 53), (35, 52)]),
    ("thermos", [(213, 286), (78, 98), (66, 86)]),
    ("cereal-box", [(242, 319), (164, 217), (48, 72)]),
    ("tissue-box", [(149, 248), (106, 129), (93, 126)]),
    ("matchbox", [(54, 80), (33, 40), (11, 18)]),
    ("milk-carton", [(198, 262), (64, 79), (64, 79)]),
    ("juice-box", [(149, 183), (45, 57), (35, 44)]),
    ("book", [(175, 247), (118, 177), (15, 42)]),
    ("sponge", [(82, 118), (52, 72), (27, 44)]),
    ("toothpaste", [(161, 216), (48, 61), (30, 41)]),
    ("spoon", [(151, 202), (32, 44), (14, 26)]),
    ("fork", [(175, 224), (20, 28), (12, 23)]),
    ("knife", [(181, 264), (18, 30), (16, 17)]),
    ("spatula", [(240, 311), (62, 87), (25, 53)]),
    ("ladle", [(239, 312), (58, 81), (33, 54)]),
    ("whisk", [(221, 285), (48, 73), (46, 73)]),
    ("apple", [(64, 87), (62, 85), (60, 82)]),
    ("pear", [(97, 134), (58, 77), (54, 75)]),
    ("banana", [(141, 209), (65, 97), (27, 37)]),
    ("orange", [(66, 91), (66, 91), (64, 90)]),
    ("lemon", [(66, 93), (46, 62), (45, 61)]),
    ("strawberry", [(34, 56), (27, 44), (26, 40)]),
    ("peach", [(60, 81), (57, 78), (55, 76)]),
    ("tomato", [(55, 84), (53, 84), (52, 77)]),
    ("carrot", [(174, 269), (25, 38), (25, 38)]),
    ("bell-pepper", [(84, 120), (62, 88), (62, 86)]),
    ("eggplant", [(202, 270), (56, 110), (55, 83)]),
    ("mushroom", [(36, 66), (36, 64), (33, 63)]),
    ("donut", [(79, 103), (79, 103), (22, 38)]),
    ("bread", [(194, 266), (78, 108), (36, 62)]),
    ("egg", [(52, 67), (40, 49), (40, 49)]),
    ("cupcake", [(74, 94), (65, 82), (65, 81)]),
    ("croissant", [(106, 143), (58, 88), (35, 46)]),
    ("hammer", [(244, 322), (83, 114), (24, 35)]),
    ("screwdriver", [(163, 244), (25, 37), (23, 34)]),
    ("wrench", [(179, 261), (29, 44), (5, 12)]),
    ("pliers", [(150, 205), (55, 76), (12, 14)]),
    ("clamp", [(142, 212), (80, 105), (20, 22)]),
    ("flashlight", [(137, 197), (41, 58), (40, 56)]),
    ("paintbrush", [(174, 225), (39, 69), (12, 19)]),
    ("light-bulb", [(95, 122), (55, 71), (54, 70)]),
    ("magnifier", [(180, 234), (72, 101), (17, 19)]),
    ("scissors", [(148, 198), (82, 112), (10, 12)]),
    ("tape-roll", [(69, 113), (69, 113), (19, 52)]),
    ("marker", [(111, 145), (17, 26), (16, 24)]),
    ("stapler", [(116, 160), (42, 58), (27, 35)]),
    ("glue-stick", [(82, 108), (25, 36), (25, 36)]),
    ("calculator", [(116, 165), (67, 98), (12, 20)]),
    ("pencil-cup", [(139, 176), (66, 87), (66, 87)]),
    ("phone", [(131, 170), (62, 81), (8, 13)]),
    ("remote-control", [(146, 217), (40, 54), (18, 26)]),
    ("computer-mouse", [(97, 123), (50, 65), (35, 47)]),
    ("keyboard", [(273, 371), (102, 135), (19, 32)]),
    ("lamp", [(262, 369), (145, 195), (145, 195)]),
    ("headphones", [(155, 186), (125, 150), (62, 79)]),
    ("tennis-ball", [(62, 71), (62, 71), (62, 71)]),
    ("soccer-ball", [(139, 205), (139, 205), (139, 205)]),
    ("puzzle-cube", [(50, 70), (50, 70), (50, 70)]),
    ("toy-car", [(86, 135), (46, 62), (33, 51)]),
    ("toy-duck", [(76, 124), (67, 102), (56, 85)]),
    ("toy-brick", [(30, 68), (30, 34), (12, 24)]),
    ("toy-bridge", [(77, 108), (35, 48), (29, 44)]),
    ("candle", [(87, 157), (48, 77), (48, 75)]),
    ("cap", [(230, 283), (147, 180), (102, 130)]),
    ("dice", [(27, 47), (27, 47), (27, 47)]),
    ("teddy", [(124, 182), (97, 143), (89, 132)]),
    ("carton", [(79, 326), (61, 236), (22, 146)]),
    ("magazine", [(240, 300), (170, 215), (3, 11)]),
    ("cookie-tin", [(141, 220), (141, 220), (45, 90)]),
    ("open-box", [(160, 280), (120, 200), (50, 100)]),
];
