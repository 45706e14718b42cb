//! What can be wrong with labelled scenes.

use dataset::{recording_kind, rgbd_sequence, scene_folder};
use std::fmt;
use std::path::PathBuf;

/// Why labelled scenes, or one of them, can not be used.
#[derive(Debug)]
#[non_exhaustive]
pub enum Error {
    /// The folder holds neither scenes nor folders with scenes.
    Kind(recording_kind::Error),
    /// The folder or the folders in it could not be listed.
    List {
        /// The folder.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The folder is a fakenect recording, which has no truth.
    NoTruth(PathBuf),
    /// Two scenes would have the same name.
    SameName(String),
    /// A folder of PCD files, or one of them, could not be read.
    Folder(scene_folder::Error),
    /// A PCD file is no cloud that can be read.
    Pcd(dataset::pcd::Error),
    /// A sequence or one of its frames could not be read.
    Sequence(rgbd_sequence::Error),
    /// A PCD file has no labels.
    NoLabels,
    /// A frame has no mask.
    NoMask,
    /// A label does not fit into 16 bits.
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
