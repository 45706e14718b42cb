//! Command-line arguments of the simulator.

use clap::{Args, Parser};
use service::ProcessArguments;

/// Plays a simulated table: a camera, an arm and a person that are not there.
#[derive(Debug, Clone, Parser)]
#[command(name = "tabula-simulator", version)]
pub(crate) struct SimulatorArguments {
    #[command(flatten)]
    pub(crate) process: ProcessArguments,

    #[command(flatten)]
    pub(crate) scene: SceneArguments,
}

/// Command-line choice of the scene; it overrides the configuration.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct SceneArguments {
    /// everyday, isolated, pile, bin, set-table, or a TOML scene file [default: everyday]
    #[arg(long, value_name = "SCENE")]
    pub(crate) scene: Option<String>,

    /// Number of objects [default: what the scene usually has]
    #[arg(long, value_name = "N")]
    pub(crate) objects: Option<usize>,

    /// Seed: the same scene, number and seed give the same world [default: 1]
    #[arg(long, value_name = "S")]
    pub(crate) seed: Option<u64>,

    /// Frames per second [default: 30]
    #[arg(long, value_name = "HZ")]
    pub(crate) rate: Option<f64>,

    /// Send a frame only when perception and memory have finished the one before
    #[arg(long)]
    pub(crate) lockstep: bool,
}
