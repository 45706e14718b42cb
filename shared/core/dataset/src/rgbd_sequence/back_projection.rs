//! Back-projection of depth images to points.

use super::{PinholeCamera, Point};
use crate::ContentError;
use point_cloud::Rgba;

const M_FROM_MM: f64 = 0.001;

/// Precomputed viewing rays of a camera, for back-projection of many images.
#[derive(Debug, Clone)]
pub struct BackProjection {
    /// x of the ray with z = 1, for each column.
    ray_x: Vec<f32>,
    /// y of the ray with z = 1, for each row.
    ray_y: Vec<f32>,
    /// Metres of one unit of depth.
    m_from_unit: f32,
}

impl BackProjection {
    /// Precomputes the rays of a camera with depth images in millimetres.
    pub fn new(camera: &PinholeCamera) -> Self {
        Self::with_depth_unit(camera, 1.0)
    }

    /// Precomputes the rays of a camera with depth images in units of this many millimetres.
    pub fn with_depth_unit(camera: &PinholeCamera, depth_unit_mm: f64) -> Self {
        let ray_x = |column| camera.ray(f64::from(column), 0.0).x as f32;
        let ray_y = |row| camera.ray(0.0, f64::from(row)).y as f32;
        Self {
            ray_x: (0..camera.width).map(ray_x).collect(),
            ray_y: (0..camera.height).map(ray_y).collect(),
            m_from_unit: (depth_unit_mm * M_FROM_MM) as f32,
        }
    }

    /// Back-projects each pixel to a point, camera frame, metres.
    ///
    /// *Shape*: depth and points have a value for each pixel, row by row,
    /// colour three. A depth of 0 or 65535 is none and gives NaN.
    /// *Speed*: benchmark `back_projection`.
    ///
    /// # Errors
    /// When a slice does not fill the image.
    pub fn fill(&self, depth: &[u16], color: &[u8], out: &mut [Point]) -> Result<(), ContentError> {
        let (width, n_pixels) = (self.ray_x.len(), self.ray_x.len() * self.ray_y.len());
        for (found, needed) in [
            (depth.len(), n_pixels),
            (color.len(), 3 * n_pixels),
            (out.len(), n_pixels),
        ] {
            if found != needed {
                return Err(ContentError::SliceLength { found, needed });
            }
        }
        // A camera has at least one column, or there is nothing to fill.
        let width = width.max(1);
        let rows = depth.chunks_exact(width).zip(color.chunks_exact(3 * width));
        for ((out, (depth, color)), &ray_y) in
            out.chunks_exact_mut(width).zip(rows).zip(&self.ray_y)
        {
            let pixels = depth.iter().zip(color.as_chunks().0).zip(&self.ray_x);
            for (point, ((&depth, &color), &ray_x)) in out.iter_mut().zip(pixels) {
                *point = back_project([ray_x, ray_y], depth, self.m_from_unit, color);
            }
        }
        Ok(())
    }
}

#[inline]
fn back_project(
    [ray_x, ray_y]: [f32; 2],
    depth: u16,
    m_from_unit: f32,
    [red, green, blue]: [u8; 3],
) -> Point {
    // 0 and 65535 are the two values that wrap to the top.
    let is_valid = depth.wrapping_sub(1) < u16::MAX - 1;
    let z = if is_valid {
        f32::from(depth) * m_from_unit
    } else {
        f32::NAN
    };
    Point {
        x: ray_x * z,
        y: ray_y * z,
        z,
        color: Rgba::opaque(red, green, blue),
    }
}
