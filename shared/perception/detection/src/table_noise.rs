//! Depth noise estimation: noise and warp of the depth image, measured on the table itself.

use crate::affine_form::AffineForm;
use crate::samples::Samples;
use crate::table::Table;
use crate::table_surface::TableSurface;
use sensor_noise::DepthNoise;

/// Width of a histogram bin, ratio of a residual to the law.
const BIN: f32 = 0.1;

/// Number of bins; the last one holds all larger residuals.
const N_BINS: usize = 128;

/// Quantile of the residuals that is compared with the law's standard deviation: the share of
/// a normal distribution within one. The shadows around objects are above it.
const ONE_SIGMA_SHARE: f32 = 0.683;

/// Greatest depth of a residual under the table's plane, metres; farther points are seen
/// beside the table or through it. Chosen.
const RESIDUAL_MAX_M: f32 = 0.03;

/// Least number of residuals for a measurement. Chosen.
const N_RESIDUALS_MIN: u32 = 300;

/// Greatest ratio to the law, so that a wrong plane cannot blind detection. Chosen.
const RATIO_MAX: f32 = 4.0;

/// Ratio of the depth noise on a table to a law, 1 to 4: a quantile of the residuals of the
/// samples under its plane, where nothing but noise and warp can be. 1 when there are too few.
pub(crate) fn noise_ratio(
    samples: &Samples,
    table: &Table,
    surface: &TableSurface,
    law: &DepthNoise,
) -> f32 {
    let [u, v, height] = AffineForm::coordinates_of(&table.table_from_camera);
    let mut histogram = [0_u32; N_BINS];
    for sample in 0..samples.len() {
        let residual_m = -samples.coordinate(&height, sample);
        if samples.is_unassigned(sample)
            && (0.0..RESIDUAL_MAX_M).contains(&residual_m)
            && surface.is_table(
                samples.coordinate(&u, sample),
                samples.coordinate(&v, sample),
            )
        {
            let ratio = residual_m / law.sigma_m(samples.depth(sample));
            histogram[((ratio / BIN) as usize).min(N_BINS - 1)] += 1;
        }
    }
    let n: u32 = histogram.iter().sum();
    if n < N_RESIDUALS_MIN {
        return 1.0;
    }
    let mut n_below = 0;
    let bin = histogram.iter().position(|n_in_bin| {
        n_below += n_in_bin;
        n_below as f32 >= ONE_SIGMA_SHARE * n as f32
    });
    let quantile = (bin.unwrap_or(N_BINS - 1) as f32 + 0.5) * BIN;
    quantile.clamp(1.0, RATIO_MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::RawConfig;
    use crate::outline::Outline;
    use crate::table::{SurfaceRole, TableChoice};
    use geometry::{ConvexPolygon, Plane};
    use nalgebra::{Point2, Point3, Vector3};
    use point_cloud::{OrganizedCloud, Point, Rgba};
    use random::Random;

    const WIDTH: usize = 160;
    const HEIGHT: usize = 120;

    /// Ratio measured on a table 1 m in front of the camera, with `ratio` times the noise of
    /// the law; every fifth point belongs to an object `object_m` nearer.
    fn measured(ratio: f32, object_m: f32, n_rows: usize) -> f32 {
        let law = DepthNoise::default();
        let mut random = Random::from_seed(1);
        let points: Vec<Point> = (0..WIDTH * n_rows)
            .map(|i| {
                let noise_m = ratio * law.sigma_m(1.0) * random.normal_f32();
                let object_m = if i % 5 == 0 { object_m } else { 0.0 };
                let place = [i % WIDTH, i / WIDTH].map(|at| (at as f32 - 60.0) / 585.0);
                Point {
                    x: place[0],
                    y: place[1],
                    z: 1.0 + noise_m - object_m,
                    color: Rgba::default(),
                }
            })
            .collect();
        let mut samples = Samples::default();
        let cloud = OrganizedCloud::new(&points, WIDTH, n_rows).unwrap();
        samples.refill(&cloud, &RawConfig::default());
        let plane = Plane::through(&Point3::new(0.0, 0.0, 1.0), -Vector3::z_axis());
        let mut corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]].map(Point2::from);
        let table = Table {
            plane,
            plane_by_image: plane,
            table_from_camera: plane.plane_from_source(),
            polygon: ConvexPolygon::convex_hull_of(&mut corners),
            outline: Outline::default(),
            choice: TableChoice::Only,
            role: SurfaceRole::Table,
            n_samples: 0,
            depth_noise: law,
            noise_ratio: 1.0,
        };
        let mut surface = TableSurface::default();
        surface.refill_from_polygon(&table.polygon);
        noise_ratio(&samples, &table, &surface, &law)
    }

    #[test]
    fn noise_is_measured_beside_objects() {
        for ratio in [1.5, 2.0, 3.0] {
            for object_m in [0.0, 0.1] {
                let found = measured(ratio, object_m, HEIGHT);
                assert!((found / ratio - 1.0).abs() < 0.1, "{ratio}: {found}");
            }
        }
    }

    #[test]
    fn less_noise_than_the_law_or_too_few_points_give_the_law() {
        assert_eq!(measured(0.3, 0.0, HEIGHT), 1.0);
        assert_eq!(measured(3.0, 0.0, 2), 1.0);
        assert_eq!(measured(30.0, 0.0, HEIGHT), RATIO_MAX);
    }
}
