//! Errors of labelled scenes.

use dataset::RecordingKind;
use std::path::PathBuf;

/// Error of opening or reading labelled scenes.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Folder without recordings, or recording, or file in it, that could not be read.
    #[error("{0}")]
    Recording(#[from] dataset::Error),
    /// Folder with a recording of a kind that has no ground truth.
    #[error(
        "the folder {} holds {kind}, of which no truth is known; name labelled PCD scenes or a \
         simulated sequence",
        .path.display()
    )]
    NoTruth {
        /// Folder of the recording.
        path: PathBuf,
        /// Kind of the recording.
        kind: RecordingKind,
    },
    /// Two scenes with the same name.
    #[error(
        "two scenes are called {0}, and their results would overwrite each other; rename a folder"
    )]
    SameName(String),
    /// Malformed PCD file.
    #[error("{0}")]
    Pcd(#[from] dataset::pcd::Error),
    /// PCD file without labels.
    #[error("the PCD file has no field `label`; add the truth to it")]
    NoLabels,
    /// Frame without instance mask.
    #[error("the frame has no mask; `tabula simulate scene` writes sequences with masks")]
    NoMask,
    /// Label that does not fit into 16 bits.
    #[error("the label {0} does not fit into 16 bits; renumber the objects")]
    Label(u32),
}
