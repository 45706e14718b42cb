//! RGB-D sequences, in the folder format of 7-Scenes (Shotton et al. 2013) as packed by
//! `tsdf-fusion`.
//!
//! | file | content |
//! |---|---|
//! | `camera-intrinsics.txt` | 3 x 3 matrix of the depth camera, pixels |
//! | `gravity-direction.txt` | optional: downwards, in the world frame |
//! | `frame-NNNNNN.depth.png` | 16 bits a pixel, millimetres; 0 and 65535 are no depth |
//! | `frame-NNNNNN.color.png` or `.color.jpg` | of the same size, 24 bits a pixel |
//! | `frame-NNNNNN.pose.txt` | optional: 4 x 4 matrix, world from camera, metres |
//! | `frame-NNNNNN.mask.png` | optional: 16 bits a pixel, instance mask, number of the object; 0 is background |
//! | `frame-NNNNNN.truth.json` | optional: ground truth of the scene |
//!
//! Masks and ground truth are extensions of this project; playback ignores
//! them. If both colour images exist, the PNG is used.
//!
//! The offset of the colour camera is not corrected: a pixel's point has the
//! colour of the same pixel.

mod back_projection;
mod frame_files;
mod image;
mod matrix_text;
mod writer;

pub use back_projection::BackProjection;
pub(crate) use frame_files::{is_depth_name, is_pose_name};
pub use image::{decode_color, decode_depth, decode_mask, depth_image_size};
pub use matrix_text::{parse_gravity, parse_intrinsics, parse_pose};
pub use writer::{FrameView, SequenceWriter};

use crate::{ContentError, Error};
use file_access::read_file;
use frame_files::{DEPTH_SUFFIX, FrameFiles, MASK_SUFFIX, POSE_SUFFIX, TRUTH_SUFFIX, list_frames};
use geometry::{PinholeCamera, RigidTransform};
use nalgebra::{UnitVector3, Vector3};
use point_cloud::Point;
use std::path::{Path, PathBuf};

/// Maximum size of a text file, bytes.
pub(crate) const MAX_TEXT_BYTES: u64 = 1 << 16;
/// Maximum size of an image file, bytes.
pub(crate) const MAX_IMAGE_BYTES: u64 = 1 << 25;

/// Maximum size of a ground-truth file, bytes.
const MAX_TRUTH_BYTES: u64 = 1 << 24;

/// Name of the file with the intrinsic matrix.
pub(crate) const INTRINSICS_NAME: &str = "camera-intrinsics.txt";
const GRAVITY_NAME: &str = "gravity-direction.txt";

/// Open RGB-D sequence: its frames and its camera.
#[derive(Debug)]
pub struct RgbdSequence {
    folder: PathBuf,
    frames: Vec<FrameFiles>,
    camera: PinholeCamera,
    gravity_in_world: Option<UnitVector3<f64>>,
    projection: BackProjection,
}

/// Image buffers reused from frame to frame. They hold the images of the frame filled last.
#[derive(Debug, Default)]
pub struct Scratch {
    pub(crate) file: Vec<u8>,
    pub(crate) depth: Vec<u16>,
    pub(crate) color_rgb: Vec<u8>,
}

impl Scratch {
    /// Depth image of the frame filled last, row by row, in the unit of its folder, for a sequence
    /// millimetres; 0 and 65535 without depth.
    pub fn depth(&self) -> &[u16] {
        &self.depth
    }

    /// Colour image of the frame filled last, row by row: red, green and blue of each pixel.
    pub fn color_rgb(&self) -> &[u8] {
        &self.color_rgb
    }
}

impl RgbdSequence {
    /// Opens a sequence: lists its frames in natural order and reads the shared files. All depth
    /// images must have the size of the first.
    ///
    /// # Errors
    /// When there are no frames, a depth image lacks its colour image or the
    /// other way round, or the camera or the first depth image is wrong. A
    /// colour image in PNG after the last frame is ignored: a killed
    /// [`SequenceWriter`] leaves one.
    pub fn open(folder: &Path) -> Result<Self, Error> {
        let frames = list_frames(folder)?;
        let mut file = Vec::new();
        let first_depth = folder.join(frames[0].stem.clone() + DEPTH_SUFFIX);
        let size = read_with(&first_depth, MAX_IMAGE_BYTES, &mut file, depth_image_size)?;
        let intrinsics = folder.join(INTRINSICS_NAME);
        let camera = read_with(&intrinsics, MAX_TEXT_BYTES, &mut file, |bytes| {
            parse_intrinsics(bytes, size)
        })?;
        let gravity = folder.join(GRAVITY_NAME);
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

    /// Common stem of a frame's file names, such as `frame-000123`; `None` after the last frame.
    pub fn name(&self, index: usize) -> Option<&str> {
        self.frames.get(index).map(|frame| frame.stem.as_str())
    }

    /// Intrinsics of the depth camera.
    pub fn camera(&self) -> &PinholeCamera {
        &self.camera
    }

    /// Gravity direction (downwards), unit length, world frame.
    pub fn gravity_in_world(&self) -> Option<UnitVector3<f64>> {
        self.gravity_in_world
    }

    /// Decodes a frame to organised points, camera frame; returns its pose, world from camera, if
    /// present.
    ///
    /// *Shape*: `out` has the camera's `n_pixels()`, row by row. After an error
    /// its content is unspecified.
    /// *Allocation*: what the image decoders need for themselves.
    ///
    /// # Errors
    /// When there is no such frame, `out` has another length, or a file cannot
    /// be read, is damaged or has another size than the first depth image.
    pub fn fill(
        &self,
        index: usize,
        scratch: &mut Scratch,
        out: &mut [Point],
    ) -> Result<Option<RigidTransform>, Error> {
        let frame = self.frame(index)?;
        let (found, needed) = (out.len(), self.camera.n_pixels());
        if found != needed {
            return Err(Error::OutputLength { found, needed });
        }
        let size = (self.camera.width, self.camera.height);
        let path = |suffix| self.path(frame, suffix);
        let Scratch {
            file,
            depth,
            color_rgb,
        } = scratch;
        read_with(&path(DEPTH_SUFFIX), MAX_IMAGE_BYTES, file, |bytes| {
            decode_depth(bytes, size, depth)
        })?;
        let color_path = path(frame.color_suffix);
        read_with(&color_path, MAX_IMAGE_BYTES, file, |bytes| {
            *color_rgb = decode_color(bytes, size)?;
            self.projection.fill(depth, color_rgb, out)
        })?;
        if !frame.has_pose {
            return Ok(None);
        }
        read_with(&path(POSE_SUFFIX), MAX_TEXT_BYTES, file, parse_pose).map(Some)
    }

    /// Decodes a frame's instance mask: number of each pixel's object, row-major, 0 for background.
    /// Returns false and no numbers without a mask.
    ///
    /// # Errors
    /// When there is no such frame, or the mask cannot be read, is damaged or
    /// has another size than the first depth image.
    pub fn read_mask(
        &self,
        index: usize,
        scratch: &mut Scratch,
        instances: &mut Vec<u16>,
    ) -> Result<bool, Error> {
        let frame = self.frame(index)?;
        instances.clear();
        if frame.has_mask {
            let (path, size) = (
                self.path(frame, MASK_SUFFIX),
                (self.camera.width, self.camera.height),
            );
            read_with(&path, MAX_IMAGE_BYTES, &mut scratch.file, |bytes| {
                decode_mask(bytes, size, instances)
            })?;
        }
        Ok(frame.has_mask)
    }

    /// Reads a frame's ground truth into a buffer: JSON as it was written. Returns false when there
    /// is none.
    ///
    /// # Errors
    /// When there is no such frame, or the file cannot be read or has more
    /// than 16 MiB.
    pub fn read_truth(&self, index: usize, buffer: &mut Vec<u8>) -> Result<bool, Error> {
        let frame = self.frame(index)?;
        buffer.clear();
        if frame.has_truth {
            read_file(&self.path(frame, TRUTH_SUFFIX), MAX_TRUTH_BYTES, buffer)?;
        }
        Ok(frame.has_truth)
    }

    fn frame(&self, index: usize) -> Result<&FrameFiles, Error> {
        let (what, n) = ("frame", self.frames.len());
        let frame = self.frames.get(index);
        frame.ok_or(Error::NoSuch { what, index, n })
    }

    fn path(&self, frame: &FrameFiles, suffix: &str) -> PathBuf {
        self.folder.join(frame.stem.clone() + suffix)
    }
}

/// Reads and parses a file; an error names the file.
fn read_with<T>(
    path: &Path,
    limit: u64,
    buffer: &mut Vec<u8>,
    parse: impl FnOnce(&[u8]) -> Result<T, ContentError>,
) -> Result<T, Error> {
    read_file(path, limit, buffer)?;
    parse(buffer).map_err(Error::content(path))
}

#[cfg(test)]
pub(crate) mod test_flat_jpeg;
#[cfg(test)]
mod tests;
