//! Calibration of a Kinect v1: intrinsics, extrinsics and depth formula of its two cameras.

use crate::DepthFormula;
use crate::raw::{HEIGHT, WIDTH};
use geometry::{InvalidIntrinsics, PinholeCamera, RigidTransform};

/// Maximum accepted distance between the cameras, metres; in a Kinect it is 25 mm. Chosen.
const MAX_BASELINE_M: f64 = 0.2;
/// Maximum accepted rotation between the cameras, radians; in a Kinect it is one degree.
/// Chosen.
const MAX_ANGLE_RAD: f64 = 0.35;

/// Calibration of the depth and the colour camera.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// Intrinsics of the infrared camera, in whose frame the cloud is; projects points to the
    /// cloud's image grid.
    pub depth_camera: PinholeCamera,
    /// Intrinsics of the colour camera.
    pub color_camera: PinholeCamera,
    /// Transform from the depth camera's frame to the colour camera's.
    pub color_from_depth: RigidTransform,
    /// Conversion of raw depth to metres.
    pub formula: DepthFormula,
}

/// Error of a calibration that cannot be that of a Kinect.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum InvalidCalibration {
    /// Invalid intrinsics of a camera.
    #[error("the calibration's {which} camera is impossible: {source}")]
    Camera {
        /// Name of the camera: `depth` or `colour`.
        which: &'static str,
        /// Reason why the intrinsics are invalid.
        source: InvalidIntrinsics,
    },
    /// Calibration whose image size is not 640x480.
    #[error("the calibration's {which} camera must be 640x480, as the images are")]
    Size {
        /// Name of the camera: `depth` or `colour`.
        which: &'static str,
    },
    /// The cameras are too far apart or rotated too far, or the transform is not finite.
    #[error(
        "the calibration's transform from the depth to the colour camera must be within \
         {MAX_BASELINE_M} m and {MAX_ANGLE_RAD} rad; is it in millimetres or degrees?"
    )]
    Extrinsics,
}

impl Calibration {
    /// Nominal calibration of the Kinect v1, if the unit was not calibrated: the unit measured
    /// and published by Nicolas Burrus (*Kinect Calibration*, 2010), without its lens distortion
    /// (a few pixels in the corners).
    ///
    /// His four parts belong together (the cameras' tilt and their principal points were
    /// estimated jointly), so they are taken together. His rotation and translation lead from the
    /// colour camera to the depth camera: the colour camera sits some 20 mm to the right of the
    /// infrared one, seen from behind, so a point's x must become smaller on the way to colour.
    /// They are therefore inverted here.
    pub fn nominal() -> Self {
        let (width, height) = (WIDTH as u32, HEIGHT as u32);
        let depth_from_color =
            RigidTransform::new(BURRUS_TRANSLATION_M.into(), BURRUS_ROTATION_RAD.into());
        Self {
            depth_camera: PinholeCamera {
                fx_px: 594.214_342_119_232_5,
                fy_px: 591.040_536_968_707_8,
                cx_px: 339.307_809_753_003_14,
                cy_px: 242.739_137_617_516_15,
                width,
                height,
            },
            color_camera: PinholeCamera {
                fx_px: 529.215_080_982_932_9,
                fy_px: 525.563_936_300_574_4,
                cx_px: 328.942_720_287_592_6,
                cy_px: 267.480_681_718_715_6,
                width,
                height,
            },
            color_from_depth: depth_from_color.inverse(),
            formula: DepthFormula::default(),
        }
    }

    /// Checks that the calibration can be that of a Kinect.
    ///
    /// # Errors
    /// Names the invalid part. NaN fails.
    pub fn validated(self) -> Result<Self, InvalidCalibration> {
        for (which, camera) in [("depth", self.depth_camera), ("colour", self.color_camera)] {
            camera
                .validated()
                .map_err(|source| InvalidCalibration::Camera { which, source })?;
            if (camera.width as usize, camera.height as usize) != (WIDTH, HEIGHT) {
                return Err(InvalidCalibration::Size { which });
            }
        }
        let baseline_m = self.color_from_depth.translation.vector.norm();
        let angle_rad = self.color_from_depth.rotation.angle();
        // Written such that NaN fails.
        if !(baseline_m <= MAX_BASELINE_M && angle_rad <= MAX_ANGLE_RAD) {
            return Err(InvalidCalibration::Extrinsics);
        }
        Ok(self)
    }
}

/// Burrus's translation from colour to depth camera, metres.
const BURRUS_TRANSLATION_M: [f64; 3] = [
    1.998_524_231_209_255_3e-2,
    -7.442_373_876_161_758e-4,
    -1.091_673_633_433_622_2e-2,
];

/// Burrus's rotation, colour to depth, as axis times angle, radians.
const BURRUS_ROTATION_RAD: [f64; 3] = [
    1.226_429_663_497_151_6e-2,
    -1.748_016_105_454_079_6e-2,
    -1.370_827_363_077_351_2e-3,
];

#[cfg(test)]
mod tests {
    use super::*;

    /// Burrus's rotation matrix as printed, row by row.
    const BURRUS_ROTATION: [[f64; 3]; 3] = [
        [
            9.998_462_882_657_779e-1,
            1.263_535_909_840_958e-3,
            -1.748_723_300_443_664e-2,
        ],
        [
            -1.477_909_610_836_448e-3,
            9.999_238_568_354_29e-1,
            -1.225_138_010_767_953e-2,
        ],
        [
            1.747_042_141_246_493e-2,
            1.227_534_147_652_076e-2,
            9.997_720_241_971_695e-1,
        ],
    ];

    #[test]
    fn the_rotation_is_the_printed_one() {
        let rotation = Calibration::nominal()
            .color_from_depth
            .inverse()
            .rotation
            .to_rotation_matrix();
        for (row, printed) in BURRUS_ROTATION.iter().enumerate() {
            for (column, expected) in printed.iter().enumerate() {
                let value = rotation[(row, column)];
                assert!(
                    (value - expected).abs() < 1e-9,
                    "({row}, {column}): {value}"
                );
            }
        }
    }

    #[test]
    fn the_colour_camera_is_to_the_right_of_the_depth_camera() {
        let position = Calibration::nominal()
            .color_from_depth
            .inverse()
            .translation
            .vector;
        assert!(position.x > 0.015 && position.norm() < 0.03);
    }

    #[test]
    fn the_nominal_values_are_valid_and_wrong_ones_are_not() {
        let check = |change: fn(&mut Calibration), part: &str| {
            let mut calibration = Calibration::nominal();
            change(&mut calibration);
            let sentence = calibration.validated().unwrap_err().to_string();
            assert!(sentence.contains(part), "{sentence}");
        };
        assert!(Calibration::nominal().validated().is_ok());
        check(
            |c| c.depth_camera.fx_px = f64::NAN,
            "depth camera is impossible",
        );
        check(
            |c| c.color_camera.width = 320,
            "colour camera must be 640x480",
        );
        check(
            |c| c.color_from_depth.translation.vector.x = -20.0,
            "millimetres",
        );
        check(
            |c| c.color_from_depth.translation.vector.x = f64::NAN,
            "millimetres",
        );
        let turned = |c: &mut Calibration| {
            c.color_from_depth = RigidTransform::rotation([0.0, 1.5, 0.0].into());
        };
        check(turned, "degrees");
    }
}
