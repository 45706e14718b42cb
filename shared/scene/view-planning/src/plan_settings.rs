//! Settings of a plan.

use next_best_view::{Config, ViewSelection};

/// Settings of a plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanSettings {
    /// Standard deviation of the weight by distance, as a share of the diameter of the candidates
    /// and the present pose; 0.01 to 1000.
    pub sigma_share: f64,
    /// Standard deviation of the penalty near visited views, as a share of the same diameter; 0 to
    /// 1000.
    pub visited_share: f64,
    /// Utility of seeing all unknown space, bit; 0 to 1000. 0 leaves unknown space out.
    pub gain_weight: f64,
    /// Rule of the choice.
    pub selection: ViewSelection,
    /// True to render virtual views as the camera would see them, not parallel to its axis.
    pub is_perspective: bool,
    /// True to segment virtual views like frames, which need the perspective for it, in place of
    /// taking the hypotheses apart by identity.
    pub is_segmented: bool,
}

impl Default for PlanSettings {
    /// The best view by the fitted weights, in parallel views.
    fn default() -> Self {
        let config = Config::default();
        Self {
            sigma_share: config.sigma_share,
            visited_share: config.visited_share,
            gain_weight: config.gain_weight,
            selection: ViewSelection::Greedy,
            is_perspective: false,
            is_segmented: false,
        }
    }
}
