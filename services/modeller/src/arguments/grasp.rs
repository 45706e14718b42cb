//! Arguments of `tabula grasp plan`.

use super::number_between;
use clap::Args;
use control_client::TrackReference;
use grasping::GraspSettings;
use std::path::PathBuf;

/// Options of the planning of grasps.
#[derive(Debug, Clone, Args)]
pub(crate) struct GraspArguments {
    /// Object: its track-id, or words that mean exactly one, such as its label
    #[arg(value_name = "TRACK")]
    pub(crate) track: TrackReference,
    /// Cost of a way of the hand through space that nobody has seen, as a share of the score
    #[arg(long, value_name = "SHARE", default_value_t = GraspSettings::default().unseen_cost,
          value_parser = share)]
    pub(crate) unseen_cost: f64,
    /// Share of the hand's way that may be unseen; a grasp with more is rejected
    #[arg(long, value_name = "SHARE", default_value_t = GraspSettings::default().unseen_max,
          value_parser = share)]
    pub(crate) unseen_max: f64,
    /// PNG file for a picture of the best grasp; it is replaced
    #[arg(long, value_name = "FILE.png")]
    pub(crate) picture: Option<PathBuf>,
}

impl GraspArguments {
    /// Settings of the planning.
    pub(crate) fn settings(&self) -> GraspSettings {
        GraspSettings {
            unseen_cost: self.unseen_cost,
            unseen_max: self.unseen_max,
            ..GraspSettings::default()
        }
    }
}

fn share(text: &str) -> Result<f64, String> {
    number_between(text, 0.0, 1.0)
}
