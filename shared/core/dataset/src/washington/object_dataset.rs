//! Reader of a folder tree in the Washington layout.

use super::cloud::read_cloud;
use super::image::{decode_color, decode_depth, decode_mask};
use super::location::parse_location;
use super::view::CroppedView;
use super::view_name::ViewName;
use super::{CAMERA, CLOUD_SUFFIX, COLOR_SUFFIX, DEPTH_SUFFIX, LOCATION_SUFFIX, MASK_SUFFIX};
use crate::pcd;
use crate::{ContentError, Error};
use file_access::{file_names, folder_names, read_file};
use point_cloud::Point;
use std::path::{Path, PathBuf};

/// Maximum number of views of a dataset.
const MAX_VIEWS: usize = 1 << 20;
/// Maximum number of folders of a dataset.
const MAX_FOLDERS: usize = 1 << 16;
/// Maximum depth of folders below the root.
const MAX_LEVELS: usize = 2;
/// Maximum size of an image file, bytes.
const MAX_IMAGE_BYTES: u64 = 1 << 25;
/// Maximum size of a crop position file, bytes.
const MAX_LOCATION_BYTES: u64 = 1 << 12;

/// File name suffixes of a view; each corresponds to a bit of the masks below.
const SUFFIXES: [&str; 5] = [
    COLOR_SUFFIX,
    DEPTH_SUFFIX,
    MASK_SUFFIX,
    LOCATION_SUFFIX,
    CLOUD_SUFFIX,
];
const IMAGES: u8 = 0b0_1111;
const CLOUD: u8 = 0b1_0000;

/// Dataset in the Washington layout: views by category in natural order, then by instance,
/// sequence and frame.
#[derive(Debug)]
pub struct ObjectDataset {
    folders: Vec<PathBuf>,
    views: Vec<ListedView>,
    n_incomplete: usize,
}

/// Listed view with the folder of each of its files.
#[derive(Debug)]
struct ListedView {
    name: ViewName,
    /// Folder index of each file; 0 for missing files.
    folders: [u32; SUFFIXES.len()],
    found: u8,
}

impl ObjectDataset {
    /// Lists the views in a folder and up to two levels of folders below, without opening files.
    /// Files with other names are ignored.
    ///
    /// # Errors
    /// When a folder cannot be read, no view is complete, a file exists
    /// twice, or there are too many.
    pub fn open(root: &Path) -> Result<Self, Error> {
        let folders = list_folders(root)?;
        let mut files = Vec::new();
        for (folder, path) in folders.iter().enumerate() {
            let names = file_names(path, |name| parse_file_name(name).is_some())?;
            let parsed = names.iter().filter_map(|name| parse_file_name(name));
            files.extend(parsed.map(|(name, suffix)| (name, suffix, folder as u32)));
            if files.len() > SUFFIXES.len() * MAX_VIEWS {
                return Err(Error::TooLarge(root.to_owned()));
            }
        }
        files.sort_unstable();
        let mut dataset = Self {
            folders,
            views: Vec::new(),
            n_incomplete: 0,
        };
        for files in files.chunk_by(|left, right| left.0 == right.0) {
            dataset.push(files)?;
        }
        match dataset.views.len() {
            0 => Err(Error::NoCrops(root.to_owned())),
            1..=MAX_VIEWS => Ok(dataset),
            _ => Err(Error::TooLarge(root.to_owned())),
        }
    }

    /// Adds a view from all of its files.
    fn push(&mut self, files: &[(ViewName, usize, u32)]) -> Result<(), Error> {
        let mut view = ListedView {
            name: files[0].0.clone(),
            folders: [0; SUFFIXES.len()],
            found: 0,
        };
        for &(_, suffix, folder) in files {
            if view.found & 1 << suffix != 0 {
                let path = self.path(&view, suffix);
                return Err(Error::Duplicate(path));
            }
            view.found |= 1 << suffix;
            view.folders[suffix] = folder;
        }
        if view.has(IMAGES) || view.has(CLOUD) {
            self.views.push(view);
        } else {
            self.n_incomplete += 1;
        }
        Ok(())
    }

    /// Number of views, at least 1.
    pub fn n_views(&self) -> usize {
        self.views.len()
    }

    /// Number of views left out because they have neither all images with their position nor
    /// points.
    pub fn n_incomplete(&self) -> usize {
        self.n_incomplete
    }

    /// Name of a view; `None` after the last.
    pub fn name(&self, index: usize) -> Option<&ViewName> {
        self.views.get(index).map(|view| &view.name)
    }

    /// Names of all views, in order.
    pub fn names(&self) -> impl ExactSizeIterator<Item = &ViewName> {
        self.views.iter().map(|view| &view.name)
    }

    /// Category names, in natural order.
    pub fn categories(&self) -> Vec<&str> {
        let mut categories: Vec<&str> = self.names().map(ViewName::category).collect();
        categories.dedup();
        categories
    }

    /// Instances of a category, in order; empty for an unknown category.
    pub fn instances(&self, category: &str) -> Vec<u32> {
        let views = self.names().filter(|name| name.category() == category);
        let mut instances: Vec<u32> = views.map(ViewName::instance).collect();
        instances.dedup();
        instances
    }

    /// True if a view has images, for [`load`](Self::load).
    pub fn has_images(&self, index: usize) -> bool {
        self.views.get(index).is_some_and(|view| view.has(IMAGES))
    }

    /// True if a view has a point cloud, for [`load_cloud`](Self::load_cloud).
    pub fn has_cloud(&self, index: usize) -> bool {
        self.views.get(index).is_some_and(|view| view.has(CLOUD))
    }

    /// Reads the images of a view and the position of its crop.
    ///
    /// # Errors
    /// When there is no such view, it has no images, or a file cannot be read
    /// or is wrong; each error of a file names it.
    pub fn load(&self, index: usize) -> Result<CroppedView, Error> {
        let listed = self.listed(index, IMAGES, "images")?;
        let (mut view, mut file) = (CroppedView::default(), Vec::new());
        view.size = self.read(listed, 0, MAX_IMAGE_BYTES, &mut file, |bytes| {
            decode_color(bytes, &mut view.color)
        })?;
        self.read(listed, 1, MAX_IMAGE_BYTES, &mut file, |bytes| {
            decode_depth(bytes, view.size, &mut view.depth_mm)
        })?;
        self.read(listed, 2, MAX_IMAGE_BYTES, &mut file, |bytes| {
            decode_mask(bytes, view.size, &mut view.mask)
        })?;
        view.top_left = self.read(listed, 3, MAX_LOCATION_BYTES, &mut file, parse_location)?;
        Ok(view)
    }

    /// Reads the points of a view from its PCD file.
    ///
    /// *Frame*: camera, metres.
    ///
    /// # Errors
    /// When there is no such view, it has no points, or the file cannot be
    /// read or is wrong.
    pub fn load_cloud(&self, index: usize) -> Result<Vec<Point>, Error> {
        let listed = self.listed(index, CLOUD, "points")?;
        let mut file = Vec::new();
        self.read(listed, 4, pcd::MAX_BYTES, &mut file, |bytes| {
            Ok(read_cloud(bytes)?)
        })
    }

    /// Reads the points of a view: from its PCD file if present, otherwise from its images with
    /// [`CAMERA`].
    ///
    /// *Frame*: camera, metres.
    ///
    /// # Errors
    /// When there is no such view, or a file cannot be read or is wrong.
    pub fn load_points(&self, index: usize) -> Result<Vec<Point>, Error> {
        if self.has_images(index) && !self.has_cloud(index) {
            self.load(index)?.points(&CAMERA)
        } else {
            self.load_cloud(index)
        }
    }

    /// First file read by [`load_points`](Self::load_points); `None` after the last view.
    pub fn points_file(&self, index: usize) -> Option<PathBuf> {
        let suffix = if self.has_cloud(index) { 4 } else { 0 };
        Some(self.path(self.views.get(index)?, suffix))
    }

    fn listed(&self, index: usize, wanted: u8, what: &'static str) -> Result<&ListedView, Error> {
        let n = self.views.len();
        let view = self.views.get(index);
        let view = view.ok_or(Error::NoSuch {
            what: "view",
            index,
            n,
        })?;
        if view.has(wanted) {
            return Ok(view);
        }
        let name = view.name.to_string();
        Err(Error::MissingPart { name, what })
    }

    /// Reads and parses a file of a view by the index of its suffix; an error names the file.
    fn read<T>(
        &self,
        view: &ListedView,
        suffix: usize,
        limit: u64,
        buffer: &mut Vec<u8>,
        parse: impl FnOnce(&[u8]) -> Result<T, ContentError>,
    ) -> Result<T, Error> {
        let path = self.path(view, suffix);
        read_file(&path, limit, buffer)?;
        parse(buffer).map_err(Error::content(&path))
    }

    fn path(&self, view: &ListedView, suffix: usize) -> PathBuf {
        let folder = &self.folders[view.folders[suffix] as usize];
        folder.join(format!("{}{}", view.name, SUFFIXES[suffix]))
    }
}

impl ListedView {
    fn has(&self, wanted: u8) -> bool {
        self.found & wanted == wanted
    }
}

/// View name and suffix index of a file name.
fn parse_file_name(file_name: &str) -> Option<(ViewName, usize)> {
    SUFFIXES.iter().enumerate().find_map(|(idx, suffix)| {
        let name = ViewName::parse(file_name.strip_suffix(suffix)?)?;
        Some((name, idx))
    })
}

/// Root and folders below it, level by level.
fn list_folders(root: &Path) -> Result<Vec<PathBuf>, Error> {
    let mut folders = vec![root.to_owned()];
    let mut level = 0..1;
    for _ in 0..MAX_LEVELS {
        for idx in level.clone() {
            let parent = folders[idx].clone();
            for name in folder_names(&parent)? {
                folders.push(parent.join(name));
            }
            if folders.len() > MAX_FOLDERS {
                return Err(Error::TooLarge(root.to_owned()));
            }
        }
        level = level.end..folders.len();
    }
    Ok(folders)
}
