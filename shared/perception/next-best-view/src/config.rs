//! Settings of view planning.

use crate::error::Error;
use crate::view_entropy::TotalArea;
use crate::virtual_view::RenderConfig;
use value_range::check_range;

/// Settings of view planning.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Config {
    /// Settings of the virtual views.
    pub render: RenderConfig,
    /// Total area of the viewpoint entropy.
    pub total_area: TotalArea,
    /// Base of the entropy's logarithm; 1.1 to 100.
    pub log_base: f64,
    /// Standard deviation of the weight by distance as a share of the diameter of the candidates;
    /// 0.01 to 1000. A large one takes distance out of the choice.
    pub sigma_share: f64,
    /// Standard deviation of the penalty near visited views as a share of the same diameter; 0 to
    /// 1000. With 0 the views themselves are excluded, and nothing more.
    pub visited_share: f64,
    /// Weight of the information gain: utility of seeing all unknown space, in units of the
    /// entropy; 0 to 1000. It counts only when the occupancy of the space is given.
    pub gain_weight: f64,
}

impl Default for Config {
    /// Entropy in bit over all visible area. The deviations and the weight of the gain were fitted
    /// to closed loops in four bins (seed 1001) whose walls and true poses were known; the paper's
    /// rule has no penalty near visited views and no gain.
    fn default() -> Self {
        Self {
            render: RenderConfig::default(),
            total_area: TotalArea::Visible,
            log_base: 2.0,
            sigma_share: 0.5,
            visited_share: 0.1,
            gain_weight: 3.0,
        }
    }
}

impl Config {
    /// Checks the settings.
    pub(crate) fn check(&self) -> Result<(), Error> {
        self.render.check()?;
        check_range("log_base", self.log_base, 1.1, 100.0)?;
        check_range("sigma_share", self.sigma_share, 0.01, 1000.0)?;
        check_range("visited_share", self.visited_share, 0.0, 1000.0)?;
        Ok(check_range("gain_weight", self.gain_weight, 0.0, 1000.0)?)
    }
}
