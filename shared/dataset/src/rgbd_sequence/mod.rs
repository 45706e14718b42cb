//! RGB-D sequences, in the folder format of 7-Scenes (Shotton et al. 2013) as
//! `tsdf-fusion` packs it.
//!
//! | file | content |
//! |---|---|
//! | `camera-intrinsics.txt` | 3 x 3 matrix of the depth camera, pixels |
//! | `gravity-direction.txt` | optional: downwards, in the world frame |
//! | `frame-NNNNNN.depth.png` | 16 bits a pixel, millimetres; 0 and 65535 are no depth |
//! | `frame-NNNNNN.color.jpg` | of the same size |
//! | `frame-NNNNNN.pose.txt` | optional: 4 x 4 matrix, world from camera, metres |
//!
//! The colour camera's offset is left as recorded: a pixel's point has the
//! colour of the same pixel.

mod error;
mod image;
mod projection;
mod text;

pub use error::{ContentError, Error};
pub use image::{decode_color, decode_depth, depth_image_size};
pub use projection::BackProjection;
pub use text::{parse_gravity, parse_intrinsics, parse_pose};

use crate::bounded_file::{file_names, read_file};
use geometry::{PinholeCamera, RigidTransform};
use nalgebra::{UnitVector3, Vector3};
use point_cloud::Point;
use std::path::{Path, PathBuf};

/// Most bytes read from a text file.
const MAX_TEXT_BYTES: u64 = 1 << 16;
/// Most bytes read from an image file.
const MAX_IMAGE_BYTES: u64 = 1 << 25;

const DEPTH_SUFFIX: &str = ".depth.png";
const COLOR_SUFFIX: &str = ".color.jpg";
const POSE_SUFFIX: &str = ".pose.txt";

/// An open folder: which frames there are, and the camera that took them.
#[derive(Debug)]
pub struct RgbdSequence {
    folder: PathBuf,
    frames: Vec<Frame>,
    camera: PinholeCamera,
    gravity_in_world: Option<UnitVector3<f64>>,
    projection: BackProjection,
}

#[derive(Debug)]
struct Frame {
    stem: String,
    has_pose: bool,
}

/// Memory that is kept from frame to frame.
#[derive(Debug, Default)]
pub struct Scratch {
    file: Vec<u8>,
    depth_mm: Vec<u16>,
}

impl RgbdSequence {
    /// Lists the frames of a folder in natural order and reads what is common
    /// to them. All depth images must have the size of the first.
    ///
    /// # Errors
    /// When there are no frames, a depth image lacks its colour image or the
    /// other way round, or the camera or the first depth image is wrong.
    pub fn open(folder: &Path) -> Result<Self, Error> {
        let frames = list_frames(folder)?;
        let mut file = Vec::new();
        let first_depth = folder.join(frames[0].stem.clone() + DEPTH_SUFFIX);
        let size = read_with(&first_depth, MAX_IMAGE_BYTES, &mut file, depth_image_size)?;
        let intrinsics = folder.join("camera-intrinsics.txt");
        let camera = read_with(&intrinsics, MAX_TEXT_BYTES, &mut file, |bytes| {
            parse_intrinsics(bytes, size)
        })?;
        let gravity = folder.join("gravity-direction.txt");
        let gravity_in_world = if gravity.exists() {
            Some(read_with(
                &gravity,
                MAX_TEXT_BYTES,
                &mut file,
                parse_gravity,
            )?)
        } else {
            None
        };
        let projection = BackProjection::new(&camera);
        Ok(Self {
            folder: folder.to_owned(),
            frames,
            camera,
            gravity_in_world,
            projection,
        })
    }

    /// Number of frames, at least 1.
    pub fn n_frames(&self) -> usize {
        self.frames.len()
    }

    /// The common part of the names of a frame's files, such as
    /// `frame-000123`; `None` behind the last frame.
    pub fn name(&self, index: usize) -> Option<&str> {
        self.frames.get(index).map(|frame| frame.stem.as_str())
    }

    /// The depth camera.
    pub fn camera(&self) -> &PinholeCamera {
        &self.camera
    }

    /// Downwards, unit length, world frame.
    pub fn gravity_in_world(&self) -> Option<UnitVector3<f64>> {
        self.gravity_in_world
    }

    /// Decodes a frame into organised points of the camera frame, and returns
    /// its pose, world from camera, if it has one.
    ///
    /// *Shape*: `out` has the camera's `n_pixels()`, row by row. After an error
    /// its content is unspecified.
    /// *Allocation*: what the image decoders need for themselves.
    ///
    /// # Errors
    /// When there is no such frame, `out` has another length, or a file can not
    /// be read, is damaged or has another size than the first depth image.
    pub fn fill(
        &self,
        index: usize,
        scratch: &mut Scratch,
        out: &mut [Point],
    ) -> Result<Option<RigidTransform>, Error> {
        let Some(frame) = self.frames.get(index) else {
            return Err(Error::NoSuchFrame {
                index,
                n_frames: self.frames.len(),
            });
        };
        let (found, needed) = (out.len(), self.camera.n_pixels());
        if found != needed {
            return Err(Error::OutputLength { found, needed });
        }
        let size = (self.camera.width, self.camera.height);
        let path = |suffix| self.folder.join(frame.stem.clone() + suffix);
        let Scratch { file, depth_mm } = scratch;
        read_with(&path(DEPTH_SUFFIX), MAX_IMAGE_BYTES, file, |bytes| {
            decode_depth(bytes, size, depth_mm)
        })?;
        let color_path = path(COLOR_SUFFIX);
        read_with(&color_path, MAX_IMAGE_BYTES, file, |bytes| {
            self.projection
                .fill(depth_mm, &decode_color(bytes, size)?, out)
        })?;
        if !frame.has_pose {
            return Ok(None);
        }
        read_with(&path(POSE_SUFFIX), MAX_TEXT_BYTES, file, parse_pose).map(Some)
    }
}

/// Whether a file is a depth image of a sequence.
pub(crate) fn is_depth_name(name: &str) -> bool {
    stem(name, DEPTH_SUFFIX).is_some()
}

/// `frame-000123` of `frame-000123.depth.png`.
fn stem<'a>(name: &'a str, suffix: &str) -> Option<&'a str> {
    let stem = name.strip_suffix(suffix)?;
    let digits = stem.strip_prefix("frame-")?;
    let is_number = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit());
    is_number.then_some(stem)
}

fn list_frames(folder: &Path) -> Result<Vec<Frame>, Error> {
    let names = file_names(folder, |name| {
        [DEPTH_SUFFIX, COLOR_SUFFIX, POSE_SUFFIX]
            .iter()
            .any(|suffix| stem(name, suffix).is_some())
    })?;
    let has = |stem: &str, suffix: &str| {
        let wanted = format!("{stem}{suffix}");
        names
            .binary_search_by(|name| crate::natural_order(name, &wanted))
            .is_ok()
    };
    let mut frames = Vec::new();
    for name in &names {
        if let Some(stem) = stem(name, DEPTH_SUFFIX) {
            if !has(stem, COLOR_SUFFIX) {
                return Err(Error::Unpaired {
                    path: folder.join(name),
                    missing: COLOR_SUFFIX,
                });
            }
            frames.push(Frame {
                stem: stem.to_owned(),
                has_pose: has(stem, POSE_SUFFIX),
            });
        } else if let Some(stem) = stem(name, COLOR_SUFFIX)
            && !has(stem, DEPTH_SUFFIX)
        {
            return Err(Error::Unpaired {
                path: folder.join(name),
                missing: DEPTH_SUFFIX,
            });
        }
    }
    if frames.is_empty() {
        Err(Error::NoFrames(folder.to_owned()))
    } else {
        Ok(frames)
    }
}

/// Reads a file and hands its bytes to a parser; an error names the file.
fn read_with<T>(
    path: &Path,
    limit: u64,
    buffer: &mut Vec<u8>,
    parse: impl FnOnce(&[u8]) -> Result<T, ContentError>,
) -> Result<T, Error> {
    read_file(path, limit, buffer)?;
    parse(buffer).map_err(|source| Error::Content {
        path: path.to_owned(),
        source,
    })
}

#[cfg(test)]
mod flat_jpeg;
#[cfg(test)]
mod tests;
