//! Arguments of `tabula view plan`.

use super::number_between;
use clap::Args;
use next_best_view::ViewSelection;
use std::path::PathBuf;
use view_planning::PlanSettings;

/// Options of the plan of the next best view.
#[derive(Debug, Clone, Args)]
pub(crate) struct PlanArguments {
    /// Number of candidate views, spread evenly above the objects
    #[arg(long, value_name = "N", default_value_t = 100,
          value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub(crate) candidates: u16,
    /// Distance of the candidates from the middle of the objects, metres [default: that of the
    /// camera]
    #[arg(long, value_name = "M", value_parser = distance)]
    pub(crate) distance_m: Option<f64>,
    /// Least angle at which a candidate looks down, degrees
    #[arg(long, value_name = "DEG", default_value_t = 20.0, value_parser = elevation)]
    pub(crate) min_elevation_deg: f64,
    /// Candidates in place of these: JSON list of the camera poses that the robot can reach
    #[arg(long, value_name = "FILE",
          conflicts_with_all = ["candidates", "distance_m", "min_elevation_deg"])]
    pub(crate) views: Option<PathBuf>,
    /// Views that were taken already: JSON list of camera poses; the present one always is
    #[arg(long, value_name = "FILE")]
    pub(crate) visited: Option<PathBuf>,
    /// Draw the view, with probabilities proportional to its utility to the power of BETA
    #[arg(long, value_name = "BETA", num_args = 0..=1, default_missing_value = "1",
          value_parser = beta)]
    pub(crate) sampled: Option<f64>,
    /// Seed of the draw
    #[arg(long, value_name = "S", default_value_t = 1, requires = "sampled")]
    pub(crate) seed: u64,
    /// Standard deviation of the weight by distance, as a share of the diameter of the candidates
    /// and the present pose; a large one takes distance out of the choice
    #[arg(long, value_name = "SHARE", default_value_t = PlanSettings::default().sigma_share,
          value_parser = sigma_share)]
    pub(crate) sigma_share: f64,
    /// Utility of seeing all unknown space, bit; 0 leaves unknown space out
    #[arg(long, value_name = "BIT", default_value_t = PlanSettings::default().gain_weight,
          value_parser = gain_weight)]
    pub(crate) gain_weight: f64,
    /// Render virtual views as the camera would see them, in place of parallel to its axis
    #[arg(long)]
    pub(crate) perspective: bool,
    /// Segment virtual views like frames, in place of taking the hypotheses apart by identity
    #[arg(long)]
    pub(crate) by_segmentation: bool,
    /// PNG file for a picture of the present view and of the chosen one; it is replaced
    #[arg(long, value_name = "FILE.png")]
    pub(crate) picture: Option<PathBuf>,
    /// Plan anew when the camera has moved and stands still, or the objects have changed, until
    /// Ctrl-C
    #[arg(long)]
    pub(crate) watch: bool,
}

impl PlanArguments {
    /// Settings of the plan.
    pub(crate) fn settings(&self) -> PlanSettings {
        let sampled = self.sampled.map(|beta| ViewSelection::Sampled { beta });
        PlanSettings {
            sigma_share: self.sigma_share,
            gain_weight: self.gain_weight,
            selection: sampled.unwrap_or(ViewSelection::Greedy),
            is_perspective: self.perspective,
            is_segmented: self.by_segmentation,
            ..PlanSettings::default()
        }
    }
}

fn distance(text: &str) -> Result<f64, String> {
    number_between(text, 0.1, 10.0)
}

fn elevation(text: &str) -> Result<f64, String> {
    number_between(text, 0.0, 89.0)
}

fn beta(text: &str) -> Result<f64, String> {
    number_between(text, 0.0, 100.0)
}

fn sigma_share(text: &str) -> Result<f64, String> {
    number_between(text, 0.01, 1000.0)
}

fn gain_weight(text: &str) -> Result<f64, String> {
    number_between(text, 0.0, 1000.0)
}
