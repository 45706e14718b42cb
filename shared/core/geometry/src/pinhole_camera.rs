//! Pinhole camera model without lens distortion.

use nalgebra::{Point2, Point3, Vector3};

/// Intrinsics of a pinhole camera; x right, y down, z forward.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PinholeCamera {
    /// Focal length along the image's rows, pixels.
    pub fx_px: f64,
    /// Focal length along the image's columns, pixels.
    pub fy_px: f64,
    /// Principal point, column, pixels from the centre of the first pixel.
    pub cx_px: f64,
    /// Principal point, row, pixels from the centre of the first pixel.
    pub cy_px: f64,
    /// Image width, pixels.
    pub width: u32,
    /// Image height, pixels.
    pub height: u32,
}

/// Error of validating camera intrinsics: the values and the broken rule.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "the camera intrinsics fx {:?} fy {:?} cx {:?} cy {:?} for an image of {}x{} are wrong: {rule}",
    .camera.fx_px, .camera.fy_px, .camera.cx_px, .camera.cy_px, .camera.width, .camera.height
)]
pub struct InvalidIntrinsics {
    camera: PinholeCamera,
    rule: &'static str,
}

impl PinholeCamera {
    /// Nominal depth camera of a Kinect v1 (Burrus 2010).
    pub const KINECT_V1: Self = Self {
        fx_px: 585.0,
        fy_px: 585.0,
        cx_px: 319.5,
        cy_px: 239.5,
        width: 640,
        height: 480,
    };

    /// Validates the camera intrinsics.
    ///
    /// # Errors
    /// Says which rule is broken: sizes from 1 to 8192 pixels, focal lengths
    /// finite and between a tenth and a hundred times the image's longer side,
    /// principal point within the image widened by its own size on each side.
    pub fn validated(self) -> Result<Self, InvalidIntrinsics> {
        let wrong = |rule| Err(InvalidIntrinsics { camera: self, rule });
        if !(1..=8192).contains(&self.width) || !(1..=8192).contains(&self.height) {
            return wrong("the image size must lie between 1 and 8192 pixels a side");
        }
        let (width, height) = (f64::from(self.width), f64::from(self.height));
        let focal_range = 0.1 * width.max(height)..=100.0 * width.max(height);
        if !focal_range.contains(&self.fx_px) || !focal_range.contains(&self.fy_px) {
            return wrong("focal lengths must lie between 0.1 and 100 times the longer image side");
        }
        if !(-width..=2.0 * width).contains(&self.cx_px)
            || !(-height..=2.0 * height).contains(&self.cy_px)
        {
            return wrong("the principal point must lie near the image");
        }
        Ok(self)
    }

    /// Camera with the focal lengths and principal point fx, fy, cx, cy, and the width and height
    /// of its images, pixels.
    ///
    /// # Errors
    /// As [`validated`](Self::validated).
    pub fn with_intrinsics(
        [fx_px, fy_px, cx_px, cy_px]: [f64; 4],
        [width, height]: [u32; 2],
    ) -> Result<Self, InvalidIntrinsics> {
        Self {
            fx_px,
            fy_px,
            cx_px,
            cy_px,
            width,
            height,
        }
        .validated()
    }

    /// Back-projects a pixel at depth `z_m` to a point, camera frame, metres.
    #[inline]
    pub fn back_project(&self, column: f64, row: f64, z_m: f64) -> Point3<f64> {
        Point3::from(self.ray(column, row) * z_m)
    }

    /// Viewing ray of a pixel, scaled to z = 1, camera frame.
    #[inline]
    pub fn ray(&self, column: f64, row: f64) -> Vector3<f64> {
        Vector3::new(
            (column - self.cx_px) / self.fx_px,
            (row - self.cy_px) / self.fy_px,
            1.0,
        )
    }

    /// Projects a point to pixel coordinates (column, row); `None` at or behind the camera. The
    /// result may lie outside the image.
    #[inline]
    pub fn project(&self, point_in_camera: &Point3<f64>) -> Option<Point2<f64>> {
        (point_in_camera.z > 0.0).then(|| {
            Point2::new(
                self.fx_px * point_in_camera.x / point_in_camera.z + self.cx_px,
                self.fy_px * point_in_camera.y / point_in_camera.z + self.cy_px,
            )
        })
    }

    /// Column and row of the pixel that shows a point; `None` at or behind the camera and outside
    /// of the image.
    #[inline]
    pub fn pixel_of(&self, point_in_camera: &Point3<f64>) -> Option<[usize; 2]> {
        let place = self.project(point_in_camera)?;
        let (column, row) = (place.x.round(), place.y.round());
        let is_inside = (0.0..f64::from(self.width)).contains(&column)
            && (0.0..f64::from(self.height)).contains(&row);
        is_inside.then_some([column as usize, row as usize])
    }

    /// Number of pixels of the image.
    pub fn n_pixels(&self) -> usize {
        self.width as usize * self.height as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn projection_inverts_back_projection() {
        let camera = PinholeCamera::KINECT_V1;
        for (column, row, z) in [(0.0, 0.0, 0.5), (319.5, 239.5, 1.0), (639.0, 12.5, 3.0)] {
            let pixel = camera
                .project(&camera.back_project(column, row, z))
                .unwrap();
            assert!((pixel.x - column).abs() < 1e-9 && (pixel.y - row).abs() < 1e-9);
        }
    }

    #[test]
    fn nothing_behind_the_camera_is_seen() {
        assert_eq!(
            PinholeCamera::KINECT_V1.project(&Point3::new(0.1, 0.1, -1.0)),
            None
        );
        assert_eq!(PinholeCamera::KINECT_V1.project(&Point3::origin()), None);
    }

    #[test]
    fn pixel_is_the_nearest_one_inside_the_image() {
        let camera = PinholeCamera::KINECT_V1;
        let pixel_at = |column, row| camera.pixel_of(&camera.back_project(column, row, 0.8));
        assert_eq!(pixel_at(-0.4, 479.4), Some([0, 479]));
        assert_eq!(pixel_at(12.6, 7.3), Some([13, 7]));
        for (column, row) in [(-0.6, 9.0), (639.6, 9.0), (9.0, -0.6), (9.0, 479.6)] {
            assert_eq!(pixel_at(column, row), None);
        }
        assert_eq!(camera.pixel_of(&Point3::new(f64::NAN, 0.0, 1.0)), None);
        assert_eq!(camera.pixel_of(&Point3::new(0.0, 0.0, -1.0)), None);
    }

    #[test]
    fn impossible_intrinsics_are_refused_with_their_rule() {
        let good = PinholeCamera::KINECT_V1;
        assert!(good.validated().is_ok());
        for bad in [
            PinholeCamera {
                fx_px: f64::NAN,
                ..good
            },
            PinholeCamera {
                fy_px: -585.0,
                ..good
            },
            PinholeCamera {
                cx_px: f64::INFINITY,
                ..good
            },
            PinholeCamera { cy_px: 1e9, ..good },
            PinholeCamera { width: 0, ..good },
            PinholeCamera {
                height: 1 << 20,
                ..good
            },
        ] {
            let error = bad.validated().unwrap_err().to_string();
            assert!(error.contains("must lie"), "{error}");
        }
    }
}
