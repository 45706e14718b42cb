//! Rendered image: depth, instance ids, colour and reflection.

use crate::lit_pixel::LitPixel;
use crate::reflection::Reflection;
use geometry::PinholeCamera;

/// Planes of a rendered image, each row-major, one element per pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    camera: PinholeCamera,
    pub(crate) depth_m: Vec<f32>,
    pub(crate) instance: Vec<u16>,
    pub(crate) color: Vec<[u16; 3]>,
    pub(crate) reflection: Vec<Reflection>,
}

impl Image {
    /// Empty image of a camera; `camera` must be valid.
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

    /// Intrinsics of the camera.
    pub fn camera(&self) -> &PinholeCamera {
        &self.camera
    }

    /// Depth along the optical axis, metres; infinite in empty pixels.
    pub fn depth_m(&self) -> &[f32] {
        &self.depth_m
    }

    /// Instance mask: [`crate::Instance::id`] of each pixel; 0 in empty pixels.
    pub fn instance(&self) -> &[u16] {
        &self.instance
    }

    /// Linear sRGB colour; [`crate::LINEAR_ONE`] is white.
    pub fn color(&self) -> &[[u16; 3]] {
        &self.color
    }

    /// Surface reflectance and orientation; zero in empty pixels.
    pub fn reflection(&self) -> &[Reflection] {
        &self.reflection
    }

    /// Counts the pixels of each instance: `counts[id]` becomes the number of pixels with that
    /// id. Ids beyond the slice are not counted.
    pub fn count_pixels(&self, counts: &mut [u32]) {
        counts.fill(0);
        for &id in &self.instance {
            if let Some(count) = counts.get_mut(usize::from(id)) {
                *count += 1;
            }
        }
    }

    /// Writes a shaded pixel into the image.
    #[inline]
    pub(crate) fn set(&mut self, pixel: usize, lit: &LitPixel) {
        self.depth_m[pixel] = lit.depth_m;
        self.instance[pixel] = lit.instance;
        self.color[pixel] = lit.color;
        self.reflection[pixel] = lit.reflection;
    }

    /// Clears a horizontal span of pixels.
    pub(crate) fn clear_span(&mut self, span: std::ops::Range<usize>) {
        self.depth_m[span.clone()].fill(f32::INFINITY);
        self.instance[span.clone()].fill(0);
        self.color[span.clone()].fill([0; 3]);
        self.reflection[span].fill(Reflection::default());
    }

    /// Copies a span of pixels from an image of the same size.
    pub(crate) fn copy_span(&mut self, from: &Self, span: std::ops::Range<usize>) {
        self.depth_m[span.clone()].copy_from_slice(&from.depth_m[span.clone()]);
        self.instance[span.clone()].copy_from_slice(&from.instance[span.clone()]);
        self.color[span.clone()].copy_from_slice(&from.color[span.clone()]);
        self.reflection[span.clone()].copy_from_slice(&from.reflection[span]);
    }
}
