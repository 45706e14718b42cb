//! Arguments of `evaluate grasping`.

use clap::{Args, ValueEnum, ValueHint};
use simulated_world::ModelSource;
use std::path::PathBuf;

/// Half of the model files, by the number at the beginning of their names.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ModelHalf {
    /// Odd numbers: those that the planner was fitted on
    Odd,
    /// Even numbers: those that were held out
    Even,
    /// Both
    All,
}

/// Judge of a grasp.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum GraspJudge {
    /// The simulated arm of this project
    Ours,
    /// MuJoCo, and the simulated arm beside it; needs Python and the project's sources
    Mujoco,
}

/// Arguments of the evaluation of grasps.
#[derive(Debug, Args)]
pub struct GraspingArguments {
    /// Folder of PLY, OBJ, STL and DAE models, or `generated`
    #[arg(long, value_name = "DIR", default_value = "generated", value_hint = ValueHint::DirPath)]
    pub(crate) models: ModelSource,
    /// Half of the model files, by the number at the beginning of their names
    #[arg(long, value_enum, default_value_t = ModelHalf::All)]
    pub(crate) half: ModelHalf,
    /// Number of objects, spread over the models [default: all]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub(crate) objects: Option<u32>,
    /// Seed of poses and noise
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Number of seeds: trials of each object
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(crate) seeds: u32,
    /// Judge of the grasps
    #[arg(long, value_enum, default_value_t = GraspJudge::Ours)]
    pub(crate) judge: GraspJudge,
    /// Folder for the figures and the page
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
}
