//! Errors of scenes and object models.

use std::path::{Path, PathBuf};

/// Error of an invalid scene, model or file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// File that cannot be read.
    #[error("{} cannot be read: {cause}", path.display())]
    Unreadable {
        /// Path of the unreadable file.
        path: PathBuf,
        /// Reason why the file cannot be read.
        cause: String,
    },
    /// Invalid value in a scene.
    #[error("the scene's {place}: {rule}")]
    Scene {
        /// Key of the value in the scene file: `[table] size_m`.
        place: String,
        /// Rule that the value violates.
        rule: String,
    },
    /// Model that cannot be used.
    #[error("the model {name} cannot be used: {cause}")]
    Model {
        /// File or name of the model.
        name: String,
        /// Reason why the model cannot be used.
        cause: String,
    },
    /// Unknown category of generated objects.
    #[error(
        "there is no generated category `{category}`; \
         `tabula simulate categories` lists those there are"
    )]
    UnknownCategory {
        /// Requested category of generated objects.
        category: String,
    },
    /// Scene whose objects do not all fit onto the table.
    #[error(
        "only {n_placed} of {n_objects} objects find a place apart from each other; \
         ask for fewer, for a larger table, or for a pile"
    )]
    NoRoom {
        /// Number of requested objects.
        n_objects: usize,
        /// Number of placed objects.
        n_placed: usize,
    },
}

impl Error {
    /// Error of a file or folder that cannot be read.
    pub(crate) fn unreadable(path: &Path, cause: &impl ToString) -> Self {
        Self::Unreadable {
            path: path.to_owned(),
            cause: cause.to_string(),
        }
    }

    /// Error of a camera that the renderer refuses.
    pub(crate) fn camera(cause: &rendering::Error) -> Self {
        Self::Scene {
            place: "camera".into(),
            rule: cause.to_string(),
        }
    }
}
