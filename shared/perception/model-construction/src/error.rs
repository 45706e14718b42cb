//! Errors of model construction.

use crate::pose_filter::PoseSigma;
use registration::{Prior, Registration, ViewSurface};

/// Error of adding a view to a model. The model is as it was before.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// No point of the view lies in the image of the camera.
    #[error(
        "none of the {n_points} points of the view lies in the image of its camera; check the \
         intrinsics, and that the points are in the frame of the camera"
    )]
    NoPoints {
        /// Points of the view.
        n_points: usize,
    },
    /// The view has no surface that could be registered.
    #[error(transparent)]
    Surface(registration::Error),
    /// A pose with a coordinate that is not finite.
    #[error("the camera pose of the view has a coordinate that is not a number; take another view")]
    PoseNotFinite,
    /// The view was registered, but does not fit to the model.
    #[error("the view does not fit to the model: {0}")]
    Misfit(Misfit),
}

/// Reason for which a registered view is refused.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Misfit {
    /// Too little of the view lies on the model.
    #[error("only {common_percent} % of it lies on the known surface; move on in smaller steps")]
    LittleOverlap {
        /// Share of the view's surface within 4 mm of the model.
        common_percent: u32,
    },
    /// Model and view exclude each other.
    #[error(
        "{percent} % of what they should see of each other is not there; keep the object still, \
         and nothing before it"
    )]
    Contradiction {
        /// Share of the contradicting surface, of both.
        percent: u32,
    },
    /// A turned object fits in no turn about the vertical.
    #[error(
        "after it was handled, it fits to the known surface in no turn; turn it in smaller steps, and \
         put it down as it stood"
    )]
    NoTurn,
    /// The registration is too far off the expected pose.
    #[error(
        "it lies {off_mm} mm and {off_deg}° off the expected pose, more than the pose is uncertain; \
         check the camera pose"
    )]
    FarFromPrior {
        /// Distance of the object's centre from the expected place, millimetres.
        off_mm: u32,
        /// Rotation from the expected one, degrees.
        off_deg: u32,
    },
}

impl Misfit {
    /// Misfit of a registration with too little common surface, or too great a contradiction.
    pub(crate) fn in_surface(
        found: &Registration,
        common_share_min: f64,
        contradiction_max: f64,
    ) -> Option<Self> {
        let percent = |share: f64| (100.0 * share).round() as u32;
        if found.common_share < common_share_min {
            return Some(Self::LittleOverlap {
                common_percent: percent(found.common_share),
            });
        }
        (found.contradiction > contradiction_max).then(|| Self::Contradiction {
            percent: percent(found.contradiction / 2.0),
        })
    }

    /// Misfit of a registration whose surface lies more standard deviations off its prior than it
    /// may.
    pub(crate) fn far_from(
        prior: &Prior,
        found: &Registration,
        view: &ViewSurface,
        sigmas_max: f64,
    ) -> Option<Self> {
        let centre = view.centroid();
        let own = PoseSigma::of_registration(view.noise_m());
        let (pose, expected) = (found.target_from_source, prior.target_from_source);
        let off_m = (pose * centre - expected * centre).norm();
        let off_rad = pose.rotation.angle_to(&expected.rotation);
        // Three axes have a norm of up to the root of three times their standard deviation.
        let is_far = off_m > sigmas_max * (prior.translation_sigma_m + own.translation_m)
            || off_rad > sigmas_max * (prior.rotation_sigma_rad + own.rotation_rad);
        is_far.then(|| Self::FarFromPrior {
            off_mm: (1e3 * off_m).round() as u32,
            off_deg: off_rad.to_degrees().round() as u32,
        })
    }
}
