//! Generated simulation scene of six equal cubes.

use dataset::{FileError, write_atomic};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Centres of the cubes on the table, world x and y, metres; the largest cubes still stand apart.
const PLACES_M: [[f64; 2]; 6] = [
    [-0.36, -0.12],
    [0.0, -0.12],
    [0.36, -0.12],
    [-0.36, 0.18],
    [0.0, 0.18],
    [0.36, 0.18],
];

/// Writes a scene of six cubes of the given side and returns the path of its file.
///
/// # Errors
/// If a file cannot be written.
pub(super) fn write(folder: &Path, side_m: f64) -> Result<PathBuf, FileError> {
    write_atomic(&folder.join("cube.obj"), cube(side_m))?;
    let mut scene = String::from("seed = 1\n");
    for [x, y] in PLACES_M {
        let _ = write!(
            scene,
            "\n[[object]]\nmodel = \"cube.obj\"\nposition_m = [{x}, {y}]\nyaw_deg = 20.0\n"
        );
    }
    let path = folder.join("cubes.toml");
    write_atomic(&path, scene)?;
    Ok(path)
}

/// Cube as OBJ text, faces counter-clockwise from outside.
fn cube(side_m: f64) -> String {
    let half = 0.5 * side_m;
    let mut text = String::new();
    for corner in 0..8 {
        let along = |bit: u32| if corner >> bit & 1 == 1 { half } else { -half };
        let _ = writeln!(text, "v {} {} {} 0.8 0.3 0.2", along(0), along(1), along(2));
    }
    for [a, b, c, d] in [
        [1, 3, 4, 2],
        [5, 6, 8, 7],
        [1, 2, 6, 5],
        [3, 7, 8, 4],
        [1, 5, 7, 3],
        [2, 4, 8, 6],
    ] {
        let _ = writeln!(text, "f {a} {b} {c}\nf {a} {c} {d}");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_faces_look_outwards() {
        let text = cube(0.1);
        let numbers = |line: &str| -> Vec<f64> {
            let words = line.split_ascii_whitespace().skip(1);
            words.map(|word| word.parse().unwrap()).collect()
        };
        let of_kind = |kind: &'static str| text.lines().filter(move |line| line.starts_with(kind));
        let corners: Vec<Vec<f64>> = of_kind("v ").map(numbers).collect();
        assert_eq!(of_kind("f ").count(), 12);
        for face in of_kind("f ") {
            let corner = |i: usize| &corners[numbers(face)[i] as usize - 1];
            let edge = |i: usize| [0, 1, 2].map(|axis| corner(i)[axis] - corner(0)[axis]);
            let ([ax, ay, az], [bx, by, bz]) = (edge(1), edge(2));
            let normal = [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx];
            let outwards: f64 = (0..3).map(|axis| normal[axis] * corner(0)[axis]).sum();
            assert!(outwards > 0.0, "{face}");
        }
    }
}
