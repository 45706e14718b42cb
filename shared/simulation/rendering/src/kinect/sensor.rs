//! Simulated Kinect sensor: applies the error terms to a rendered image.

use super::axial_noise::{angle_terms, step_m};
use super::color_response::ColorCamera;
use super::edge_fattening::{BorderNoise, lateral_sigmas_px};
use super::noise_tables::{NoiseKey, NoisePurpose, NoiseTables};
use super::sensor_model::SensorModel;
use crate::Error;
use crate::image::Image;
use crate::pixel_rays::PixelRays;
use crate::reflection::Reflection;
use crate::rounding::floor;
use geometry::PinholeCamera;
use point_cloud::{Point, Rgba};

/// Number of pixels that share one position in the noise tables.
const BLOCK_PX: usize = 64;
/// Number of rows that share their common noise. Chosen.
const COMMON_ROWS: usize = 3;
/// Amplitude by which the probability of a hole varies between frames; the rest is constant.
/// Chosen.
const FLICKER: f32 = 0.25;

/// Noise seed of one measurement: sensor and frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FrameSeed {
    /// Seed of the sensor: different seeds are different sensors.
    pub seed: u64,
    /// Frame index; the same index repeats the same noise.
    pub frame_index: u64,
}

/// Simulated Kinect with its buffers.
///
/// The same image, model and shot give the same bytes. Nothing is allocated after construction.
#[derive(Debug)]
pub struct KinectSensor {
    camera: PinholeCamera,
    model: SensorModel,
    rays: PixelRays,
    tables: NoiseTables,
    color_camera: ColorCamera,
    angle_terms: [f32; 256],
    lateral_sigmas_px: [f32; 256],
    /// Disparity of the exact depth, pixels; 0 in empty pixels.
    exact: Vec<f32>,
    /// Disparity of the matched surface, pixels; 0 for no match.
    matched: Vec<f32>,
    /// Buffer of the matching window; empty without one.
    scratch: Vec<f32>,
    row: RowBuffers,
    depth_mm: Vec<u16>,
    color: Vec<[u8; 3]>,
}

/// Intermediate values of one image row.
#[derive(Debug)]
struct RowBuffers {
    depth_m: Vec<f32>,
    angle_term: Vec<f32>,
    cos_incidence: Vec<f32>,
    infrared: Vec<f32>,
    specular: Vec<f32>,
    normal: Vec<f32>,
    uniform: Vec<f32>,
}

impl KinectSensor {
    /// Sensor for the images of a camera.
    ///
    /// # Errors
    /// [`Error`] for an invalid camera or a parameter out of its range.
    pub fn new(camera: PinholeCamera, model: SensorModel) -> Result<Self, Error> {
        let camera = camera.validated()?;
        let model = model.validated()?;
        let (width, height) = (camera.width as usize, camera.height as usize);
        let n_pixels = camera.n_pixels();
        let row = || vec![0.0; width];
        Ok(Self {
            camera,
            model,
            rays: PixelRays::new(&camera),
            tables: NoiseTables::new(),
            color_camera: ColorCamera::new(model.color, width, height),
            angle_terms: angle_terms(),
            lateral_sigmas_px: lateral_sigmas_px(model.lateral_noise.as_ref()),
            exact: vec![0.0; n_pixels],
            matched: vec![0.0; n_pixels],
            scratch: vec![0.0; model.matching_window.map_or(0, |_| n_pixels)],
            row: RowBuffers {
                depth_m: row(),
                angle_term: row(),
                cos_incidence: row(),
                infrared: row(),
                specular: row(),
                normal: row(),
                uniform: row(),
            },
            depth_mm: vec![0; n_pixels],
            color: vec![[0; 3]; n_pixels],
        })
    }

    /// Model of the simulated sensor.
    pub fn model(&self) -> &SensorModel {
        &self.model
    }

    /// Measured depth of the last image, millimetres, row-major; 0 where it is missing.
    pub fn depth_mm(&self) -> &[u16] {
        &self.depth_mm
    }

    /// Measured colour of the last image, sRGB (red, green, blue), row-major.
    pub fn color(&self) -> &[[u8; 3]] {
        &self.color
    }

    /// Measures an image: one point per pixel, row-major, camera frame. A pixel without depth has
    /// NaN coordinates; the colour is always valid.
    ///
    /// # Errors
    /// [`Error::ForeignImage`] or [`Error::CloudSize`]; nothing is measured then.
    pub fn sense(
        &mut self,
        image: &Image,
        shot: FrameSeed,
        points: &mut [Point],
    ) -> Result<(), Error> {
        if *image.camera() != self.camera {
            return Err(Error::ForeignImage);
        }
        if points.len() != self.exact.len() {
            return Err(Error::CloudSize {
                n_points: points.len(),
                n_pixels: self.exact.len(),
            });
        }
        let key = NoiseKey::new(shot.seed, shot.frame_index);
        self.match_pattern(image, key);
        let (width, height) = self.rays.size();
        let rows = points.chunks_exact_mut(width).take(height);
        for (row, points) in rows.enumerate() {
            self.measure_row(image, row, shot.seed, key);
            let pixels = row * width..(row + 1) * width;
            self.color_camera.encode_row(
                image.color(),
                row,
                (&key, &self.tables),
                &mut self.color[pixels.clone()],
            );
            let y = self.rays.y()[row];
            let colors = &self.color[pixels.clone()];
            fill_points(&self.row.depth_m, self.rays.x(), y, colors, points);
            fill_millimetres(&self.row.depth_m, &mut self.depth_mm[pixels]);
        }
        Ok(())
    }

    /// Focal length in pixels times baseline in metres.
    fn focal_baseline(&self) -> f32 {
        self.camera.fx_px as f32 * self.model.baseline_m
    }

    /// Finds the matched disparity of each pixel: projector shadow, border errors and matching
    /// window.
    fn match_pattern(&mut self, image: &Image, key: NoiseKey) {
        let focal_baseline = self.focal_baseline();
        for (exact, &depth_m) in self.exact.iter_mut().zip(image.depth_m()) {
            *exact = focal_baseline / depth_m;
        }
        self.matched.copy_from_slice(&self.exact);
        let width = self.rays.size().0;
        if let Some(shadow) = &self.model.projector_shadow {
            let rows = self.exact.chunks_exact(width);
            for (exact, seen) in rows.zip(self.matched.chunks_exact_mut(width)) {
                shadow.cast(exact, seen);
            }
        }
        let borders = BorderNoise {
            fattening: self.model.edge_fattening,
            lateral_sigmas_px: &self.lateral_sigmas_px,
            speckle: self.model.border_speckle,
            key,
            tables: &self.tables,
        };
        if self.model.edge_fattening.is_some()
            || self.model.lateral_noise.is_some()
            || self.model.border_speckle.is_some()
        {
            borders.apply(&self.exact, image.reflection(), &mut self.matched, width);
        }
        if let Some(window) = &self.model.matching_window {
            let noise = (&key, &self.tables);
            window.apply(&mut self.matched, &mut self.scratch, width, noise);
        }
    }

    /// Measures the depth of one row, NaN where it is missing.
    fn measure_row(&mut self, image: &Image, row: usize, seed: u64, key: NoiseKey) {
        let width = self.rays.size().0;
        let pixels = row * width..(row + 1) * width;
        let focal_baseline = self.focal_baseline();
        for (depth_m, &seen) in self
            .row
            .depth_m
            .iter_mut()
            .zip(&self.matched[pixels.clone()])
        {
            *depth_m = focal_baseline / seen;
        }
        if self.model.axial_noise.is_some() || self.model.weak_signal.is_some() {
            self.gather_reflection(&image.reflection()[pixels]);
        }
        if self.model.axial_noise.is_some() {
            self.add_axial_noise(row, key);
        }
        if let Some(quantisation) = &self.model.quantisation {
            for depth_m in &mut self.row.depth_m {
                *depth_m = focal_baseline / quantisation.quantise(focal_baseline / *depth_m);
            }
        }
        if self.model.weak_signal.is_some() {
            self.drop_weak(row, seed, key);
        }
        self.drop_out_of_range();
    }

    fn gather_reflection(&mut self, reflection: &[Reflection]) {
        let share = |value: u8| f32::from(value) * (1.0 / 255.0);
        let buffers = &mut self.row;
        for (i, reflection) in reflection.iter().enumerate() {
            buffers.angle_term[i] = self.angle_terms[usize::from(reflection.cos_incidence)];
            buffers.cos_incidence[i] = share(reflection.cos_incidence);
            buffers.infrared[i] = share(reflection.infrared);
            buffers.specular[i] = share(reflection.specular);
        }
    }

    fn add_axial_noise(&mut self, row: usize, key: NoiseKey) {
        let Some(noise) = self.model.axial_noise else {
            return;
        };
        let (own, common) = ((1.0 - noise.common_share).sqrt(), noise.common_share.sqrt());
        for (block, normal) in self.row.normal.chunks_mut(BLOCK_PX).enumerate() {
            let own_hash = key.hash(NoisePurpose::Axial, row, block);
            let common_hash = key.hash(NoisePurpose::AxialCommon, row / COMMON_ROWS, block);
            let parts = self
                .tables
                .normal(own_hash, normal.len())
                .iter()
                .zip(self.tables.smooth_normal(common_hash, normal.len()));
            for (normal, (a, b)) in normal.iter_mut().zip(parts) {
                *normal = own * a + common * b;
            }
        }
        let focal_baseline = self.focal_baseline();
        let quantisation = self.model.quantisation.as_ref();
        let draws = self.row.normal.iter().zip(&self.row.angle_term);
        for (depth_m, (&normal, &angle_term)) in self.row.depth_m.iter_mut().zip(draws) {
            let step_m = step_m(quantisation, *depth_m, focal_baseline);
            *depth_m += normal * noise.random_sigma_m(*depth_m, angle_term, step_m);
        }
    }

    /// Drops pixels with too weak a signal.
    fn drop_weak(&mut self, row: usize, seed: u64, key: NoiseKey) {
        let Some(signal) = self.model.weak_signal else {
            return;
        };
        // Mostly the same spots in each frame.
        let static_key = NoiseKey::new(seed, u64::MAX);
        for (block, uniform) in self.row.uniform.chunks_mut(BLOCK_PX).enumerate() {
            let stays = static_key.hash(NoisePurpose::Signal, row / COMMON_ROWS, block);
            let flickers = key.hash(NoisePurpose::SignalFlicker, row / 2, block);
            let parts = self
                .tables
                .smooth_uniform(stays, uniform.len())
                .iter()
                .zip(self.tables.smooth_uniform(flickers, uniform.len()));
            for (uniform, (stays, flickers)) in uniform.iter_mut().zip(parts) {
                // Mirrored at both ends, which keeps the distribution uniform.
                let moved = (stays + FLICKER * (flickers - 0.5)).abs();
                *uniform = moved.min(2.0 - moved);
            }
        }
        let buffers = &mut self.row;
        let len = buffers.depth_m.len();
        let (cosine, infrared) = (&buffers.cos_incidence[..len], &buffers.infrared[..len]);
        let (specular, uniform) = (&buffers.specular[..len], &buffers.uniform[..len]);
        for (i, depth_m) in buffers.depth_m.iter_mut().enumerate() {
            let missing = signal.missing_share(*depth_m, cosine[i], infrared[i], specular[i]);
            *depth_m = if uniform[i] < missing {
                f32::NAN
            } else {
                *depth_m
            };
        }
    }

    fn drop_out_of_range(&mut self) {
        let (min_m, max_m) = self
            .model
            .range
            .map_or((0.0, f32::MAX), |range| (range.min_m, range.max_m));
        for depth_m in &mut self.row.depth_m {
            *depth_m = if *depth_m >= min_m && *depth_m <= max_m {
                *depth_m
            } else {
                f32::NAN
            };
        }
        let width = self.row.depth_m.len();
        let first_blind = width - self.model.n_blind_columns.min(width);
        self.row.depth_m[first_blind..].fill(f32::NAN);
    }
}

/// Back-projects one row of depth to points.
fn fill_points(depth_m: &[f32], x: &[f32], y: f32, colors: &[[u8; 3]], points: &mut [Point]) {
    let pixels = depth_m.iter().zip(x).zip(colors);
    for (point, ((&z, &x), &[red, green, blue])) in points.iter_mut().zip(pixels) {
        *point = Point {
            x: x * z,
            y: y * z,
            z,
            color: Rgba::opaque(red, green, blue),
        };
    }
}

/// Rounds one row to millimetres; NaN becomes 0.
fn fill_millimetres(depth_m: &[f32], depth_mm: &mut [u16]) {
    for (depth_mm, &depth_m) in depth_mm.iter_mut().zip(depth_m) {
        // A comparison with NaN is false, so NaN becomes 0.
        let rounded = depth_m * 1000.0 + 0.5;
        let within = if rounded > 0.0 { rounded } else { 0.0 };
        *depth_mm = floor(within.min(65_535.0)) as u16;
    }
}
