//! Object models by source: generated instances and model files.

use std::ffi::OsString;
use std::fmt;
use std::path::{Path, PathBuf};

/// Word of the generated objects where a folder of models is named.
const GENERATED: &str = "generated";

/// Source of object models.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum ModelSource {
    /// Generated household objects.
    #[default]
    Generated,
    /// PLY, OBJ, STL and DAE files of a folder.
    Folder(PathBuf),
}

impl From<OsString> for ModelSource {
    fn from(name: OsString) -> Self {
        let path = PathBuf::from(name);
        if path == Path::new(GENERATED) {
            Self::Generated
        } else {
            Self::Folder(path)
        }
    }
}

impl fmt::Display for ModelSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Generated => f.write_str(GENERATED),
            Self::Folder(folder) => folder.display().fmt(f),
        }
    }
}

/// Choice of an object model.
#[derive(Debug, Clone, PartialEq)]
pub enum ModelChoice {
    /// Generated household object.
    Generated {
        /// Category name of the generated object.
        category: String,
        /// Instance number of the generated object.
        instance: u64,
    },
    /// Model file in PLY, OBJ, STL or DAE format.
    File(PathBuf),
}

impl ModelChoice {
    /// Category; for a model file, derived from the file name.
    pub fn category(&self) -> String {
        match self {
            Self::Generated { category, .. } => category.clone(),
            Self::File(path) => crate::model_file::category_and_name(path).0,
        }
    }
}
