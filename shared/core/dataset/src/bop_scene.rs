//! Scene in the format of the BOP benchmark (Hodaň et al., "BOP: Benchmark for 6D Object Pose
//! Estimation", ECCV 2018): `scene_camera.json`, `scene_gt.json`, `depth/`, `mask_visib/`, and the
//! models of the objects as PLY.
//!
//! Files are in millimetres, what is read is in metres. Colour images are not read.

mod annotation;

pub use annotation::{BopImage, BopObject};

use crate::bounded_file::{FileError, read_file};
use crate::image_error::ImageError;
use crate::mesh::Mesh;
use crate::ply;
use crate::png_image::{PixelKind, PngImage};
use annotation::{CameraEntry, ObjectEntry};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Greatest size of a JSON file, bytes.
const JSON_MAX_BYTES: u64 = 1 << 27;
/// Greatest size of an image file, bytes.
const IMAGE_MAX_BYTES: u64 = 1 << 27;
/// Metres in a millimetre.
const M_PER_MM: f32 = 0.001;

/// Error of reading a BOP scene.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Failed access to a file or folder.
    #[error("{0}")]
    File(#[from] FileError),
    /// Text that is not the expected JSON.
    #[error("the file {} is not as in the BOP format: {source}", .path.display())]
    Json {
        /// Path of the file.
        path: PathBuf,
        /// Error of the parser.
        source: serde_json::Error,
    },
    /// Image whose annotation breaks a rule.
    #[error("image {image} of the BOP scene {}: {rule}", .folder.display())]
    Annotation {
        /// Folder of the scene.
        folder: PathBuf,
        /// Number of the image, or its key where that is no number.
        image: String,
        /// Broken rule.
        rule: &'static str,
    },
    /// Scene without images.
    #[error("the BOP scene {} has no images; scene_camera.json lists none", .0.display())]
    NoImages(PathBuf),
    /// Image or object index out of range.
    #[error("there is no {what} {index} in the BOP scene; they count from 0 to {last}")]
    NoSuch {
        /// Kind of the requested thing.
        what: &'static str,
        /// Requested index.
        index: usize,
        /// Greatest index.
        last: usize,
    },
    /// Image file that cannot be decoded.
    #[error("the image {} is unusable: {source}", .path.display())]
    Image {
        /// Path of the image.
        path: PathBuf,
        /// Error of the decoder.
        source: ImageError,
    },
    /// Model file that cannot be read.
    #[error("the model {} is unusable: {source}", .path.display())]
    Model {
        /// Path of the model.
        path: PathBuf,
        /// Error of the reader.
        source: ply::Error,
    },
}

/// Scene of a BOP data set: a folder such as `test/000001`.
#[derive(Debug, Clone)]
pub struct BopScene {
    folder: PathBuf,
    images: Vec<BopImage>,
}

impl BopScene {
    /// Reads the annotations of a scene. Images without ground truth have no objects.
    ///
    /// # Errors
    /// A file that is missing or not as in the format, an impossible camera or pose, or no images.
    pub fn open(folder: &Path) -> Result<Self, Error> {
        let cameras: BTreeMap<String, CameraEntry> = read_json(&folder.join("scene_camera.json"))?;
        let truth_path = folder.join("scene_gt.json");
        let mut truth: BTreeMap<String, Vec<ObjectEntry>> = read_json(&truth_path)?;
        let mut images = Vec::new();
        for (key, camera) in cameras {
            let wrong = |rule: &'static str| Error::Annotation {
                folder: folder.to_owned(),
                image: key.clone(),
                rule,
            };
            let number = key.parse().map_err(|_| wrong("its key must be a number"))?;
            let objects = truth.remove(&key).unwrap_or_default();
            images.push(BopImage::new(number, &camera, &objects).map_err(wrong)?);
        }
        if let Some(image) = truth.into_keys().next() {
            let rule = "it has ground truth but no camera";
            let folder = folder.to_owned();
            return Err(Error::Annotation {
                folder,
                image,
                rule,
            });
        }
        if images.is_empty() {
            return Err(Error::NoImages(folder.to_owned()));
        }
        // The keys were in the order of text.
        images.sort_by_key(|image| image.number);
        Ok(Self {
            folder: folder.to_owned(),
            images,
        })
    }

    /// Images of the scene in the order of their numbers, at least one.
    pub fn images(&self) -> &[BopImage] {
        &self.images
    }

    /// Reads the depth of an image by its index, metres, row-major; 0 where nothing was measured.
    /// Returns width and height. The buffer's memory is reused.
    ///
    /// # Errors
    /// When there is no such image, or its file `depth/NNNNNN.png` is missing or damaged.
    pub fn read_depth(&self, index: usize, depth_m: &mut Vec<f32>) -> Result<(u32, u32), Error> {
        let image = self.image(index)?;
        let path = self.folder.join(format!("depth/{:06}.png", image.number));
        let (bytes, mut values) = (read_image(&path)?, Vec::new());
        let size = decoded(&path, PngImage::open(&bytes, PixelKind::Depth), |png| {
            png.decode_u16(&mut values)
        })?;
        let metres = image.depth_scale_mm as f32 * M_PER_MM;
        depth_m.clear();
        depth_m.extend(values.iter().map(|&value| f32::from(value) * metres));
        Ok(size)
    }

    /// Reads the visible part of an object in an image, by the indices of both: `true` where it is
    /// seen, row-major. Returns width and height.
    ///
    /// # Errors
    /// When there is no such image or object, or its file `mask_visib/NNNNNN_NNNNNN.png` is
    /// missing or damaged.
    pub fn read_visible_mask(
        &self,
        index: usize,
        object: usize,
        mask: &mut Vec<bool>,
    ) -> Result<(u32, u32), Error> {
        let image = self.image(index)?;
        if object >= image.objects.len() {
            return Err(no_such("object", object, image.objects.len()));
        }
        let name = format!("mask_visib/{:06}_{object:06}.png", image.number);
        let path = self.folder.join(name);
        let (bytes, mut values) = (read_image(&path)?, Vec::new());
        let size = decoded(
            &path,
            PngImage::open(&bytes, PixelKind::Silhouette),
            |png| png.decode_u8(&mut values),
        )?;
        mask.clear();
        mask.extend(values.iter().map(|&value| value != 0));
        Ok(size)
    }

    fn image(&self, index: usize) -> Result<&BopImage, Error> {
        let image = self.images.get(index);
        image.ok_or_else(|| no_such("image", index, self.images.len()))
    }
}

/// Reads the model of an object, `obj_NNNNNN.ply` of a folder of models, in metres.
///
/// # Errors
/// When the file cannot be read or is no mesh.
pub fn open_model(models: &Path, model: u32) -> Result<Mesh, Error> {
    let path = models.join(format!("obj_{model:06}.ply"));
    let mut mesh = match ply::open(&path) {
        Ok(mesh) => mesh,
        Err(source) => return Err(Error::Model { path, source }),
    };
    for vertex in &mut mesh.vertices {
        for coordinate in [&mut vertex.x, &mut vertex.y, &mut vertex.z] {
            *coordinate *= M_PER_MM;
        }
    }
    Ok(mesh)
}

fn no_such(what: &'static str, index: usize, n: usize) -> Error {
    let last = n.saturating_sub(1);
    Error::NoSuch { what, index, last }
}

fn read_json<T: serde::de::DeserializeOwned>(path: &Path) -> Result<T, Error> {
    let mut bytes = Vec::new();
    read_file(path, JSON_MAX_BYTES, &mut bytes)?;
    serde_json::from_slice(&bytes).map_err(|source| Error::Json {
        path: path.to_owned(),
        source,
    })
}

fn read_image(path: &Path) -> Result<Vec<u8>, Error> {
    let mut bytes = Vec::new();
    read_file(path, IMAGE_MAX_BYTES, &mut bytes)?;
    Ok(bytes)
}

/// Size of an opened image after decoding.
fn decoded<'a>(
    path: &Path,
    opened: Result<PngImage<'a>, ImageError>,
    decode: impl FnOnce(PngImage<'a>) -> Result<(), ImageError>,
) -> Result<(u32, u32), Error> {
    let size = opened.and_then(|png| {
        let size = png.size();
        decode(png).map(|()| size)
    });
    size.map_err(|source| Error::Image {
        path: path.to_owned(),
        source,
    })
}

#[cfg(test)]
mod tests;
