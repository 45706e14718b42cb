//! Arguments of `evaluate transport`.

use clap::{Args, ValueHint};
use simulated_world::{ModelSource, SceneKind};
use std::path::PathBuf;

/// Arguments of the evaluation of transports.
#[derive(Debug, Args)]
pub struct TransportArguments {
    /// Kinds of scenes
    #[arg(
        long,
        value_name = "KIND,...",
        value_delimiter = ',',
        default_value = "isolated,set-table,clutter"
    )]
    pub(crate) kinds: Vec<SceneKind>,
    /// Folder of PLY, OBJ, STL and DAE models, or `generated`
    #[arg(long, value_name = "DIR", default_value = "generated", value_hint = ValueHint::DirPath)]
    pub(crate) models: ModelSource,
    /// Number of objects carried in each scene at most, those nearest to the arm
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u16).range(1..=60))]
    pub(crate) objects: u16,
    /// Seed of the first scene of each kind
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Number of scenes of each kind
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(crate) seeds: u32,
    /// Stand the arm at the far right corner of the table, opposite to the camera
    #[arg(long)]
    pub(crate) arm_opposite: bool,
    /// Folder for the figures and the page
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
}
