//! Camera calibration: least-squares fit of pinhole intrinsics to an organised cloud.

use geometry::PinholeCamera;
use point_cloud::Point;

/// Subsampling of rows and columns. Chosen.
const STRIDE: usize = 4;
/// Smallest number of points for a fit. Chosen.
const MIN_POINTS: f64 = 500.0;
/// Largest root mean square residual of the fit, pixels. Chosen.
const MAX_RMS_PX: f64 = 1.0;

/// Running sums of a simple linear regression.
#[derive(Default)]
struct LinearRegression {
    n: f64,
    x: f64,
    y: f64,
    xx: f64,
    xy: f64,
    yy: f64,
}

impl LinearRegression {
    fn add(&mut self, x: f64, y: f64) {
        self.n += 1.0;
        self.x += x;
        self.y += y;
        self.xx += x * x;
        self.xy += x * y;
        self.yy += y * y;
    }

    /// Slope, intercept and root mean square residual.
    fn fit(&self) -> Option<(f64, f64, f64)> {
        let spread = self.n * self.xx - self.x * self.x;
        if self.n < MIN_POINTS || spread <= 1e-9 {
            return None;
        }
        let slope = (self.n * self.xy - self.x * self.y) / spread;
        let intercept = (self.y - slope * self.x) / self.n;
        let residual = self.yy - intercept * self.y - slope * self.xy;
        Some((slope, intercept, (residual / self.n).max(0.0).sqrt()))
    }
}

/// Least-squares fit of column = fx·x/z + cx and row = fy·y/z + cy. PCD files carry no
/// intrinsics, but an organised cloud in the camera frame implies them. `None` when the
/// points do not follow a pinhole camera within a pixel.
pub(crate) fn fit(points: &[Point], width: usize, height: usize) -> Option<PinholeCamera> {
    let (mut columns, mut rows) = (LinearRegression::default(), LinearRegression::default());
    for row in (0..height).step_by(STRIDE) {
        for column in (0..width).step_by(STRIDE) {
            let p = &points[row * width + column];
            if p.is_finite() && p.z > 0.0 {
                let z = f64::from(p.z);
                columns.add(f64::from(p.x) / z, column as f64);
                rows.add(f64::from(p.y) / z, row as f64);
            }
        }
    }
    let ((fx_px, cx_px, rms_x), (fy_px, cy_px, rms_y)) = (columns.fit()?, rows.fit()?);
    if rms_x.max(rms_y) > MAX_RMS_PX {
        return None;
    }
    let size = [width as u32, height as u32];
    PinholeCamera::with_intrinsics([fx_px, fy_px, cx_px, cy_px], size).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cloud(camera: &PinholeCamera) -> Vec<Point> {
        let depth = |i: usize| 0.8 + 0.3 * ((i % 977) as f64 / 977.0);
        (0..camera.n_pixels())
            .map(|i| {
                let (row, column) = (i / camera.width as usize, i % camera.width as usize);
                let p = camera.back_project(column as f64, row as f64, depth(i));
                Point {
                    x: p.x as f32,
                    y: p.y as f32,
                    z: p.z as f32,
                    ..Point::default()
                }
            })
            .collect()
    }

    #[test]
    fn intrinsics_of_a_rendered_cloud_are_recovered() {
        let camera = PinholeCamera {
            fx_px: 525.0,
            fy_px: 527.0,
            cx_px: 310.0,
            ..PinholeCamera::KINECT_V1
        };
        let found = fit(&cloud(&camera), 640, 480).unwrap();
        assert!((found.fx_px - 525.0).abs() < 0.01 && (found.fy_px - 527.0).abs() < 0.01);
        assert!((found.cx_px - 310.0).abs() < 0.01 && (found.cy_px - camera.cy_px).abs() < 0.01);
    }

    #[test]
    fn clouds_of_no_pinhole_camera_have_no_intrinsics() {
        let mut shuffled = cloud(&PinholeCamera::KINECT_V1);
        shuffled.chunks_mut(2000).for_each(<[Point]>::reverse);
        assert_eq!(fit(&shuffled, 640, 480), None);
        let empty = vec![Point::without_depth(point_cloud::Rgba::default()); 640 * 480];
        assert_eq!(fit(&empty, 640, 480), None);
    }
}
