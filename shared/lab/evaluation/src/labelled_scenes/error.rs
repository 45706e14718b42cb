//! Errors of labelled scenes.

use dataset::{recording_kind, rgbd_sequence, scene_folder};
use std::fmt;
use std::path::PathBuf;

/// Error of opening or reading labelled scenes.
#[derive(Debug)]
#[non_exhaustive]
pub enum Error {
    /// The folder contains neither scenes nor folders of scenes.
    Kind(recording_kind::Error),
    /// A folder could not be listed.
    List {
        /// Path of the folder.
        path: PathBuf,
        /// Cause reported by the operating system.
        source: std::io::Error,
    },
    /// The folder is a fakenect recording, which has no ground truth.
    NoTruth(PathBuf),
    /// Two scenes would have the same name.
    SameName(String),
    /// A folder of PCD files, or a file in it, could not be read.
    Folder(scene_folder::Error),
    /// A PCD file is malformed.
    Pcd(dataset::pcd::Error),
    /// A sequence or one of its frames could not be read.
    Sequence(rgbd_sequence::Error),
    /// The PCD file has no labels.
    NoLabels,
    /// The frame has no instance mask.
    NoMask,
    /// The label does not fit into 16 bits.
    Label(u32),
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Kind(error) => error.fmt(f),
            Self::List { path, source } => {
                write!(f, "could not list {}: {source}", path.display())
            }
            Self::NoTruth(path) => write!(
                f,
                "{} is a fakenect recording, of which no truth is known; name labelled PCD scenes \
                 or a simulated sequence",
                path.display()
            ),
            Self::SameName(name) => write!(
                f,
                "two scenes are called {name}, and their results would overwrite each other; \
                 rename a folder"
            ),
            Self::Folder(error) => error.fmt(f),
            Self::Pcd(error) => error.fmt(f),
            Self::Sequence(error) => error.fmt(f),
            Self::NoLabels => f.write_str("the PCD file has no field `label`; add the truth to it"),
            Self::NoMask => f.write_str(
                "the frame has no mask; `tabula simulate scene` writes sequences with masks",
            ),
            Self::Label(label) => {
                write!(
                    f,
                    "the label {label} does not fit into 16 bits; number the objects anew"
                )
            }
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Kind(error) => Some(error),
            Self::List { source, .. } => Some(source),
            Self::Folder(error) => Some(error),
            Self::Pcd(error) => Some(error),
            Self::Sequence(error) => Some(error),
            _ => None,
        }
    }
}

impl From<recording_kind::Error> for Error {
    fn from(error: recording_kind::Error) -> Self {
        Self::Kind(error)
    }
}

impl From<scene_folder::Error> for Error {
    fn from(error: scene_folder::Error) -> Self {
        Self::Folder(error)
    }
}

impl From<dataset::pcd::Error> for Error {
    fn from(error: dataset::pcd::Error) -> Self {
        Self::Pcd(error)
    }
}

impl From<rgbd_sequence::Error> for Error {
    fn from(error: rgbd_sequence::Error) -> Self {
        Self::Sequence(error)
    }
}
