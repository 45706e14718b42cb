//! Data sets of single objects, in whatever layout they come.
//!
//! | layout | category | instance |
//! |---|---|---|
//! | of [`washington`](crate::washington) | from the view's name | from the view's name |
//! | a folder of PCD files for each category | the folder's name | unknown |
//!
//! A data set with at least one name of a Washington view has that layout.

mod category_folders;
mod error;
mod object_view;

use crate::washington::{self, ObjectDataset};
use category_folders::CategoryFolders;
pub use error::Error;
pub use object_view::ObjectView;
use std::path::{Path, PathBuf};

/// One view of a data set.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ViewFile {
    /// Its file, or the first of its files, relative to the data set's folder.
    pub path: PathBuf,
    /// What it shows.
    pub category: String,
    /// Which object of its category, if the layout tells.
    pub instance: Option<String>,
}

/// The views of a data set, by category in natural order. Files are read one by
/// one, by [`load`](Self::load).
#[derive(Debug)]
pub struct ObjectViews {
    layout: Layout,
    files: Vec<ViewFile>,
    unusable: Vec<Error>,
}

#[derive(Debug)]
enum Layout {
    Washington(ObjectDataset),
    Categories(CategoryFolders),
}

impl ObjectViews {
    /// Lists the views of a folder. No file is opened. Folders of categories that
    /// can not be listed are in [`unusable`](Self::unusable).
    ///
    /// # Errors
    /// When the folder can not be listed, holds no views, or is no data set of
    /// either layout.
    pub fn open(root: &Path) -> Result<Self, Error> {
        match ObjectDataset::open(root) {
            Ok(dataset) => Ok(Self::of_washington(root, dataset)),
            Err(washington::Error::NoViews(_)) => Self::of_categories(root),
            Err(error) => Err(error.into()),
        }
    }

    fn of_washington(root: &Path, dataset: ObjectDataset) -> Self {
        let paths = (0..dataset.n_views()).filter_map(|index| dataset.points_file(index));
        let files = dataset.names().zip(paths).map(|(name, path)| ViewFile {
            path: path.strip_prefix(root).unwrap_or(&path).to_owned(),
            category: name.category().to_owned(),
            instance: Some(name.instance().to_string()),
        });
        Self {
            files: files.collect(),
            layout: Layout::Washington(dataset),
            unusable: Vec::new(),
        }
    }

    fn of_categories(root: &Path) -> Result<Self, Error> {
        let (folders, unusable) = CategoryFolders::open(root)?;
        let files = folders.files().map(|(category, path)| ViewFile {
            path: path.to_owned(),
            category: category.to_owned(),
            instance: None,
        });
        Ok(Self {
            files: files.collect(),
            layout: Layout::Categories(folders),
            unusable,
        })
    }

    /// The views, at least one.
    pub fn files(&self) -> &[ViewFile] {
        &self.files
    }

    /// Why folders of categories could not be listed.
    pub fn unusable(&self) -> &[Error] {
        &self.unusable
    }

    /// Number of views that are left out, since their files are not complete.
    pub fn n_incomplete(&self) -> usize {
        match &self.layout {
            Layout::Washington(dataset) => dataset.n_incomplete(),
            Layout::Categories(_) => 0,
        }
    }

    /// Whether [`up`](ObjectView::up) is known of all views: the layout of the
    /// Washington data set tells it by the number of the sequence.
    pub fn tell_up(&self) -> bool {
        match &self.layout {
            Layout::Washington(dataset) => dataset
                .names()
                .all(|name| object_view::elevation_deg(name.sequence()).is_some()),
            Layout::Categories(_) => false,
        }
    }

    /// Reads a view by its index among [`files`](Self::files).
    ///
    /// # Errors
    /// When there is no such view, a file can not be read or is wrong, or no point
    /// has depth; the error names the file.
    pub fn load(&self, index: usize) -> Result<ObjectView, Error> {
        let n_views = self.files.len();
        let file = self.files.get(index);
        let file = file.ok_or(Error::NoSuchView { index, n_views })?;
        let view = match &self.layout {
            Layout::Washington(dataset) => ObjectView::of_washington(dataset, index)?,
            Layout::Categories(folders) => folders.load(index)?,
        };
        if view.points.is_empty() {
            return Err(Error::NoPoints(file.path.clone()));
        }
        Ok(view)
    }
}

#[cfg(test)]
mod tests;
