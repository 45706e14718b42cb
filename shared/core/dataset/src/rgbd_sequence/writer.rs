//! Writer of RGB-D sequences.

use super::frame_files::{
    COLOR_PNG_SUFFIX, DEPTH_SUFFIX, MASK_SUFFIX, POSE_SUFFIX, TRUTH_SUFFIX, is_frame_name,
};
use super::{
    GRAVITY_NAME, INTRINSICS_NAME, MAX_IMAGE_BYTES, MAX_TRUTH_BYTES, parse_gravity,
    parse_intrinsics, parse_pose,
};
use crate::png_image::{PixelKind, encode, to_big_endian_samples};
use crate::{ContentError, Error};
use file_access::{FileError, file_names};
use file_access::{create_folder, write_atomic};
use geometry::{PinholeCamera, RigidTransform};
use nalgebra::UnitVector3;
use std::path::{Path, PathBuf};

/// Writer of an RGB-D sequence, from `frame-000000` on.
///
/// Each file gets its name when it is complete, and a frame's depth image is
/// its last file: a sequence whose writer was killed can be played up to there.
#[derive(Debug)]
pub struct SequenceWriter {
    folder: PathBuf,
    size: (u32, u32),
    n_frames: usize,
    /// True if the last frame failed, so that some of its files may exist.
    has_leftovers: bool,
    /// Image bytes before and after compression, buffers reused.
    samples: Vec<u8>,
    file: Vec<u8>,
}

/// Content of one frame to be written. The slices hold one value per pixel, row-major.
#[derive(Debug, Clone, Copy)]
pub struct FrameView<'a> {
    /// Colour image: red, green, blue of each pixel.
    pub color: &'a [u8],
    /// Depth image, millimetres; 0 is no depth.
    pub depth_mm: &'a [u16],
    /// Number of each pixel's object, if known; 0 is background.
    pub instances: Option<&'a [u16]>,
    /// Pose of the camera, if known.
    pub world_from_camera: Option<RigidTransform>,
    /// Ground truth of the scene as JSON, if known; written unchanged.
    pub truth: Option<&'a [u8]>,
}

impl SequenceWriter {
    /// Starts a sequence in a folder, which is created if necessary.
    ///
    /// *Frame*: `gravity_in_world` points downwards.
    ///
    /// # Errors
    /// When the camera or the direction cannot be read again, or the folder
    /// cannot be made or already holds a sequence or parts of one.
    pub fn create(
        folder: &Path,
        camera: &PinholeCamera,
        gravity_in_world: Option<UnitVector3<f64>>,
    ) -> Result<Self, Error> {
        create_folder(folder)?;
        let is_part =
            |name: &str| is_frame_name(name) || name == INTRINSICS_NAME || name == GRAVITY_NAME;
        if !file_names(folder, is_part)?.is_empty() {
            return Err(Error::SequenceExists(folder.to_owned()));
        }
        let size = (camera.width, camera.height);
        let (fx, fy, cx, cy) = (camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px);
        if let Some(down) = gravity_in_world {
            write_text(
                &folder.join(GRAVITY_NAME),
                1,
                down.as_slice(),
                parse_gravity,
            )?;
        }
        let matrix = [fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0];
        let parse = |bytes: &[u8]| parse_intrinsics(bytes, size);
        write_text(&folder.join(INTRINSICS_NAME), 3, &matrix, parse)?;
        Ok(Self {
            folder: folder.to_owned(),
            size,
            n_frames: 0,
            has_leftovers: false,
            samples: Vec::new(),
            file: Vec::new(),
        })
    }

    /// Number of frames written so far.
    pub fn n_frames(&self) -> usize {
        self.n_frames
    }

    /// Writes the next frame. After an error it can be retried or left out.
    ///
    /// *Allocation*: what the image encoder needs for itself.
    /// *Speed*: benchmark `write_frame`.
    ///
    /// # Errors
    /// When a slice does not fill the image, the pose cannot be read again,
    /// or a file cannot be written or would exceed the reading limits.
    pub fn write(&mut self, frame: &FrameView<'_>) -> Result<(), Error> {
        self.check(frame)?;
        let paths = self.paths();
        if std::mem::replace(&mut self.has_leftovers, true) {
            // A missing file is the desired state.
            for path in &paths {
                drop(std::fs::remove_file(path));
            }
        }
        self.write_files(frame, &paths)?;
        self.has_leftovers = false;
        self.n_frames += 1;
        Ok(())
    }

    /// Paths of the next frame's files in writing order.
    fn paths(&self) -> [PathBuf; 5] {
        let stem = format!("frame-{:06}", self.n_frames);
        [
            MASK_SUFFIX,
            TRUTH_SUFFIX,
            POSE_SUFFIX,
            COLOR_PNG_SUFFIX,
            DEPTH_SUFFIX,
        ]
        .map(|suffix| self.folder.join(stem.clone() + suffix))
    }

    fn write_files(&mut self, frame: &FrameView<'_>, paths: &[PathBuf; 5]) -> Result<(), Error> {
        let [mask, truth, pose, color, depth] = paths;
        if let Some(instances) = frame.instances {
            to_big_endian_samples(instances, &mut self.samples);
            self.write_image(mask, PixelKind::Instance, None)?;
        }
        if let Some(content) = frame.truth {
            write_bounded(truth, content, MAX_TRUTH_BYTES)?;
        }
        if let Some(world_from_camera) = frame.world_from_camera {
            let columns = world_from_camera.to_homogeneous();
            write_text(pose, 4, columns.transpose().as_slice(), parse_pose)?;
        }
        self.write_image(color, PixelKind::Color, Some(frame.color))?;
        to_big_endian_samples(frame.depth_mm, &mut self.samples);
        self.write_image(depth, PixelKind::Depth, None)
    }

    fn check(&self, frame: &FrameView<'_>) -> Result<(), Error> {
        let n_pixels = self.size.0 as usize * self.size.1 as usize;
        for (what, found, needed) in [
            ("colour bytes", frame.color.len(), 3 * n_pixels),
            ("depths", frame.depth_mm.len(), n_pixels),
            (
                "instances",
                frame.instances.map_or(n_pixels, <[u16]>::len),
                n_pixels,
            ),
        ] {
            if found != needed {
                return Err(Error::Length {
                    what,
                    found,
                    needed,
                });
            }
        }
        Ok(())
    }

    /// Writes an image from the given bytes, or from `samples`.
    fn write_image(
        &mut self,
        path: &Path,
        kind: PixelKind,
        bytes: Option<&[u8]>,
    ) -> Result<(), Error> {
        self.file.clear();
        let bytes = bytes.unwrap_or(&self.samples);
        encode(kind, self.size, bytes, &mut self.file)
            .map_err(|error| Error::content(path)(error.into()))?;
        write_bounded(path, &self.file, MAX_IMAGE_BYTES)
    }
}

/// Writes a matrix, given row-major, with enough digits for an exact round trip; fails if it
/// could not be parsed again.
fn write_text<T>(
    path: &Path,
    n_columns: usize,
    values: &[f64],
    parse: impl FnOnce(&[u8]) -> Result<T, ContentError>,
) -> Result<(), Error> {
    let row = |row: &[f64]| {
        let words: Vec<String> = row.iter().map(f64::to_string).collect();
        words.join(" ") + "\n"
    };
    let text: String = values.chunks(n_columns).map(row).collect();
    parse(text.as_bytes()).map_err(Error::content(path))?;
    Ok(write_atomic(path, text.as_bytes())?)
}

fn write_bounded(path: &Path, bytes: &[u8], limit: u64) -> Result<(), Error> {
    if bytes.len() as u64 > limit {
        let path = path.to_owned();
        return Err(FileError::TooLarge { path, limit }.into());
    }
    Ok(write_atomic(path, bytes)?)
}

#[cfg(test)]
mod tests;
