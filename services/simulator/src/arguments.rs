//! Command-line arguments of the simulator.

use capture::Follower;
use clap::{Args, Parser};
use service::ProcessArguments;

/// Simulates a table with objects, a camera, an arm and a person.
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
    /// everyday, isolated, pile, bin, set-table, clutter, shelf, tray, or a TOML scene file [default: everyday]
    #[arg(long, value_name = "SCENE")]
    pub(crate) scene: Option<String>,

    /// Number of objects [default: the usual number of the scene]
    #[arg(long, value_name = "N")]
    pub(crate) objects: Option<usize>,

    /// Random seed; the same scene, number and seed give the same world [default: 1]
    #[arg(long, value_name = "S")]
    pub(crate) seed: Option<u64>,

    /// Frames per second [default: 30]
    #[arg(long, value_name = "HZ")]
    pub(crate) rate: Option<f64>,

    /// Send a frame only when perception and memory have finished the previous one
    #[arg(long)]
    pub(crate) lockstep: bool,

    /// In lockstep, also wait for the reports of another follower: executive or observer
    #[arg(long, hide = true, value_name = "FOLLOWER")]
    pub(crate) lockstep_with: Vec<Follower>,
}
