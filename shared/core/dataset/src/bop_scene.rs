//! Scene in the format of the BOP benchmark (Hodaň et al., "BOP: Benchmark for 6D Object Pose
//! Estimation", ECCV 2018): `scene_camera.json`, `scene_gt.json`, `scene_gt_info.json`, `rgb/`,
//! `depth/`, `mask_visib/`, and the models of the objects as PLY.
//!
//! Files are in millimetres, what is read and written is in metres.

mod annotation;
mod error;
mod writer;

pub use annotation::{BopImage, BopObject};
pub use error::Error;
pub use writer::{BopPixels, BopSceneWriter, write_model};

use crate::image_error::ImageError;
use crate::mesh::Mesh;
use crate::ply;
use crate::png_image::{PixelKind, PngImage};
use annotation::{CameraEntry, ObjectEntry, VisibilityEntry};
use file_access::read_file;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Greatest size of a JSON file, bytes.
const JSON_MAX_BYTES: u64 = 1 << 27;
/// Greatest size of an image file, bytes.
const IMAGE_MAX_BYTES: u64 = 1 << 27;
/// Metres in a millimetre.
const M_PER_MM: f32 = 0.001;

/// Scene of a BOP data set: a folder such as `test/000001`.
#[derive(Debug, Clone)]
pub struct BopScene {
    folder: PathBuf,
    images: Vec<BopImage>,
}

impl BopScene {
    /// Reads the annotations of a scene. Images without ground truth have no objects; without
    /// `scene_gt_info.json` their visible shares are unknown.
    ///
    /// # Errors
    /// A file that is missing or not as in the format, an impossible camera or pose, or no images.
    pub fn open(folder: &Path) -> Result<Self, Error> {
        let cameras: BTreeMap<String, CameraEntry> = read_json(&folder.join("scene_camera.json"))?;
        let truth_path = folder.join("scene_gt.json");
        let mut truth: BTreeMap<String, Vec<ObjectEntry>> = read_json(&truth_path)?;
        let info_path = folder.join("scene_gt_info.json");
        let visibility: BTreeMap<String, Vec<VisibilityEntry>> = if info_path.exists() {
            read_json(&info_path)?
        } else {
            BTreeMap::new()
        };
        let mut images = Vec::new();
        for (key, camera) in cameras {
            let wrong = |rule: &'static str| Error::Annotation {
                folder: folder.to_owned(),
                image: key.clone(),
                rule,
            };
            let number = key.parse().map_err(|_| wrong("its key must be a number"))?;
            let objects = truth.remove(&key).unwrap_or_default();
            let visibility = visibility.get(&key).map(Vec::as_slice);
            let image = BopImage::new(number, &camera, &objects, visibility);
            images.push(image.map_err(wrong)?);
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

    /// Folder of the scene.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Images of the scene in the order of their numbers, at least one.
    pub fn images(&self) -> &[BopImage] {
        &self.images
    }

    /// Reads the depth of an image by its index, metres, row-major; 0 where nothing was measured.
    /// Returns width and height. The buffer's memory is reused.
    ///
    /// # Errors
    /// When there is no such image, or its file `depth/NNNNNN.png` is missing, damaged, or a TIFF.
    pub fn read_depth(&self, index: usize, depth_m: &mut Vec<f32>) -> Result<(u32, u32), Error> {
        let image = self.image(index)?;
        let path = self.folder.join(format!("depth/{:06}.png", image.number));
        let tiff = ["tif", "tiff"].map(|extension| path.with_extension(extension));
        if let Some(tiff) = tiff
            .into_iter()
            .find(|tiff| !path.exists() && tiff.exists())
        {
            return Err(Error::DepthFormat(tiff));
        }
        let (bytes, mut values) = (read_image(&path)?, Vec::new());
        let size = decoded(&path, PngImage::open(&bytes, PixelKind::Depth), |png| {
            png.decode_u16(&mut values)
        })?;
        let metres = image.depth_scale_mm as f32 * M_PER_MM;
        depth_m.clear();
        depth_m.extend(values.iter().map(|&value| f32::from(value) * metres));
        Ok(size)
    }

    /// Reads the colours of an image by its index, three bytes a pixel, row-major. Returns width and
    /// height; `None` when the scene has no file `rgb/NNNNNN.png`.
    ///
    /// # Errors
    /// When there is no such image, or its file is damaged.
    pub fn read_color(
        &self,
        index: usize,
        colors: &mut Vec<u8>,
    ) -> Result<Option<(u32, u32)>, Error> {
        let image = self.image(index)?;
        let path = self.folder.join(format!("rgb/{:06}.png", image.number));
        if !path.exists() {
            return Ok(None);
        }
        let bytes = read_image(&path)?;
        let opened = PngImage::open(&bytes, PixelKind::Color);
        decoded(&path, opened, |png| png.decode_u8(colors)).map(Some)
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
