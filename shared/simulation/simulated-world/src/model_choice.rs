//! Object models by source: generated instances and model files.

use std::path::PathBuf;

/// Source of object models.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum ModelSource {
    /// Generated household objects.
    #[default]
    Generated,
    /// PLY, OBJ, STL and DAE files of a folder.
    Folder(PathBuf),
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
