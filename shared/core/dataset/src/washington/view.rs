//! Cropped images of one view of an object.

use crate::Error;
use crate::png_image::MAX_SIDE;
use geometry::PinholeCamera;
use point_cloud::{Point, Rgba};

const M_FROM_MM: f64 = 0.001;

/// Cropped view of an object. The vectors hold one value per pixel, row-major.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CroppedView {
    /// Width and height of the crop, pixels.
    pub size: (u32, u32),
    /// Column and row of the first pixel in the whole image, from 0.
    pub top_left: (u32, u32),
    /// Cropped colour image: red, green, blue of each pixel.
    pub color: Vec<u8>,
    /// Cropped depth image, millimetres; 0 is no depth.
    pub depth_mm: Vec<u16>,
    /// Segmentation mask: 0 is background, any other value the object.
    pub mask: Vec<u8>,
}

impl CroppedView {
    /// Points of the object: its pixels with depth, row-major.
    ///
    /// *Frame*: camera, metres. The camera is that of the whole image, such as
    /// [`super::CAMERA`].
    ///
    /// # Errors
    /// When a vector does not fill the cut-out.
    pub fn points(&self, camera: &PinholeCamera) -> Result<Vec<Point>, Error> {
        self.check()?;
        let pixels = self.object_pixels();
        Ok(pixels.map(|pixel| self.point(camera, pixel)).collect())
    }

    /// Indices of the object's pixels with depth. The view must be validated.
    pub(super) fn object_pixels(&self) -> impl Iterator<Item = usize> + '_ {
        let is_object = |pixel: &usize| self.mask[*pixel] != 0 && self.depth_mm[*pixel] != 0;
        (0..self.depth_mm.len()).filter(is_object)
    }

    /// Column and row of a pixel in the whole image, from 0.
    pub(super) fn pixel_in_image(&self, pixel: usize) -> (u32, u32) {
        let (column, row) = (pixel as u32 % self.size.0, pixel as u32 / self.size.0);
        (self.top_left.0 + column, self.top_left.1 + row)
    }

    pub(super) fn point(&self, camera: &PinholeCamera, pixel: usize) -> Point {
        let (column, row) = self.pixel_in_image(pixel);
        let z_m = f64::from(self.depth_mm[pixel]) * M_FROM_MM;
        let position = camera.back_project(f64::from(column), f64::from(row), z_m);
        let [red, green, blue] = [0, 1, 2].map(|channel| self.color[3 * pixel + channel]);
        Point {
            x: position.x as f32,
            y: position.y as f32,
            z: position.z as f32,
            color: Rgba::opaque(red, green, blue),
        }
    }

    /// Validates the lengths of the vectors and the crop rectangle.
    pub(super) fn check(&self) -> Result<(), Error> {
        let is_within = |first: u32, n: u32| n > 0 && n <= MAX_SIDE && first < MAX_SIDE;
        if !is_within(self.top_left.0, self.size.0) || !is_within(self.top_left.1, self.size.1) {
            return Err(Error::CropBounds {
                size: self.size,
                top_left: self.top_left,
            });
        }
        let n_pixels = self.size.0 as usize * self.size.1 as usize;
        for (what, found, needed) in [
            ("colour bytes", self.color.len(), 3 * n_pixels),
            ("depths", self.depth_mm.len(), n_pixels),
            ("mask values", self.mask.len(), n_pixels),
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
}
