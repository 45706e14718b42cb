//! The command line.

use clap::{Args, Parser, Subcommand};
use service::CommonArguments;

/// The perception daemon of a service robot: finds the objects on a table,
/// follows them, and learns their names from people.
#[derive(Debug, Parser)]
#[command(name = "tabula", version, propagate_version = true)]
pub(crate) struct Arguments {
    #[command(flatten)]
    pub(crate) common: CommonArguments,

    /// Print one JSON document instead of text
    #[arg(long, global = true)]
    pub(crate) json: bool,

    #[command(subcommand)]
    pub(crate) verb: Verb,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Verb {
    /// Start the daemon and keep it running until Ctrl-C
    Run(RunArguments),
    /// Show the tracked objects
    Objects {
        /// Show them again and again until Ctrl-C
        #[arg(long)]
        watch: bool,
    },
    /// Ask what a tracked object is
    Ask {
        /// The track
        track_id: u64,
    },
    /// Teach the name of a tracked object
    Teach(LabelArguments),
    /// Correct the name of a tracked object
    Correct(LabelArguments),
    /// Forget a category; its views stay, without a name
    Forget {
        /// The category
        category: String,
        /// Who asks [default: the user's name]
        #[arg(long, value_name = "NAME")]
        author: Option<String>,
    },
    /// List the learned categories
    Categories,
    /// Show how the daemon's processes are
    Status,
    /// Check this machine and explain what is wrong
    Doctor,
}

/// A name for a track.
#[derive(Debug, Args)]
pub(crate) struct LabelArguments {
    /// The track
    pub(crate) track_id: u64,
    /// The name
    pub(crate) category: String,
    /// Who teaches [default: the user's name]
    #[arg(long, value_name = "NAME")]
    pub(crate) author: Option<String>,
}

/// Which camera, and how a recording is played; handed to tabula-camera, which
/// checks them.
#[derive(Debug, Args)]
pub(crate) struct RunArguments {
    /// synthetic[:N], kinect, fakenect:FOLDER, or a folder of PCD scenes or of an RGB-D sequence
    #[arg(long, value_name = "SOURCE")]
    source: Option<String>,
    /// Frames per second of a recording or the synthetic table [default: 30]
    #[arg(long, value_name = "HZ", allow_hyphen_values = true)]
    rate: Option<String>,
    /// Begin again when the recording ends
    #[arg(long = "loop")]
    looped: bool,
    /// First frame of the recording, in natural name order, counted from 0
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    from: Option<String>,
    /// Frame before which the recording ends
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    to: Option<String>,
    /// Send a frame only when perception and memory have finished the one before
    #[arg(long)]
    lockstep: bool,
    /// Check the configuration and the arguments of all processes, and do nothing else
    #[arg(long)]
    pub(crate) check_config: bool,
}

impl RunArguments {
    /// As arguments of tabula-camera.
    pub(crate) fn for_camera(&self) -> Vec<String> {
        let values = [
            ("--source", &self.source),
            ("--rate", &self.rate),
            ("--from", &self.from),
            ("--to", &self.to),
        ];
        let flags = [("--loop", self.looped), ("--lockstep", self.lockstep)];
        let values = values
            .into_iter()
            .filter_map(|(name, value)| Some(format!("{name}={}", value.as_ref()?)));
        let flags = flags
            .into_iter()
            .filter(|(_, is_set)| *is_set)
            .map(|(name, _)| name.into());
        values.chain(flags).collect()
    }
}
