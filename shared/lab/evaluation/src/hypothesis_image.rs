//! Label images of the segmentation hypotheses of a detection.

use constraint::Ternary;
use detection::Detection;

/// Hypothesis number of each point, before and after the constraints ψ.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct HypothesisImages {
    /// All hypotheses, numbered from 1 in detection order; 0 for no hypothesis.
    pub before_psi: Vec<u16>,
    /// Only hypotheses that satisfy the candidate rule ψ, with unchanged numbers.
    pub after_psi: Vec<u16>,
}

impl HypothesisImages {
    /// Label images of a cloud of `n_points`; `None` if the hypotheses cannot be numbered in 16
    /// bits.
    pub fn of(detection: &Detection, n_points: usize) -> Option<Self> {
        let mut images = Self {
            before_psi: vec![0; n_points],
            after_psi: vec![0; n_points],
        };
        for (i, candidate) in detection.candidates.iter().enumerate() {
            let number = u16::try_from(i + 1).ok()?;
            let passes = candidate.verdict == Ternary::True;
            for &point_idx in detection.points_of(candidate) {
                images.before_psi[point_idx as usize] = number;
                images.after_psi[point_idx as usize] = if passes { number } else { 0 };
            }
        }
        Some(images)
    }
}
