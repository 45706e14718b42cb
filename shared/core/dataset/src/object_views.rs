//! Datasets of single-object views, in several layouts.
//!
//! | layout | category | instance |
//! |---|---|---|
//! | of [`crate::washington`] | from the view's name | from the view's name |
//! | a folder of PCD files for each category | the folder's name | unknown |
//!
//! A data set with at least one name of a Washington view has that layout.

mod category_folders;
mod object_view;

use crate::Error;
use crate::washington::ObjectDataset;
use category_folders::CategoryFolders;
pub use object_view::ObjectView;
use std::path::{Path, PathBuf};

/// Metadata of one view of a dataset.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ViewFile {
    /// First file of the view, relative to the dataset's folder.
    pub path: PathBuf,
    /// Category name of the view.
    pub category: String,
    /// Instance within the category, if known from the layout.
    pub instance: Option<String>,
    /// Frame number within the turn of the turntable, if known from the layout: views of an
    /// instance with nearby numbers show the same side.
    pub frame: Option<u32>,
}

/// Views of a dataset, by category in natural order. Files are read one at a time by
/// [`load`](Self::load).
#[derive(Debug)]
pub struct ObjectViews {
    layout: DatasetLayout,
    files: Vec<ViewFile>,
    unusable: Vec<Error>,
}

#[derive(Debug)]
enum DatasetLayout {
    Washington(ObjectDataset),
    Categories(CategoryFolders),
}

impl ObjectViews {
    /// Lists the views of a folder without opening files. Category folders that cannot be listed
    /// are reported by [`unusable`](Self::unusable).
    ///
    /// # Errors
    /// When the folder cannot be listed, holds no views, or is no data set of
    /// either layout.
    pub fn open(root: &Path) -> Result<Self, Error> {
        match ObjectDataset::open(root) {
            Ok(dataset) => Ok(Self::of_washington(root, dataset)),
            Err(Error::NoCrops(_)) => Self::of_categories(root),
            Err(error) => Err(error),
        }
    }

    fn of_washington(root: &Path, dataset: ObjectDataset) -> Self {
        let paths = (0..dataset.n_views()).filter_map(|index| dataset.points_file(index));
        let files = dataset.names().zip(paths).map(|(name, path)| ViewFile {
            path: path.strip_prefix(root).unwrap_or(&path).to_owned(),
            category: name.category().to_owned(),
            instance: Some(name.instance().to_string()),
            frame: Some(name.frame()),
        });
        Self {
            files: files.collect(),
            layout: DatasetLayout::Washington(dataset),
            unusable: Vec::new(),
        }
    }

    fn of_categories(root: &Path) -> Result<Self, Error> {
        let (folders, unusable) = CategoryFolders::open(root)?;
        let files = folders.files().map(|(category, path)| ViewFile {
            path: path.to_owned(),
            category: category.to_owned(),
            instance: None,
            frame: None,
        });
        Ok(Self {
            files: files.collect(),
            layout: DatasetLayout::Categories(folders),
            unusable,
        })
    }

    /// Metadata of all views, at least one.
    pub fn files(&self) -> &[ViewFile] {
        &self.files
    }

    /// Errors of the category folders that could not be listed.
    pub fn unusable(&self) -> &[Error] {
        &self.unusable
    }

    /// Number of views left out because of missing files.
    pub fn n_incomplete(&self) -> usize {
        match &self.layout {
            DatasetLayout::Washington(dataset) => dataset.n_incomplete(),
            DatasetLayout::Categories(_) => 0,
        }
    }

    /// True if [`up`](ObjectView::up) is known for all views; in the Washington layout it follows
    /// from the sequence number.
    pub fn is_up_known(&self) -> bool {
        match &self.layout {
            DatasetLayout::Washington(dataset) => dataset
                .names()
                .all(|name| object_view::elevation_deg(name.sequence()).is_some()),
            DatasetLayout::Categories(_) => false,
        }
    }

    /// True if the points are in metres by the layout; a PCD file does not tell its unit.
    pub fn is_unit_known(&self) -> bool {
        matches!(self.layout, DatasetLayout::Washington(_))
    }

    /// Reads a view by its index among [`files`](Self::files).
    ///
    /// # Errors
    /// When there is no such view, a file cannot be read or is wrong, or no point
    /// has depth; the error names the file.
    pub fn load(&self, index: usize) -> Result<ObjectView, Error> {
        let (what, n) = ("view", self.files.len());
        let file = self.files.get(index);
        let file = file.ok_or(Error::NoSuch { what, index, n })?;
        let view = match &self.layout {
            DatasetLayout::Washington(dataset) => ObjectView::of_washington(dataset, index)?,
            DatasetLayout::Categories(folders) => folders.load(index)?,
        };
        if view.points.is_empty() {
            return Err(Error::NoPoints(file.path.clone()));
        }
        Ok(view)
    }
}

#[cfg(test)]
mod tests;
