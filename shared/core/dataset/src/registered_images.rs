//! Registered RGB-D images: a folder of colour and depth images of one camera, without poses.
//!
//! | files | content |
//! |---|---|
//! | `NAME-depth.png` | 16 bits a pixel; 0 and 65535 are no depth |
//! | `NAME-color.png`, `.jpg` or `.jpeg` | of the same size, 24 bits a pixel |
//!
//! `-` may also be `_` or `.`, and `color` also `colour` or `rgb`. The other layout has the
//! subfolders `depth` and `rgb` (or `color`, `colour`) with images of equal names, or with
//! timestamps in seconds as names, as TUM RGB-D (Sturm et al. 2012) has them.
//!
//! Intrinsics are those of the first of these files that exists, in the folder itself:
//!
//! | file | content |
//! |---|---|
//! | `camera_params.json`, `camera.json`, `camera_info.json`, `intrinsic.json`, `intrinsics.json`, `camera_intrinsic.json` | see [`parse_intrinsics_json`] |
//! | `camera-intrinsics.txt` | 3 x 3 matrix, pixels |
//!
//! Each pixel of a depth image must show what the same pixel of its colour image shows. Lens
//! distortion is not corrected.

mod image_pair;
mod intrinsics_json;
mod timestamp;

pub use crate::rgbd_sequence::Scratch;
pub use intrinsics_json::{DepthCamera, IntrinsicsError, parse_intrinsics_json};

use crate::Error;
use crate::rgbd_sequence::{
    BackProjection, INTRINSICS_NAME as MATRIX_NAME, MAX_IMAGE_BYTES, MAX_TEXT_BYTES, decode_color,
    decode_depth, depth_image_size, is_pose_name, parse_intrinsics,
};
use file_access::read_file;
use geometry::PinholeCamera;
use image_pair::{COLOR_FOLDERS, DEPTH_FOLDER, ImagePair, PairList, image_role, list_pairs};
use point_cloud::Point;
use std::path::Path;

/// Names of files with intrinsics in JSON, the preferred first.
const JSON_NAMES: [&str; 6] = [
    "camera_params.json",
    "camera.json",
    "camera_info.json",
    "intrinsic.json",
    "intrinsics.json",
    "camera_intrinsic.json",
];

/// Open folder of registered images: its pairs and its camera.
#[derive(Debug)]
pub struct RegisteredImages {
    pairs: Vec<ImagePair>,
    n_unpaired: usize,
    camera: PinholeCamera,
    depth_unit_mm: f64,
    projection: BackProjection,
}

impl RegisteredImages {
    /// Opens a folder: pairs its images in natural order of their names and reads the
    /// intrinsics. All images must have the size of the first usable depth image.
    ///
    /// # Errors
    /// When there are no images, an image lacks its companion or has two, no depth image is
    /// usable, or the intrinsics are missing or wrong.
    pub fn open(folder: &Path) -> Result<Self, Error> {
        let PairList { pairs, n_unpaired } = list_pairs(folder)?;
        let mut file = Vec::new();
        let size = image_size(&pairs, &mut file)?;
        let DepthCamera {
            camera,
            depth_unit_mm,
        } = read_intrinsics(folder, size, &mut file)?;
        Ok(Self {
            pairs,
            n_unpaired,
            camera,
            depth_unit_mm,
            projection: BackProjection::with_depth_unit(&camera, depth_unit_mm),
        })
    }

    /// Number of frames, at least 1.
    pub fn n_frames(&self) -> usize {
        self.pairs.len()
    }

    /// Number of images without an image of the other kind at nearly the same time; 0 unless the
    /// names are timestamps.
    pub fn n_unpaired(&self) -> usize {
        self.n_unpaired
    }

    /// Name of a frame, such as `000123` of `000123-depth.png`; `None` after the last frame.
    pub fn name(&self, index: usize) -> Option<&str> {
        self.pairs.get(index).map(|pair| pair.name.as_str())
    }

    /// Intrinsics of both images.
    pub fn camera(&self) -> &PinholeCamera {
        &self.camera
    }

    /// Unit of the depth images, millimetres.
    pub fn depth_unit_mm(&self) -> f64 {
        self.depth_unit_mm
    }

    /// Decodes a frame to organised points, camera frame, metres.
    ///
    /// *Shape*: `out` has the camera's `n_pixels()`, row by row. After an error
    /// its content is unspecified.
    /// *Allocation*: what the image decoders need for themselves.
    ///
    /// # Errors
    /// When there is no such frame, `out` has another length, or an image cannot
    /// be read, is damaged or has another size than the first depth image.
    pub fn fill(
        &self,
        index: usize,
        scratch: &mut Scratch,
        out: &mut [Point],
    ) -> Result<(), Error> {
        let (what, n) = ("frame", self.pairs.len());
        let pair = self.pairs.get(index);
        let pair = pair.ok_or(Error::NoSuch { what, index, n })?;
        let (found, needed) = (out.len(), self.camera.n_pixels());
        if found != needed {
            return Err(Error::OutputLength { found, needed });
        }
        let size = (self.camera.width, self.camera.height);
        let Scratch {
            file,
            depth,
            color_rgb,
        } = scratch;
        read_file(&pair.depth, MAX_IMAGE_BYTES, file)?;
        decode_depth(file, size, depth).map_err(Error::image(&pair.depth))?;
        read_file(&pair.color, MAX_IMAGE_BYTES, file)?;
        *color_rgb = decode_color(file, size).map_err(Error::image(&pair.color))?;
        let projected = self.projection.fill(depth, color_rgb, out);
        projected.map_err(Error::image(&pair.depth))
    }
}

/// True if the entries of a folder, which holds no other recording, are those of registered
/// images.
pub(crate) fn has_images(names: &[String]) -> bool {
    let has = |wanted: &str| names.iter().any(|name| name == wanted);
    let has_subfolders = has(DEPTH_FOLDER) && COLOR_FOLDERS.into_iter().any(has);
    has_subfolders || names.iter().any(|name| image_role(name).is_some())
}

/// True if frames named as those of an RGB-D sequence are registered images: they have neither
/// the sequence's matrix nor poses, but intrinsics in JSON.
pub(crate) fn replaces_sequence(names: &[String]) -> bool {
    let is_of_sequence = |name: &String| name == MATRIX_NAME || is_pose_name(name);
    let is_json = |name: &String| JSON_NAMES.contains(&name.as_str());
    !names.iter().any(is_of_sequence) && names.iter().any(is_json)
}

/// Size of the first usable depth image; if there is none, the error of the first.
fn image_size(pairs: &[ImagePair], file: &mut Vec<u8>) -> Result<(u32, u32), Error> {
    let mut first_error = None;
    for ImagePair { depth, .. } in pairs {
        let size = read_file(depth, MAX_IMAGE_BYTES, file).map_err(Error::from);
        match size.and_then(|()| depth_image_size(file).map_err(Error::image(depth))) {
            Ok(size) => return Ok(size),
            Err(error) => first_error = first_error.or(Some(error)),
        }
    }
    Err(first_error.unwrap_or(Error::NoSuch {
        what: "frame",
        index: 0,
        n: 0,
    }))
}

/// Reads the preferred file with intrinsics for images of this size.
fn read_intrinsics(
    folder: &Path,
    size: (u32, u32),
    file: &mut Vec<u8>,
) -> Result<DepthCamera, Error> {
    let existing = |name: &&str| folder.join(name).exists();
    if let Some(name) = JSON_NAMES.into_iter().find(existing) {
        let path = folder.join(name);
        read_file(&path, MAX_TEXT_BYTES, file)?;
        return parse_intrinsics_json(file, size).map_err(Error::intrinsics(&path));
    }
    let path = folder.join(MATRIX_NAME);
    if !path.exists() {
        let folder = folder.to_owned();
        return Err(Error::NoIntrinsics { folder, size });
    }
    read_file(&path, MAX_TEXT_BYTES, file)?;
    let camera = parse_intrinsics(file, size).map_err(IntrinsicsError::Matrix);
    Ok(DepthCamera {
        camera: camera.map_err(Error::intrinsics(&path))?,
        depth_unit_mm: 1.0,
    })
}

#[cfg(test)]
mod tests;
