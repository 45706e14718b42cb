//! Depth history: a depth image of some frames ago, against which motion is measured.

use crate::affine_form::AffineForm;
use crate::samples::{RayGrid, Samples};
use geometry::RigidTransform;
use nalgebra::Point3;
use sensor_noise::DepthNoise;

/// Least age of the image, frames; it is replaced at twice this age. Chosen.
const AGE_MIN: u16 = 10;

/// Least distance between a point and the surface that was seen behind its place, metres, so that
/// an error of the camera pose moves nothing. Chosen.
const FREE_MIN_M: f32 = 0.06;

/// Tolerance of depth, sigmas of the depth noise.
const NOISE_SIGMAS: f32 = 3.0;

/// Depth history of a subsampled image.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct DepthHistory {
    /// Image of [`AGE_MIN`] to twice as many frames ago.
    old: DepthImage,
    /// Younger image, which replaces the old one.
    young: DepthImage,
    /// Age of the younger image, frames.
    young_age: u16,
}

/// Subsampled depth image with its camera pose.
#[derive(Debug, Clone, Default, PartialEq)]
struct DepthImage {
    /// Depth of each sample, metres; 0 for one without.
    depth_m: Vec<f32>,
    rays: RayGrid,
    world_from_camera: RigidTransform,
}

/// Motion of a place since the image of the history.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Motion {
    /// Something was seen behind the place: what is there now has arrived.
    Arrived,
    /// A surface was seen at the place or before it.
    Still,
    /// The place was out of view or without depth.
    Unknown,
}

impl DepthHistory {
    /// Copy another history and keep the memory of this one.
    pub(crate) fn assign(&mut self, other: &Self) {
        for (own, other) in [(&mut self.old, &other.old), (&mut self.young, &other.young)] {
            own.depth_m.clone_from(&other.depth_m);
            own.rays = other.rays;
            own.world_from_camera = other.world_from_camera;
        }
        self.young_age = other.young_age;
    }

    /// Forget all images.
    pub(crate) fn clear(&mut self) {
        for image in [&mut self.old, &mut self.young] {
            let mut depth_m = std::mem::take(&mut image.depth_m);
            depth_m.clear();
            *image = DepthImage {
                depth_m,
                ..DepthImage::default()
            };
        }
        self.young_age = 0;
    }

    /// Follow the history of the previous frame, and add this frame when it is due.
    pub(crate) fn advance(
        &mut self,
        previous: &Self,
        samples: &Samples,
        world_from_camera: &RigidTransform,
    ) {
        self.assign(previous);
        self.young_age = self.young_age.saturating_add(1);
        let has_size = self.young.depth_m.len() == samples.len();
        if has_size && self.young_age < AGE_MIN {
            return;
        }
        if has_size {
            std::mem::swap(&mut self.old, &mut self.young);
        }
        let image = &mut self.young;
        image.depth_m.clear();
        image
            .depth_m
            .extend((0..samples.len()).map(|sample| samples.depth(sample)));
        image.rays = *samples.rays();
        image.world_from_camera = *world_from_camera;
        self.young_age = 0;
    }

    /// View of the history from a frame; `None` without an image.
    pub(crate) fn view(
        &self,
        world_from_camera: &RigidTransform,
        noise: DepthNoise,
    ) -> Option<MotionView<'_>> {
        let image = &self.old;
        let old_from_camera = image.world_from_camera.inverse() * world_from_camera;
        (!image.depth_m.is_empty()).then(|| MotionView {
            image,
            axes: AffineForm::coordinates_of(&old_from_camera),
            noise,
        })
    }
}

/// Motion test of the points of a frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MotionView<'a> {
    image: &'a DepthImage,
    /// Coordinates in the frame of the old camera.
    axes: [AffineForm; 3],
    noise: DepthNoise,
}

impl MotionView<'_> {
    /// Motion of a point of the frame, camera frame.
    pub(crate) fn motion(&self, point: &Point3<f64>) -> Motion {
        let [x, y, z] = point.coords.map(|value| value as f32).into();
        let [x, y, z] = self.axes.map(|axis| axis.at(x, y, z));
        let Some(sample) = self.image.rays.sample_at(x, y, z) else {
            return Motion::Unknown;
        };
        match self.image.depth_m.get(sample) {
            Some(&seen) if seen > 0.0 => {
                let margin_m = FREE_MIN_M + NOISE_SIGMAS * self.noise.sigma_m(seen);
                if seen > z + margin_m {
                    Motion::Arrived
                } else {
                    Motion::Still
                }
            }
            _ => Motion::Unknown,
        }
    }
}
