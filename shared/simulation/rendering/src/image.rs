//! What a render gives.

use crate::pixel_block::LitPixel;
use geometry::PinholeCamera;

/// Value of a channel of [`Image::color`] that stands for a fully lit white.
/// Values up to 65 535 are kept, so that exposure can be chosen afterwards.
pub const LINEAR_ONE: f32 = 8192.0;

/// How the surface in a pixel sends light back.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Reflection {
    /// Outward unit normal, camera frame, times 127.
    pub normal: [i8; 3],
    /// Cosine between normal and direction to the camera, times 255.
    pub cos_incidence: u8,
    /// Share of infrared light that is scattered back, times 255.
    pub infrared: u8,
    /// Share of mirror-like reflection, times 255.
    pub specular: u8,
}

/// Planes of a rendered image, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    camera: PinholeCamera,
    pub(crate) depth_m: Vec<f32>,
    pub(crate) instance: Vec<u16>,
    pub(crate) color: Vec<[u16; 3]>,
    pub(crate) reflection: Vec<Reflection>,
}

impl Image {
    /// An image of nothing; `camera` is valid.
    pub(crate) fn new(camera: PinholeCamera) -> Self {
        let n_pixels = camera.n_pixels();
        Self {
            camera,
            depth_m: vec![f32::INFINITY; n_pixels],
            instance: vec![0; n_pixels],
            color: vec![[0; 3]; n_pixels],
            reflection: vec![Reflection::default(); n_pixels],
        }
    }

    /// The camera the image is seen with.
    pub fn camera(&self) -> &PinholeCamera {
        &self.camera
    }

    /// Depth along the optical axis, metres; infinite where nothing is.
    pub fn depth_m(&self) -> &[f32] {
        &self.depth_m
    }

    /// [`crate::Instance::id`] of what is seen; 0 where nothing is.
    pub fn instance(&self) -> &[u16] {
        &self.instance
    }

    /// Linear sRGB, [`LINEAR_ONE`] for white.
    pub fn color(&self) -> &[[u16; 3]] {
        &self.color
    }

    /// How the surfaces send light back; zero where nothing is.
    pub fn reflection(&self) -> &[Reflection] {
        &self.reflection
    }

    /// Counts the pixels of each instance: `counts[id]` becomes the number of
    /// pixels with that id. Ids beyond the slice are not counted.
    pub fn count_pixels(&self, counts: &mut [u32]) {
        counts.fill(0);
        for &id in &self.instance {
            if let Some(count) = counts.get_mut(usize::from(id)) {
                *count += 1;
            }
        }
    }

    /// Takes over a pixel.
    #[inline]
    pub(crate) fn set(&mut self, pixel: usize, lit: &LitPixel) {
        self.depth_m[pixel] = lit.depth_m;
        self.instance[pixel] = lit.instance;
        self.color[pixel] = lit.color;
        self.reflection[pixel] = lit.reflection;
    }

    /// Clears pixels.
    pub(crate) fn clear_span(&mut self, span: std::ops::Range<usize>) {
        self.depth_m[span.clone()].fill(f32::INFINITY);
        self.instance[span.clone()].fill(0);
        self.color[span.clone()].fill([0; 3]);
        self.reflection[span].fill(Reflection::default());
    }

    /// Takes over the pixels of `columns` in `row` from an image of the same size.
    pub(crate) fn copy_span(&mut self, from: &Self, span: std::ops::Range<usize>) {
        self.depth_m[span.clone()].copy_from_slice(&from.depth_m[span.clone()]);
        self.instance[span.clone()].copy_from_slice(&from.instance[span.clone()]);
        self.color[span.clone()].copy_from_slice(&from.color[span.clone()]);
        self.reflection[span.clone()].copy_from_slice(&from.reflection[span]);
    }
}
