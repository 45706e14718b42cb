//! Cameras of virtual views: that of the frames, as coarse as the measured points.

use geometry::PinholeCamera;

/// Scale of the image at most: a finer one has holes between measured points.
const SCALE_MAX: f64 = 0.5;
/// Least width and height of an image, pixels.
const SIZE_MIN_PX: f64 = 16.0;

/// Camera with the field of view of another one, and pixels of at least a cell at a distance.
pub(crate) fn coarse(camera: &PinholeCamera, distance_m: f64, cell_m: f64) -> PinholeCamera {
    let focal_px = camera.fx_px.max(camera.fy_px);
    let least = SIZE_MIN_PX / f64::from(camera.width.min(camera.height).max(1));
    let scale = (distance_m / cell_m / focal_px).min(SCALE_MAX).max(least);
    // The middle of pixel 0 is at 0, and its left edge at -0.5.
    let principal = |c_px: f64| (c_px + 0.5) * scale - 0.5;
    PinholeCamera {
        fx_px: camera.fx_px * scale,
        fy_px: camera.fy_px * scale,
        cx_px: principal(camera.cx_px),
        cy_px: principal(camera.cy_px),
        width: (f64::from(camera.width) * scale).round() as u32,
        height: (f64::from(camera.height) * scale).round() as u32,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;

    #[test]
    fn coarse_camera_has_the_same_field_of_view() {
        let fine = PinholeCamera::KINECT_V1;
        let coarse = coarse(&fine, 0.9, 0.003);
        assert!(coarse.validated().is_ok());
        assert!((0.9 / coarse.fx_px - 0.003).abs() < 2e-4 || coarse.width == fine.width / 2);
        let place = Point3::new(0.12, -0.2, 0.9);
        let (a, b) = (
            fine.project(&place).unwrap(),
            coarse.project(&place).unwrap(),
        );
        let scale = coarse.fx_px / fine.fx_px;
        assert!(((a.x + 0.5) * scale - (b.x + 0.5)).abs() < 1e-9);
        assert!(((a.y + 0.5) * scale - (b.y + 0.5)).abs() < 1e-9);
    }
}
