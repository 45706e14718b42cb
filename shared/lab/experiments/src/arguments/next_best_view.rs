//! Arguments of the evaluation of the next best view.

use super::within;
use clap::{Args, ValueHint};
use simulated_world::ModelSource;
use std::path::PathBuf;

/// Options of the simulated scenes, which a BOP scene does not have.
const SIMULATED: [&str; 9] = [
    "scenes",
    "views",
    "starts",
    "models",
    "sigma_share",
    "visited_share",
    "gain_weight",
    "twin_scenes",
    "twin_views",
];

/// Arguments of `evaluate next-best-view`.
#[derive(Debug, Args)]
pub struct NextBestViewArguments {
    /// Number of scenes
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(crate) scenes: u32,
    /// Views of each scene, evenly over the upper hemisphere
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(2..=1000))]
    pub(crate) views: u32,
    /// First views of the closed loops of each method
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=100))]
    pub(crate) starts: u32,
    /// Folder of models of objects, or `generated`
    #[arg(long, value_name = "DIR", default_value = "generated", value_hint = ValueHint::DirPath)]
    pub(crate) models: ModelSource,
    /// Deviation of the weight by distance, in diameters of the candidates
    #[arg(long, value_name = "SHARE", default_value_t = 0.5, value_parser = within(0.01..=1000.0))]
    pub(crate) sigma_share: f64,
    /// Deviation of the penalty near visited views, in diameters of the candidates; 0 excludes
    /// the views only
    #[arg(long, value_name = "SHARE", default_value_t = 0.1, value_parser = within(0.0..=1000.0))]
    pub(crate) visited_share: f64,
    /// Weight of the information gain against the entropy
    #[arg(long, value_name = "W", default_value_t = 3.0, value_parser = within(0.0..=1000.0))]
    pub(crate) gain_weight: f64,
    /// Scenes of each kind of the paper's statistic: 15 coffee cups, 5 juice boxes; 0 leaves it out
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(0..=100))]
    pub(crate) twin_scenes: u32,
    /// Views of each of these scenes
    #[arg(long, value_name = "N", default_value_t = 59, value_parser = clap::value_parser!(u32).range(2..=1000))]
    pub(crate) twin_views: u32,
    /// Folder of a scene in the BOP format, for the paper's statistic on it and nothing else
    #[arg(long, value_name = "DIR", requires = "bop_models", conflicts_with_all = SIMULATED)]
    pub(crate) bop: Option<PathBuf>,
    /// Folder of the models of the BOP scene
    #[arg(long, value_name = "DIR", requires = "bop")]
    pub(crate) bop_models: Option<PathBuf>,
    /// Other heaps of the same objects, of 24 views each, in which their names are taught
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=100))]
    pub(crate) lesson_heaps: u32,
    /// Random seed; the same seed gives the same figures
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Folder for the figures, the page and the pictures
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
}
