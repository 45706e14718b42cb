//! Pairs of colour and depth images, by file names.

use super::timestamp::{associate, parse_timestamp};
use crate::Error;
use file_access::{file_names, folder_names};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Subfolder of depth images.
pub(super) const DEPTH_FOLDER: &str = "depth";
/// Subfolders of colour images.
pub(super) const COLOR_FOLDERS: [&str; 3] = ["rgb", "color", "colour"];

const DEPTH_EXTENSIONS: [&str; 1] = ["png"];
const COLOR_EXTENSIONS: [&str; 3] = ["png", "jpg", "jpeg"];

/// Images of one frame.
#[derive(Debug)]
pub(super) struct ImagePair {
    /// Common part of the file names; of timestamps that of the depth image.
    pub(super) name: String,
    pub(super) depth: PathBuf,
    pub(super) color: PathBuf,
}

/// Frames of a folder in natural order, at least one.
#[derive(Debug)]
pub(super) struct PairList {
    pub(super) pairs: Vec<ImagePair>,
    /// Number of images with a timestamp far from all others.
    pub(super) n_unpaired: usize,
}

/// Role of an image in its frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ImageRole {
    Depth,
    Color,
}

impl ImageRole {
    fn has_extension(self, extension: &str) -> bool {
        let extensions: &[&str] = match self {
            Self::Depth => &DEPTH_EXTENSIONS,
            Self::Color => &COLOR_EXTENSIONS,
        };
        let mut known = extensions.iter();
        known.any(|known| known.eq_ignore_ascii_case(extension))
    }

    fn other(self) -> Self {
        match self {
            Self::Depth => Self::Color,
            Self::Color => Self::Depth,
        }
    }
}

/// Arrangement of the images in their folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Layout {
    /// Role as the last word of the file name.
    Suffixes,
    /// Role as the name of the subfolder.
    Subfolders,
}

impl Layout {
    /// Usual path of a frame's image in its folder.
    fn example(self, role: ImageRole, name: &str) -> String {
        match (self, role) {
            (Self::Suffixes, ImageRole::Depth) => format!("{name}-depth.png"),
            (Self::Suffixes, ImageRole::Color) => format!("{name}-color.png or .jpg"),
            (Self::Subfolders, ImageRole::Depth) => format!("depth/{name}.png"),
            (Self::Subfolders, ImageRole::Color) => format!("rgb/{name}.png or .jpg"),
        }
    }
}

/// Role and frame name of an image by its file name: `000123` of `000123-depth.png`.
pub(super) fn image_role(file_name: &str) -> Option<(ImageRole, &str)> {
    let (stem, extension) = file_name.rsplit_once('.')?;
    let (name, word) = stem.rsplit_once(['-', '_', '.'])?;
    let role = match word.to_ascii_lowercase().as_str() {
        "depth" => ImageRole::Depth,
        "color" | "colour" | "rgb" => ImageRole::Color,
        _ => return None,
    };
    let is_image = role.has_extension(extension) && is_visible(name);
    is_image.then_some((role, name))
}

/// False for empty and hidden names.
fn is_visible(name: &str) -> bool {
    !name.is_empty() && !name.starts_with('.')
}

/// Pairs the images of a folder.
pub(super) fn list_pairs(folder: &Path) -> Result<PairList, Error> {
    let mut images = Images::default();
    for file_name in file_names(folder, |_| true)? {
        if let Some((role, name)) = image_role(&file_name) {
            images.insert(role, name, folder.join(&file_name))?;
        }
    }
    let subfolders = Images::in_subfolders(folder)?;
    let (images, layout) = match (images.depth.is_empty(), subfolders.depth.is_empty()) {
        (false, false) => return Err(Error::TwoLayouts(folder.to_owned())),
        (true, false) => (subfolders, Layout::Subfolders),
        // Colour images without any depth image are reported as such.
        (true, true) if images.color.is_empty() => (subfolders, Layout::Subfolders),
        _ => (images, Layout::Suffixes),
    };
    let list = match images.timestamps() {
        Some(seconds) if layout == Layout::Subfolders => images.pair_by_time(&seconds),
        _ => images.pair_by_name(layout)?,
    };
    if list.pairs.is_empty() {
        return Err(Error::NoPairs(folder.to_owned()));
    }
    Ok(list)
}

/// Paths of depth and colour images by frame name.
#[derive(Debug, Default)]
struct Images {
    depth: BTreeMap<String, PathBuf>,
    color: BTreeMap<String, PathBuf>,
}

impl Images {
    /// Images of the subfolders; none unless there are some of both roles.
    fn in_subfolders(folder: &Path) -> Result<Self, Error> {
        let mut images = Self::default();
        for subfolder in folder_names(folder)? {
            let role = match subfolder.as_str() {
                DEPTH_FOLDER => ImageRole::Depth,
                name if COLOR_FOLDERS.contains(&name) => ImageRole::Color,
                _ => continue,
            };
            let subfolder = folder.join(subfolder);
            for file_name in file_names(&subfolder, |_| true)? {
                if let Some((name, extension)) = file_name.rsplit_once('.')
                    && role.has_extension(extension)
                    && is_visible(name)
                {
                    images.insert(role, name, subfolder.join(&file_name))?;
                }
            }
        }
        Ok(images)
    }

    fn insert(&mut self, role: ImageRole, name: &str, path: PathBuf) -> Result<(), Error> {
        let images = match role {
            ImageRole::Depth => &mut self.depth,
            ImageRole::Color => &mut self.color,
        };
        match images.insert(name.to_owned(), path.clone()) {
            None => Ok(()),
            Some(first) => Err(Error::Ambiguous {
                paths: [first, path],
            }),
        }
    }

    /// Pairs images of equal names; every image must have its companion.
    fn pair_by_name(mut self, layout: Layout) -> Result<PairList, Error> {
        let unpaired = |role: ImageRole, name: &str, path: PathBuf| Error::Unpaired {
            missing: layout.example(role.other(), name),
            path,
        };
        let mut pairs = Vec::new();
        for (name, depth) in self.depth {
            let Some(color) = self.color.remove(&name) else {
                return Err(unpaired(ImageRole::Depth, &name, depth));
            };
            pairs.push(ImagePair { name, depth, color });
        }
        if let Some((name, path)) = self.color.pop_first() {
            return Err(unpaired(ImageRole::Color, &name, path));
        }
        pairs.sort_unstable_by(|left, right| file_access::natural_order(&left.name, &right.name));
        let n_unpaired = 0;
        Ok(PairList { pairs, n_unpaired })
    }

    /// Timestamps of depth and colour images, seconds, in the order of their names; `None` if a
    /// name is none, or if the names are equal.
    fn timestamps(&self) -> Option<[Vec<f64>; 2]> {
        if self.depth.keys().eq(self.color.keys()) {
            return None;
        }
        let seconds = |images: &BTreeMap<String, PathBuf>| -> Option<Vec<f64>> {
            let names = images.keys();
            names.map(|name| parse_timestamp(name)).collect()
        };
        Some([seconds(&self.depth)?, seconds(&self.color)?])
    }

    /// Pairs images of nearly the same time.
    fn pair_by_time(self, [depth_s, color_s]: &[Vec<f64>; 2]) -> PairList {
        let n_images = self.depth.len() + self.color.len();
        let mut depth = by_time(self.depth, depth_s);
        let mut color = by_time(self.color, color_s);
        let sorted = |images: &[TimedImage]| -> Vec<f64> {
            images.iter().map(|image| image.time_s).collect()
        };
        let associated = associate(&sorted(&depth), &sorted(&color));
        let pair = |(depth_index, color_index): (usize, usize)| ImagePair {
            name: std::mem::take(&mut depth[depth_index].name),
            depth: std::mem::take(&mut depth[depth_index].path),
            color: std::mem::take(&mut color[color_index].path),
        };
        let pairs: Vec<ImagePair> = associated.into_iter().map(pair).collect();
        let n_unpaired = n_images - 2 * pairs.len();
        PairList { pairs, n_unpaired }
    }
}

/// Image with its timestamp.
struct TimedImage {
    time_s: f64,
    name: String,
    path: PathBuf,
}

/// Images in the order of their timestamps.
fn by_time(images: BTreeMap<String, PathBuf>, seconds: &[f64]) -> Vec<TimedImage> {
    let images = images.into_iter().zip(seconds);
    let mut timed: Vec<TimedImage> = images
        .map(|((name, path), &time_s)| TimedImage { time_s, name, path })
        .collect();
    timed.sort_by(|left, right| left.time_s.total_cmp(&right.time_s));
    timed
}
