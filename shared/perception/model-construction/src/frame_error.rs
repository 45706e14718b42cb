//! Error of the object's frame: what the reported poses of all views have in common.

use crate::pose_filter::PoseSigma;
use nalgebra::{Isometry3, Point3};
use registration::twist::{Twist, exponential, twist_at};

/// Mean difference between the registered and the reported poses, about the origin of the object.
///
/// The first view makes the frame of the object, with the error of its pose; all later reports
/// are off by this error. The mean over the views tells it.
#[derive(Debug, Clone)]
pub(crate) struct FrameError {
    sum: Twist,
    n_views: u32,
}

impl FrameError {
    /// Error after the first view, whose pose is taken as it is.
    pub(crate) fn new() -> Self {
        Self {
            sum: Twist::zeros(),
            n_views: 1,
        }
    }

    /// Adds a view with its registered and its reported pose.
    pub(crate) fn add(&mut self, registered: &Isometry3<f64>, reported: &Isometry3<f64>) {
        self.sum += twist_at(&(registered * reported.inverse()), &Point3::origin());
        self.n_views += 1;
    }

    /// Reported pose in the frame that the views have in common, with its uncertainty there.
    pub(crate) fn corrected(
        &self,
        reported: &Isometry3<f64>,
        sigma: &PoseSigma,
    ) -> (Isometry3<f64>, PoseSigma) {
        let n_views = f64::from(self.n_views);
        let wider = (1.0 + 1.0 / n_views).sqrt();
        let sigma = PoseSigma {
            rotation_rad: wider * sigma.rotation_rad,
            translation_m: wider * sigma.translation_m,
        };
        (exponential(&(self.sum / n_views)) * reported, sigma)
    }
}
