//! Arguments of the demonstrations.

use clap::{Args, Subcommand, ValueEnum, ValueHint};
use serde::{Deserialize, Serialize};
use simulated_world::ModelSource;
use std::path::PathBuf;

/// Subcommands of `tabula-lab demo`.
#[derive(Debug, Subcommand)]
pub enum DemoVerb {
    /// A person teaches the objects on a table one by one, and the robot clears it
    ClearTable(DemoArguments),
    /// A person teaches the objects on a table one by one, and asks the robot for one of them
    Fetch(DemoArguments),
}

/// Variant of a demonstration: its objects and its standard item.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DemoVariant {
    /// Vase as the standard item, and bottles, cans and mugs
    First,
    /// Goblet as the standard item, and fruit, packets and teacups
    Second,
}

/// Arguments of a demonstration at a table.
#[derive(Debug, Args)]
pub struct DemoArguments {
    /// Folder of PLY, OBJ, STL and DAE models, or `generated`; of a folder the first model drawn is
    /// the standard item
    #[arg(long, value_name = "DIR", default_value = "generated", value_hint = ValueHint::DirPath)]
    pub(crate) models: ModelSource,
    /// Objects and standard item of the generated models
    #[arg(long, value_name = "VARIANT", value_enum, default_value = "first")]
    pub(crate) variant: DemoVariant,
    /// Seed of the first table
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Number of tables
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(crate) seeds: u32,
    /// Number of objects with the standard item [default: 5 to 8, by the seed]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=8))]
    pub(crate) objects: Option<u32>,
    /// Print what happens at each table while it runs
    #[arg(long)]
    pub(crate) live: bool,
    /// Folder for the figures and the page; tables that it holds already are not played again
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
}
