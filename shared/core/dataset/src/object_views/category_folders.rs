//! Dataset layout with one folder of PCD files per category.

use super::object_view::ObjectView;
use crate::Error;
use crate::pcd;
use crate::scene_folder::is_scene_name;
use file_access::{file_names, folder_names};
use std::path::{Path, PathBuf};

/// Maximum number of views of a dataset.
const MAX_VIEWS: usize = 1 << 20;

/// PCD files of the category folders, in natural order.
#[derive(Debug)]
pub(super) struct CategoryFolders {
    root: PathBuf,
    categories: Vec<String>,
    /// Category index, and path relative to the root.
    files: Vec<(usize, PathBuf)>,
}

impl CategoryFolders {
    /// Lists the files; returns an error for each folder that cannot be listed.
    pub(super) fn open(root: &Path) -> Result<(Self, Vec<Error>), Error> {
        let categories = folder_names(root)?;
        let (mut files, mut unusable) = (Vec::new(), Vec::new());
        for (category, folder) in categories.iter().enumerate() {
            match file_names(&root.join(folder), is_scene_name) {
                Ok(names) => {
                    let paths = names.iter().map(|name| Path::new(folder).join(name));
                    files.extend(paths.map(|path| (category, path)));
                }
                Err(error) => unusable.push(error.into()),
            }
            if files.len() > MAX_VIEWS {
                return Err(Error::TooLarge(root.to_owned()));
            }
        }
        if files.is_empty() {
            let first = unusable.into_iter().next();
            return Err(first.unwrap_or_else(|| Error::NoViews(root.to_owned())));
        }
        let folders = Self {
            root: root.to_owned(),
            categories,
            files,
        };
        Ok((folders, unusable))
    }

    /// Category and path of each listed file.
    pub(super) fn files(&self) -> impl Iterator<Item = (&str, &Path)> {
        let files = self.files.iter();
        files.map(|(category, path)| (self.categories[*category].as_str(), path.as_path()))
    }

    /// Reads a file by its index, which must be valid.
    pub(super) fn load(&self, index: usize) -> Result<ObjectView, Error> {
        let path = self.root.join(&self.files[index].1);
        match pcd::open(&path) {
            Ok(cloud) => Ok(ObjectView::of_pcd(cloud)),
            Err(error) => Err(Error::content(&path)(error.into())),
        }
    }
}
