//! Bends of rendered folds.

use super::*;
use point_cloud::{OrganizedCloud, Point, Rgba};
use proptest::prelude::*;

const WIDTH: usize = 640;
const HEIGHT: usize = 40;
const PITCH: f32 = 1.0 / 585.0;

/// Bends along the rows of an image band with depth `z(column, row)`, with their columns in
/// pixels.
fn bends_along_rows(z: impl Fn(f32, f32) -> f32) -> Vec<(usize, f32)> {
    let point = |i: usize| {
        let [column, row] = [i % WIDTH, i / WIDTH].map(|at| at as f32);
        let z = z(column, row);
        Point {
            x: (column - 320.0) * PITCH * z,
            y: row * PITCH * z,
            z,
            color: Rgba::default(),
        }
    };
    let points: Vec<Point> = (0..WIDTH * HEIGHT).map(point).collect();
    let cloud = OrganizedCloud::new(&points, WIDTH, HEIGHT).unwrap();
    let image = CellImage::of_cloud(&cloud);
    let mut bends = Bends::default();
    let pitch = PITCH * image.stride_px as f32;
    bends.refill(&image, pitch, &DepthNoise::default());
    let cells = image.cells.iter().map(|cell| {
        let place = cell.place as usize;
        (image.first_pixel(place)[0], bends.along_row[place])
    });
    cells.filter(|(_, bend)| !bend.is_nan()).collect()
}

/// Depth of two planes that meet at column 320, each inclined by `slope` metres per metre.
fn folded(slope: f32, column: f32) -> f32 {
    1.0 / (1.0 + slope * (column - 320.0).abs() * PITCH)
}

#[test]
fn a_fold_bends_by_its_slope_and_only_where_it_folds() {
    for slope in [-1.0, -0.4, 0.4, 1.0_f32] {
        let bends = bends_along_rows(|column, _| folded(slope, column));
        assert!(bends.len() > 1000);
        let at_fold = bends.iter().filter(|(column, _)| column.abs_diff(320) <= 2);
        for (_, bend) in at_fold {
            assert!((bend - slope).abs() < 0.3 * slope.abs(), "{bend}");
        }
        let away = bends.iter().filter(|(column, _)| column.abs_diff(320) > 60);
        assert!(away.clone().count() > 100);
        for (column, bend) in away {
            assert!(bend.abs() < 0.02, "{column} {bend}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    #[test]
    fn a_plane_has_no_bend(a in -0.6..0.6_f32, b in -2.0..2.0_f32) {
        let plane = |column: f32, row: f32| 1.0 / (1.0 + (a * (column - 320.0) + b * row) * PITCH);
        for (_, bend) in bends_along_rows(plane) {
            prop_assert!(bend.abs() < 0.05);
        }
    }
}
