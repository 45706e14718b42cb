//! Command-line arguments common to all processes and tools.

use crate::{GivenOptions, Home};
use channel::DomainName;
use clap::Args;
use std::path::PathBuf;

/// Selection of a daemon and its configuration.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Common options")]
pub struct CommonArguments {
    /// Options that stand on the command line. The first field: clap takes the others out.
    #[command(flatten)]
    pub given: GivenOptions,

    /// Domain name of the daemon; daemons in different domains are independent
    #[arg(
        long,
        env = "TABULA_DOMAIN",
        default_value = "default",
        value_name = "NAME",
        global = true
    )]
    pub domain: DomainName,

    /// Folder of the daemon's data [default: the user's data folder, by domain]
    #[arg(long, env = "TABULA_HOME", value_name = "DIR", global = true)]
    pub home: Option<PathBuf>,

    /// Configuration file, with drop-ins in FILE.d [default: tabula.toml in the home folder, /etc/tabula/tabula.toml]
    #[arg(long, value_name = "FILE", global = true)]
    pub config: Option<PathBuf>,
}

/// Command-line arguments of one process of the daemon.
#[derive(Debug, Clone, Args)]
pub struct ProcessArguments {
    /// Options that select the daemon and its configuration.
    #[command(flatten)]
    pub common: CommonArguments,

    /// Check the configuration and the arguments, and do nothing else
    #[arg(long)]
    pub check_config: bool,

    /// Stop when the parent process with this id ends
    #[arg(long, value_name = "PID")]
    pub follow_parent: Option<u32>,
}

impl CommonArguments {
    /// Data folder that these arguments select.
    pub fn home(&self) -> Home {
        match &self.home {
            Some(folder) => Home::at(folder.clone()),
            None => Home::default_for(&self.domain),
        }
    }
}
