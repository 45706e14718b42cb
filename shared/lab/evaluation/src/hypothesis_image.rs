//! The hypotheses of a detection as images of numbers.

use constraint::Truth;
use detection::Detection;

/// The number of each point's hypothesis, before ψ and after it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct HypothesisImages {
    /// All hypotheses, numbered from 1 as detection lists them; 0 is none.
    pub before_psi: Vec<u16>,
    /// Only those that pass, with the same numbers.
    pub after_psi: Vec<u16>,
}

impl HypothesisImages {
    /// Of a cloud of `n_points`; `None` when there are more hypotheses than
    /// 16 bits can number.
    pub fn of(detection: &Detection, n_points: usize) -> Option<Self> {
        let mut images = Self {
            before_psi: vec![0; n_points],
            after_psi: vec![0; n_points],
        };
        for (i, candidate) in detection.candidates.iter().enumerate() {
            let number = u16::try_from(i + 1).ok()?;
            let passes = candidate.verdict == Truth::True;
            for &point_idx in detection.points_of(candidate) {
                images.before_psi[point_idx as usize] = number;
                images.after_psi[point_idx as usize] = if passes { number } else { 0 };
            }
        }
        Some(images)
    }
}
