//! Writer of a scene in the BOP format.

use super::annotation::{BopImage, CameraEntry, ObjectEntry, VisibilityEntry};
use super::{Error, M_PER_MM};
use crate::mesh::MeshView;
use crate::ply::{self, Encoding};
use crate::png_image::{PixelKind, encode, to_big_endian_samples};
use crate::{create_folder, write_atomic};
use point_cloud::Point;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Pixels of a BOP image, row-major.
#[derive(Debug, Clone, Copy)]
pub struct BopPixels<'a> {
    /// Width and height, pixels.
    pub size: (u32, u32),
    /// Depth, metres; what is not finite or not positive was not measured.
    pub depth_m: &'a [f32],
    /// Colours, three bytes a pixel; empty to write none.
    pub colors: &'a [u8],
    /// Visible pixels of each object, in the order of the image's objects.
    pub visible_masks: &'a [Vec<bool>],
}

/// Writer of a scene: images first, then their annotations.
#[derive(Debug)]
pub struct BopSceneWriter {
    folder: PathBuf,
    cameras: BTreeMap<u32, CameraEntry>,
    truth: BTreeMap<u32, Vec<ObjectEntry>>,
    visibility: BTreeMap<u32, Vec<VisibilityEntry>>,
}

impl BopSceneWriter {
    /// Creates the folder of a scene.
    ///
    /// # Errors
    /// A folder that cannot be created.
    pub fn create(folder: &Path) -> Result<Self, Error> {
        for part in ["rgb", "depth", "mask_visib"] {
            create_folder(&folder.join(part))?;
        }
        Ok(Self {
            folder: folder.to_owned(),
            cameras: BTreeMap::new(),
            truth: BTreeMap::new(),
            visibility: BTreeMap::new(),
        })
    }

    /// Writes the files of an image and keeps its annotation. Depth is rounded to its unit.
    ///
    /// # Errors
    /// Pixels that do not have the size of the image, or a file that cannot be written.
    pub fn write_image(&mut self, image: &BopImage, pixels: &BopPixels<'_>) -> Result<(), Error> {
        let unit_m = image.depth_scale_mm as f32 * M_PER_MM;
        // What is not measured becomes 0, as in the format.
        let units: Vec<u16> = pixels
            .depth_m
            .iter()
            .map(|depth_m| (depth_m / unit_m).round() as u16)
            .collect();
        let (mut samples, number) = (Vec::new(), image.number);
        to_big_endian_samples(&units, &mut samples);
        let depth = format!("depth/{number:06}.png");
        self.write_png(&depth, PixelKind::Depth, pixels.size, &samples)?;
        if !pixels.colors.is_empty() {
            let color = format!("rgb/{number:06}.png");
            self.write_png(&color, PixelKind::Color, pixels.size, pixels.colors)?;
        }
        for (object, mask) in pixels.visible_masks.iter().enumerate() {
            let mask: Vec<u8> = mask
                .iter()
                .map(|&is_seen| 255 * u8::from(is_seen))
                .collect();
            let name = format!("mask_visib/{number:06}_{object:06}.png");
            self.write_png(&name, PixelKind::Silhouette, pixels.size, &mask)?;
        }
        self.cameras.insert(number, CameraEntry::of(image));
        let objects = image.objects.iter();
        self.truth
            .insert(number, objects.clone().map(ObjectEntry::of).collect());
        if let Some(visibility) = objects.map(VisibilityEntry::of).collect() {
            self.visibility.insert(number, visibility);
        }
        Ok(())
    }

    /// Writes the annotations of all images.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn finish(self) -> Result<(), Error> {
        write_json(&self.folder.join("scene_camera.json"), &self.cameras)?;
        write_json(&self.folder.join("scene_gt.json"), &self.truth)?;
        write_json(&self.folder.join("scene_gt_info.json"), &self.visibility)
    }

    fn write_png(
        &self,
        name: &str,
        kind: PixelKind,
        size: (u32, u32),
        samples: &[u8],
    ) -> Result<(), Error> {
        let (path, mut file) = (self.folder.join(name), Vec::new());
        match encode(kind, size, samples, &mut file) {
            Ok(()) => Ok(write_atomic(&path, &file)?),
            Err(source) => Err(Error::Image { path, source }),
        }
    }
}

/// Writes the model of an object, given in metres, into a folder of models.
///
/// # Errors
/// A mesh that PLY cannot hold, or a file that cannot be written.
pub fn write_model(models: &Path, model: u32, mesh: MeshView<'_>) -> Result<(), Error> {
    create_folder(models)?;
    let path = models.join(format!("obj_{model:06}.ply"));
    let in_mm = |point: &Point| Point {
        x: point.x / M_PER_MM,
        y: point.y / M_PER_MM,
        z: point.z / M_PER_MM,
        color: point.color,
    };
    let vertices: Vec<Point> = mesh.vertices.iter().map(in_mm).collect();
    let view = MeshView {
        vertices: &vertices,
        triangles: mesh.triangles,
    };
    match ply::write(view, Encoding::BinaryLittleEndian) {
        Ok(file) => Ok(write_atomic(&path, &file)?),
        Err(source) => Err(Error::Model { path, source }),
    }
}

fn write_json(path: &Path, value: &impl Serialize) -> Result<(), Error> {
    let json = serde_json::to_vec_pretty(value).map_err(|source| Error::Json {
        path: path.to_owned(),
        source,
    })?;
    Ok(write_atomic(path, &json)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bop_scene::{BopObject, BopScene};
    use geometry::RigidTransform;
    use nalgebra::{Translation3, UnitQuaternion};

    /// Image of two objects.
    fn image(number: u32, camera_from_world: Option<RigidTransform>) -> BopImage {
        let object = |model, x, share| BopObject {
            model,
            camera_from_object: pose(x, 0.8),
            visible_share: Some(share),
        };
        BopImage {
            number,
            focal_px: [550.5, 540.0],
            principal_px: [2.0, 1.5],
            depth_scale_mm: 0.1,
            camera_from_world,
            objects: vec![object(2, 0.1, 0.25), object(1, -0.3, 1.0)],
        }
    }

    fn pose(x: f64, z: f64) -> RigidTransform {
        RigidTransform::from_parts(
            Translation3::new(x, -0.2, z),
            UnitQuaternion::from_euler_angles(0.3, -1.2, x),
        )
    }

    #[test]
    fn written_scene_is_read_back() {
        let folder = tempfile::tempdir().unwrap();
        let depth_m = [0.5, f32::NAN, 0.0, -1.0, 1.23456, 2.0];
        let masks = [vec![true, false, false, false, false, true], vec![false; 6]];
        let colors: Vec<u8> = (0..18).collect();
        let pixels = |colors| BopPixels {
            size: (3, 2),
            depth_m: &depth_m,
            colors,
            visible_masks: &masks,
        };
        let written = [image(0, Some(pose(0.7, 0.1))), image(3, None)];
        let mut writer = BopSceneWriter::create(folder.path()).unwrap();
        writer.write_image(&written[0], &pixels(&colors)).unwrap();
        writer.write_image(&written[1], &pixels(&[])).unwrap();
        writer.finish().unwrap();
        let scene = BopScene::open(folder.path()).unwrap();
        assert_eq!(scene.images().len(), 2);
        for (read, written) in scene.images().iter().zip(&written) {
            assert_eq!(read.number, written.number);
            assert_eq!(
                (read.focal_px, read.principal_px),
                ([550.5, 540.0], [2.0, 1.5])
            );
            assert_eq!(
                read.camera_from_world.is_some(),
                written.camera_from_world.is_some()
            );
            for (read, written) in read.objects.iter().zip(&written.objects) {
                assert_eq!(
                    (read.model, read.visible_share),
                    (written.model, written.visible_share)
                );
                let off = read.camera_from_object.inverse() * written.camera_from_object;
                assert!(off.translation.vector.norm() < 1e-9 && off.rotation.angle() < 1e-7);
            }
        }
        let (mut read_m, mut mask, mut read_colors) = (Vec::new(), Vec::new(), Vec::new());
        scene.read_depth(0, &mut read_m).unwrap();
        for (read, expected) in read_m.iter().zip([0.5, 0.0, 0.0, 0.0, 1.2346, 2.0]) {
            assert!((read - expected).abs() < 1e-6, "{read} for {expected}");
        }
        scene.read_visible_mask(0, 0, &mut mask).unwrap();
        assert_eq!(mask, masks[0]);
        assert_eq!(scene.read_color(0, &mut read_colors).unwrap(), Some((3, 2)));
        assert_eq!(read_colors, colors);
        assert_eq!(scene.read_color(1, &mut read_colors).unwrap(), None);
    }
}
