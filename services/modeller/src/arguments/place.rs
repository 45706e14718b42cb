//! Arguments of `tabula place plan`.

use clap::Args;
use control_client::TrackReference;
use std::path::PathBuf;

/// Options of the planning of a transport.
#[derive(Debug, Clone, Args)]
pub(crate) struct PlaceArguments {
    /// Object: its track-id, or words that mean exactly one, such as its label
    #[arg(value_name = "TRACK")]
    pub(crate) track: TrackReference,
    /// Place of the configuration [default: that of the object's category, or `unknown`]
    #[arg(long, value_name = "NAME")]
    pub(crate) at: Option<String>,
    /// PNG file for a picture of the grasp; it is replaced
    #[arg(long, value_name = "FILE.png")]
    pub(crate) picture: Option<PathBuf>,
}
