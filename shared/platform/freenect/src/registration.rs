//! Depth-to-colour registration: an organised, coloured cloud from raw depth and colour.
//!
//! Each depth pixel is back-projected along its viewing ray, moved into the colour camera's frame
//! and projected there; the nearest colour pixel is its colour. A point occluded from the colour
//! camera takes the colour of the occluding surface: a seam of a few pixels along the edges of
//! objects, as in every Kinect's cloud.
//!
//! With q the rotated ray of a depth pixel, the colour pixel's column is
//! `fx (z qx + tx) / (z qz + tz) + cx`. Divided by z, and because q is linear in the pixel's
//! column and row, that is a quotient of two terms linear in column and 1/z. So no image-sized
//! table is needed: 1/z comes from a table of 2048 entries, and one division per pixel remains.

use crate::DepthTable;
use crate::calibration::{Calibration, InvalidCalibration};
use crate::raw::{HEIGHT, N_PIXELS, WIDTH};
use point_cloud::{Point, Rgba};

/// Colour of points outside the colour image and of pixels without depth.
pub const NEUTRAL_GREY: Rgba = Rgba::opaque(128, 128, 128);

/// Number of raw depth values (11 bits).
const N_VALUES: usize = 2048;

/// Converter from images to clouds, precomputed from a calibration; 21 kB.
#[derive(Debug, Clone)]
pub struct CloudBuilder {
    depths: Box<[Depth; N_VALUES]>,
    /// x of each column's viewing ray at z = 1.
    ray_x: Box<[f32; WIDTH]>,
    /// y of each row's viewing ray at z = 1.
    ray_y: Box<[f32; HEIGHT]>,
    color: ColorProjection,
}

/// Depth of a raw value and its inverse; NaN for no depth.
#[derive(Debug, Clone, Copy)]
struct Depth {
    z_m: f32,
    per_z: f32,
}

/// Term linear in the depth pixel's column and row and in 1/z.
#[derive(Debug, Clone, Copy)]
struct Linear {
    constant: f32,
    per_column: f32,
    per_row: f32,
    /// Coefficient of 1/z in the linear model, metres.
    per_inverse_z: f32,
}

/// Projection of a depth pixel into the colour image: (column, row) = (u, v) / w.
#[derive(Debug, Clone, Copy)]
struct ColorProjection {
    u: Linear,
    v: Linear,
    w: Linear,
}

/// Counts of the points of a cloud.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FillSummary {
    /// Number of cloud points with depth.
    pub n_points: usize,
    /// Number of points with depth inside the colour image.
    pub n_colored: usize,
}

/// Error of a buffer that does not hold 640x480 pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the {buffer} holds {length} values instead of the {expected} of 640x480 pixels")]
pub struct WrongSize {
    buffer: &'static str,
    length: usize,
    expected: usize,
}

impl CloudBuilder {
    /// Precomputes the tables of a calibration.
    ///
    /// # Errors
    /// If the calibration cannot be that of a Kinect.
    pub fn new(calibration: &Calibration) -> Result<Self, InvalidCalibration> {
        let calibration = calibration.clone().validated()?;
        let table = DepthTable::new(calibration.formula);
        let mut depths = Box::new(
            [Depth {
                z_m: f32::NAN,
                per_z: f32::NAN,
            }; N_VALUES],
        );
        for (raw, depth) in depths.iter_mut().enumerate() {
            let z_m = table.depth_m(raw as u16);
            *depth = Depth {
                z_m,
                per_z: 1.0 / z_m,
            };
        }
        let camera = &calibration.depth_camera;
        let (mut ray_x, mut ray_y) = (Box::new([0.0; WIDTH]), Box::new([0.0; HEIGHT]));
        for (column, x) in ray_x.iter_mut().enumerate() {
            *x = camera.ray(column as f64, 0.0).x as f32;
        }
        for (row, y) in ray_y.iter_mut().enumerate() {
            *y = camera.ray(0.0, row as f64).y as f32;
        }
        Ok(Self {
            depths,
            ray_x,
            ray_y,
            color: ColorProjection::new(&calibration),
        })
    }

    /// Fills `cloud` with the points of a depth image, row-major.
    ///
    /// Frame: the depth camera's (x right, y down, z forward), metres. Pixels without depth
    /// become points without depth. Allocates nothing; about 307 200 divisions.
    ///
    /// # Errors
    /// If a buffer is not 640x480; the cloud is then unchanged.
    pub fn fill(
        &self,
        depth_raw: &[u16],
        rgb: &[u8],
        cloud: &mut [Point],
    ) -> Result<FillSummary, WrongSize> {
        check_size("depth image", depth_raw.len(), N_PIXELS)?;
        check_size("colour image", rgb.len(), 3 * N_PIXELS)?;
        check_size("cloud", cloud.len(), N_PIXELS)?;
        let (rgb, _) = rgb.as_chunks::<3>();
        let mut summary = FillSummary::default();
        let rows = depth_raw
            .chunks_exact(WIDTH)
            .zip(cloud.chunks_exact_mut(WIDTH));
        for (row, (raw_row, cloud_row)) in rows.enumerate() {
            self.fill_row(row, raw_row, rgb, cloud_row, &mut summary);
        }
        Ok(summary)
    }

    /// Fills one row of the cloud.
    fn fill_row(
        &self,
        row: usize,
        raw_row: &[u16],
        rgb: &[[u8; 3]],
        cloud_row: &mut [Point],
        summary: &mut FillSummary,
    ) {
        let color = self.color.at_row(row as f32);
        let ray_y = self.ray_y[row];
        let pixels = raw_row
            .iter()
            .zip(cloud_row)
            .zip(self.ray_x.iter())
            .enumerate();
        for (column, ((raw, point), ray_x)) in pixels {
            let Some(depth) = self
                .depths
                .get(usize::from(*raw))
                .filter(|d| !d.z_m.is_nan())
            else {
                *point = Point::without_depth(NEUTRAL_GREY);
                continue;
            };
            let seen = color
                .pixel(column as f32, depth.per_z)
                .and_then(|pixel| rgb.get(pixel));
            summary.n_points += 1;
            summary.n_colored += usize::from(seen.is_some());
            let z = depth.z_m;
            let color = seen.map_or(NEUTRAL_GREY, |&[r, g, b]| Rgba::opaque(r, g, b));
            *point = Point {
                x: ray_x * z,
                y: ray_y * z,
                z,
                color,
            };
        }
    }
}

fn check_size(buffer: &'static str, length: usize, expected: usize) -> Result<(), WrongSize> {
    if length == expected {
        Ok(())
    } else {
        Err(WrongSize {
            buffer,
            length,
            expected,
        })
    }
}

impl Linear {
    /// Term of one row, depending only on column and 1/z.
    fn at_row(self, row: f32) -> Self {
        Self {
            constant: self.constant + self.per_row * row,
            per_row: 0.0,
            ..self
        }
    }

    #[inline]
    fn at(self, column: f32, per_z: f32) -> f32 {
        self.constant + self.per_column * column + self.per_inverse_z * per_z
    }
}

impl ColorProjection {
    fn new(calibration: &Calibration) -> Self {
        let (depth, color) = (&calibration.depth_camera, &calibration.color_camera);
        let rotation = calibration.color_from_depth.rotation.to_rotation_matrix();
        let t = &calibration.color_from_depth.translation;
        // Coefficients of one coordinate of the rotated ray and of the translation, in the colour
        // frame.
        let coordinate = |axis: usize, translation: f64| {
            let (a, b, c) = (
                rotation[(axis, 0)],
                rotation[(axis, 1)],
                rotation[(axis, 2)],
            );
            let per_column = a / depth.fx_px;
            let per_row = b / depth.fy_px;
            let constant = c - per_column * depth.cx_px - per_row * depth.cy_px;
            [constant, per_column, per_row, translation]
        };
        let (x, y, z) = (coordinate(0, t.x), coordinate(1, t.y), coordinate(2, t.z));
        let pinhole = |focal_px: f64, side: &[f64; 4], centre_px: f64| {
            Linear::from_f64(std::array::from_fn(|i| {
                focal_px * side[i] + centre_px * z[i]
            }))
        };
        Self {
            u: pinhole(color.fx_px, &x, color.cx_px),
            v: pinhole(color.fy_px, &y, color.cy_px),
            w: Linear::from_f64(z),
        }
    }

    fn at_row(&self, row: f32) -> Self {
        Self {
            u: self.u.at_row(row),
            v: self.v.at_row(row),
            w: self.w.at_row(row),
        }
    }

    /// Index of the nearest colour pixel; `None` outside the image or behind the colour camera.
    #[inline]
    fn pixel(&self, column: f32, per_z: f32) -> Option<usize> {
        let w = self.w.at(column, per_z);
        let scale = 1.0 / w;
        // Pixel centres are integers, so a pixel extends half a step to each side.
        let x = self.u.at(column, per_z) * scale + 0.5;
        let y = self.v.at(column, per_z) * scale + 0.5;
        let inside = w > 0.0 && x >= 0.0 && y >= 0.0 && x < WIDTH as f32 && y < HEIGHT as f32;
        inside.then(|| y as usize * WIDTH + x as usize)
    }
}

impl Linear {
    fn from_f64([constant, per_column, per_row, per_inverse_z]: [f64; 4]) -> Self {
        Self {
            constant: constant as f32,
            per_column: per_column as f32,
            per_row: per_row as f32,
            per_inverse_z: per_inverse_z as f32,
        }
    }
}

#[cfg(test)]
mod tests;
