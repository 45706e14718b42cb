//! Command-line arguments of the camera.

use crate::source::SourceSpec;
use capture::Follower;
use clap::{Args, Parser};
use service::ProcessArguments;

/// Publishes the clouds of one camera into the daemon's shared memory.
#[derive(Debug, Clone, Parser)]
#[command(name = "tabula-camera", version)]
pub struct CameraArguments {
    /// Options that every process accepts.
    #[command(flatten)]
    pub process: ProcessArguments,

    /// Source and playback options.
    #[command(flatten)]
    pub(crate) source: SourceArguments,
}

/// Command-line choice of the source and its playback; it overrides the configuration.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct SourceArguments {
    /// synthetic[:N], crowd:N, parade:N, kinect, fakenect:FOLDER, a recording FILE.mcap, or a folder of PCD scenes, an RGB-D sequence, or colour and depth images
    #[arg(long, value_name = "SOURCE")]
    pub(crate) source: Option<SourceSpec>,

    /// Frames per second of a recording or the synthetic table [default: 30]
    #[arg(long, value_name = "HZ")]
    pub(crate) rate: Option<f64>,

    /// Start the recording again when it ends
    #[arg(long = "loop")]
    pub(crate) looped: bool,

    /// First frame of the recording, in natural name order, counted from 0
    #[arg(long, value_name = "N")]
    pub(crate) from: Option<usize>,

    /// Frame number before which the recording ends
    #[arg(long, value_name = "M")]
    pub(crate) to: Option<usize>,

    /// Send a frame only when perception and memory have finished the previous one
    #[arg(long)]
    pub(crate) lockstep: bool,

    /// In lockstep, also wait for the reports of another follower: executive or observer
    #[arg(long, hide = true, requires = "lockstep", value_name = "FOLLOWER")]
    pub(crate) lockstep_with: Vec<Follower>,
}

impl SourceArguments {
    /// True if an option is given that overrides a key of the configuration.
    pub(crate) fn has(&self, key: &str) -> bool {
        match key {
            "source" => self.source.is_some(),
            "rate_hz" => self.rate.is_some(),
            "loop" => self.looped,
            "from_frame" => self.from.is_some(),
            "to_frame" => self.to.is_some(),
            "lockstep" => self.lockstep,
            _ => false,
        }
    }
}
