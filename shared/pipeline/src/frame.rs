//! When and from where a frame was seen, and what it says of a candidate.

use crate::{Config, Error};
use detection::Candidate;
use geometry::RigidTransform;
use nalgebra::Point3;
use tracking::{Appearance, Measurement, Observed};

/// The circumstances of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Capture stamp, nanoseconds.
    pub capture_ns: u64,
    /// Pose of the camera; the identity when it is not known.
    pub world_from_camera: RigidTransform,
}

/// What a frame says of one candidate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// The box in the world and its stamp.
    pub measurement: Measurement,
    /// Centre of the box in the camera's frame.
    pub centre_in_camera: Point3<f64>,
    /// Pose of the camera.
    pub world_from_camera: RigidTransform,
    /// Coarse looks.
    pub appearance: Appearance,
    /// Mean red, green, blue; 0 to 255.
    pub mean_rgb: [f32; 3],
    /// Number of points.
    pub n_points: usize,
    /// Whether the border of the image cuts the object.
    pub is_cut_by_image: bool,
    /// Whether a part of it may be missing: the border of the image cuts it, or a
    /// person or the robot touches it.
    pub is_cut: bool,
}

impl Measured {
    /// The measurement of a candidate.
    ///
    /// # Errors
    /// When the candidate's box is no possible measurement.
    pub fn of(candidate: &Candidate, frame: &Frame) -> Result<Self, Error> {
        let box_in_world = candidate.oriented_box.transformed(&frame.world_from_camera);
        let is_cut_by_image = candidate.touches_image_border;
        let is_cut = is_cut_by_image || candidate.is_touched();
        let depth_m = candidate.centroid.z;
        let measurement = Measurement::new(frame.capture_ns, box_in_world, depth_m, is_cut)
            .map_err(Error::Tracking)?;
        Ok(Self {
            measurement,
            centre_in_camera: candidate.oriented_box.centre(),
            world_from_camera: frame.world_from_camera,
            appearance: Appearance {
                volume_m3: box_in_world.volume_m3(),
                mean_rgb: candidate.mean_rgb,
                is_cut,
            },
            mean_rgb: candidate.mean_rgb,
            n_points: candidate.n_points(),
            is_cut_by_image,
            is_cut,
        })
    }

    pub(crate) fn observed(
        &self,
        candidate: &Candidate,
        frame: &Frame,
        config: &Config,
    ) -> Observed {
        Observed {
            position: frame.world_from_camera * candidate.oriented_box.centre(),
            position_variance_m2: self.measurement.position_variance_m2(config.motion()),
            appearance: self.appearance,
        }
    }
}
