//! Sources of the hypotheses from which the entropy of views is predicted.

use serde::Serialize;

/// Standard deviations of hypotheses that are made from the truth.
#[derive(Debug, Clone, Copy)]
pub(super) struct PoseNoise {
    /// Of the position along each axis, metres.
    pub(super) translation_m: f64,
    /// Of the rotation about each axis, degrees.
    pub(super) rotation_deg: f64,
}

coded_enum::coded_enum! {
    /// Source of the hypotheses of a prediction, from the best one on.
    #[derive(Serialize)]
    #[serde(rename_all = "kebab-case")]
    pub(super) enum PredictionSource {
        /// All objects at their exact poses.
        Truth, "truth";
        /// All objects with noisy poses.
        NoisyTruth, "noisy-truth";
        /// Models that recognition and registration lay on the segments of the current view, and
        /// the other segments as measured, as `tabula view plan` has them: no truth at all.
        Registered, "registered";
    }
}

impl PredictionSource {
    /// Noise of a source that knows the truth. That of noisy poses is chosen: errors of a pose
    /// estimate on the depth of a Kinect.
    pub(super) fn noise(self) -> Option<PoseNoise> {
        let [translation_m, rotation_deg] = match self {
            Self::Truth => [0.0, 0.0],
            Self::NoisyTruth => [0.005, 3.0],
            Self::Registered => return None,
        };
        Some(PoseNoise {
            translation_m,
            rotation_deg,
        })
    }
}
