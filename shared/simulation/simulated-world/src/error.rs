//! What can be wrong with a scene or a model.

use std::path::PathBuf;

/// Why a simulated table can not be set up.
#[derive(Debug)]
#[non_exhaustive]
pub enum Error {
    /// A file can not be read.
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why.
        cause: String,
    },
    /// A scene file says something that can not be.
    Scene {
        /// Where in the scene: `[table] size_m`.
        place: String,
        /// The rule it breaks.
        rule: String,
    },
    /// A model can not be used.
    Model {
        /// The model's file or name.
        name: String,
        /// Why.
        cause: String,
    },
    /// There is no such category of generated objects.
    UnknownCategory {
        /// What was asked for.
        category: String,
    },
    /// Not all objects find a place.
    NoRoom {
        /// How many were asked for.
        n_objects: usize,
        /// How many found a place.
        n_placed: usize,
    },
}

impl std::fmt::Display for Error {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Unreadable { path, cause } => {
                write!(f, "{} can not be read: {cause}", path.display())
            }
            Self::Scene { place, rule } => write!(f, "the scene's {place}: {rule}"),
            Self::Model { name, cause } => write!(f, "the model {name} can not be used: {cause}"),
            Self::UnknownCategory { category } => write!(
                f,
                "there is no generated category `{category}`; \
                 `tabula simulate categories` lists those there are"
            ),
            Self::NoRoom {
                n_objects,
                n_placed,
            } => write!(
                f,
                "only {n_placed} of {n_objects} objects find a place apart from each other; \
                 ask for fewer, for a larger table, or for a pile"
            ),
        }
    }
}

impl std::error::Error for Error {}
