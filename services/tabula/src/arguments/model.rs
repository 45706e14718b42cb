//! Arguments of `tabula model`.

use super::LabArguments;
use clap::Subcommand;
use std::path::PathBuf;

/// Subcommands of `tabula model`.
#[derive(Debug, Subcommand)]
pub(crate) enum ModelVerb {
    /// Build the model of a tracked object while the camera moves around it; see
    /// `tabula model build --help`
    #[command(disable_help_flag = true)]
    Build(LabArguments),
    /// List the stored models
    List,
    /// Show the size, views, missing parts and versions of a model
    Show {
        /// Name of the model
        name: String,
    },
    /// Write the surface of a model to a PLY file with vertex colours
    Export {
        /// Name of the model
        name: String,
        /// File to write; an existing file is replaced when the new one is complete
        /// [default: the model's name with .ply]
        #[arg(long, value_name = "FILE.ply")]
        out: Option<PathBuf>,
    },
    /// Forget a model; `tabula undo` restores it
    Forget {
        /// Name of the model
        name: String,
        /// Author of the change [default: the user's name]
        #[arg(long, value_name = "NAME")]
        author: Option<String>,
    },
}
