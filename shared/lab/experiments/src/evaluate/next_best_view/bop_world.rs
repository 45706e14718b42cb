//! World of a BOP scene: poses of its cameras and objects in one frame.
//!
//! The frame is that of the scene's own camera poses where all images have one. Otherwise it is
//! the frame of the first image's camera, and the other cameras follow from objects that are in
//! several images.

use dataset::bop_scene::{BopImage, BopObject};
use geometry::RigidTransform;
use nalgebra::Vector3;

/// Distance up to which two poses of a model in the world are those of one object, metres.
/// Chosen: above the error of annotations, below the distance of stacked cups.
const SAME_OBJECT_M: f64 = 0.012;

/// Object of the scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BopWorldObject {
    /// Number of the model, as in the name of its file.
    pub(super) model: u32,
    pub(super) world_from_object: RigidTransform,
}

/// Cameras and objects in one frame.
#[derive(Debug, Default)]
pub(super) struct BopWorld {
    pub(super) objects: Vec<BopWorldObject>,
    /// Pose of the camera of each image.
    pub(super) world_from_cameras: Vec<RigidTransform>,
    /// For each image the object of each entry of its ground truth, as an index.
    pub(super) objects_of_images: Vec<Vec<usize>>,
}

/// Pose of a camera that brings objects of its image to their places in the world.
struct CameraFit {
    world_from_camera: RigidTransform,
    n_matched: usize,
    /// Mean distance of the matched objects, metres.
    error_m: f64,
}

impl BopWorld {
    /// World of the images of a scene.
    ///
    /// # Errors
    /// The number of the image whose camera has no pose: no object that tells it without doubt.
    pub(super) fn of(images: &[BopImage]) -> Result<Self, u32> {
        let n = images.len();
        let mut world = Self {
            world_from_cameras: vec![RigidTransform::identity(); n],
            objects_of_images: vec![Vec::new(); n],
            ..Self::default()
        };
        let given: Option<Vec<RigidTransform>> = images
            .iter()
            .map(|image| image.camera_from_world.map(|pose| pose.inverse()))
            .collect();
        if let Some(poses) = given {
            for (index, (image, pose)) in images.iter().zip(poses).enumerate() {
                world.add(index, image, pose);
            }
            return Ok(world);
        }
        let mut left: Vec<usize> = (0..n).collect();
        // The first image whose objects are known is the origin.
        while let Some(place) = left
            .iter()
            .position(|&i| world.fit(i, &images[i]).is_some())
        {
            let index = left.remove(place);
            if let Some(pose) = world.fit(index, &images[index]) {
                world.add(index, &images[index], pose);
            }
        }
        match left.first() {
            Some(&index) => Err(images[index].number),
            None => Ok(world),
        }
    }

    /// Pose of the camera of an image by the objects known so far; the first image is the world.
    fn fit(&self, index: usize, image: &BopImage) -> Option<RigidTransform> {
        if index == 0 {
            return Some(RigidTransform::identity());
        }
        let mut fits = Vec::new();
        for known in &self.objects {
            let same = |seen: &&BopObject| seen.model == known.model;
            for seen in image.objects.iter().filter(same) {
                let pose = known.world_from_object * seen.camera_from_object.inverse();
                fits.push(self.rated(pose, image));
            }
        }
        // With one match each, two poses are equally right.
        let is_certain = |fit: &CameraFit| fit.n_matched > 1 || fits.len() == 1;
        let best = fits.iter().max_by(|a, b| {
            let by_error = b.error_m.total_cmp(&a.error_m);
            a.n_matched.cmp(&b.n_matched).then(by_error)
        });
        best.filter(|fit| is_certain(fit))
            .map(|fit| fit.world_from_camera)
    }

    fn rated(&self, world_from_camera: RigidTransform, image: &BopImage) -> CameraFit {
        let distances = image.objects.iter().filter_map(|seen| {
            let place = world_from_camera * seen.camera_from_object;
            let nearest = self
                .distances_m(seen.model, &place)
                .map(|(_, away_m)| away_m);
            let nearest_m = nearest.fold(f64::INFINITY, f64::min);
            (nearest_m <= SAME_OBJECT_M).then_some(nearest_m)
        });
        let matched: Vec<f64> = distances.collect();
        CameraFit {
            world_from_camera,
            n_matched: matched.len(),
            error_m: matched.iter().sum::<f64>() / matched.len().max(1) as f64,
        }
    }

    /// Objects of a model: index, and distance from a place, metres.
    fn distances_m(
        &self,
        model: u32,
        place: &RigidTransform,
    ) -> impl Iterator<Item = (usize, f64)> {
        let place: Vector3<f64> = place.translation.vector;
        let objects = self.objects.iter().enumerate();
        objects
            .filter(move |(_, object)| object.model == model)
            .map(move |(index, object)| {
                (
                    index,
                    (object.world_from_object.translation.vector - place).norm(),
                )
            })
    }

    /// Adds an image: each object of its ground truth is the nearest one of the world that is
    /// near enough, or a new one.
    fn add(&mut self, index: usize, image: &BopImage, world_from_camera: RigidTransform) {
        self.world_from_cameras[index] = world_from_camera;
        let mut pairs = Vec::new();
        for (entry, seen) in image.objects.iter().enumerate() {
            let place = world_from_camera * seen.camera_from_object;
            let near = self.distances_m(seen.model, &place);
            let near = near.filter(|(_, away_m)| *away_m <= SAME_OBJECT_M);
            pairs.extend(near.map(|(object, away_m)| (away_m, entry, object)));
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut of_entries = vec![None; image.objects.len()];
        for (_, entry, object) in pairs {
            if of_entries[entry].is_none() && !of_entries.contains(&Some(object)) {
                of_entries[entry] = Some(object);
            }
        }
        let entries = image.objects.iter().zip(of_entries);
        self.objects_of_images[index] = entries
            .map(|(seen, object)| {
                object.unwrap_or_else(|| {
                    self.objects.push(BopWorldObject {
                        model: seen.model,
                        world_from_object: world_from_camera * seen.camera_from_object,
                    });
                    self.objects.len() - 1
                })
            })
            .collect();
    }
}

#[cfg(test)]
mod tests;
