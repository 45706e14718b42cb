//! Errors of model construction.

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
