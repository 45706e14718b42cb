//! Pixel block: structure-of-arrays batch of pixels for vectorised shading.
//!
//! The values of a block are stored lane by lane, so that the arithmetic becomes vector
//! instructions. A pixel's result does not depend on the other pixels of its block.

use crate::Texture;
use crate::blinn_phong::{CameraLights, Lighting};
use crate::illuminant::luminance;
use crate::lanes::{Lanes, N_LANES, VectorLanes};
use crate::lit_pixel::LitPixel;
use crate::prepared_mesh::infrared_albedo;
use crate::radiance::{Radiance, color_channel};
use crate::reflection::Reflection;
use crate::rounding::{floor, truncate};
use crate::shadow_map::{ShadowCoordinates, ShadowMap};
use crate::surface_attributes::{FaceAttributes, InstanceAttributes};
use crate::texture::N_POINTS;
use std::ops::Range;

/// Length of a run from which batched sampling pays off, pixels. Chosen.
pub(crate) const MIN_RUN: usize = 8;

/// Run of neighbouring pixels in a row that show the same face.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FaceRun<'a> {
    pub(crate) row: usize,
    /// First column of the run.
    pub(crate) column: usize,
    /// Viewing rays at z = 1: x for each pixel.
    pub(crate) x: &'a [f32],
    pub(crate) y: f32,
    /// Inverse depth of each pixel, per metre.
    pub(crate) reverse_z: &'a [f32],
}

impl<'a> FaceRun<'a> {
    /// Surface point of a pixel, camera frame, metres.
    #[inline]
    fn point(&self, i: usize) -> [f32; 3] {
        let depth_m = 1.0 / self.reverse_z[i];
        [self.x[i] * depth_m, self.y * depth_m, depth_m]
    }

    /// Splits the run after its first `n` pixels.
    #[inline]
    fn split_at(&self, n: usize) -> (Self, Self) {
        let (x, x_rest) = self.x.split_at(n);
        let (reverse_z, reverse_z_rest) = self.reverse_z.split_at(n);
        let part = |column: usize, x: &'a [f32], reverse_z: &'a [f32]| Self {
            column,
            x,
            reverse_z,
            ..*self
        };
        (
            part(self.column, x, reverse_z),
            part(self.column + n, x_rest, reverse_z_rest),
        )
    }
}

/// Batch of pixels to be shaded, camera frame.
#[derive(Debug, Clone)]
pub(crate) struct PixelBlock {
    n: usize,
    row: [u32; N_LANES],
    column: [u32; N_LANES],
    instance: [u16; N_LANES],
    point: VectorLanes,
    /// Surface normals, of any length but zero.
    normal: VectorLanes,
    /// Albedo of the pixels, linear sRGB.
    albedo: VectorLanes,
    specular: Lanes,
    infrared: Lanes,
    /// Surface points of the last run, mesh frame.
    in_mesh: VectorLanes,
    lighting: Lighting,
    in_shadow_map: ShadowCoordinates,
}

impl PixelBlock {
    pub(crate) fn new() -> Self {
        const VECTORS: VectorLanes = [[0.0; N_LANES]; 3];
        Self {
            n: 0,
            row: [0; N_LANES],
            column: [0; N_LANES],
            instance: [0; N_LANES],
            point: VECTORS,
            normal: VECTORS,
            albedo: VECTORS,
            specular: [0.0; N_LANES],
            infrared: [0.0; N_LANES],
            lighting: Lighting::new(),
            in_mesh: VECTORS,
            in_shadow_map: ShadowCoordinates::new(),
        }
    }

    /// Adds one pixel of a run; returns true if the block is full then.
    #[inline]
    pub(crate) fn push(
        &mut self,
        run: &FaceRun<'_>,
        i: usize,
        face: &FaceAttributes,
        instance: &InstanceAttributes,
    ) -> bool {
        let lane = self.n % N_LANES;
        let point = run.point(i);
        let sample = face.sample(instance, point);
        set(&mut self.point, lane, point);
        set(&mut self.normal, lane, sample.normal);
        set(&mut self.albedo, lane, sample.albedo);
        if instance.texture != Texture::None {
            set(&mut self.in_mesh, 0, sample.place);
            tint(
                &instance.texture,
                &self.in_mesh,
                &mut self.albedo,
                &(lane..lane + 1),
            );
        }
        self.row[lane] = run.row as u32;
        self.column[lane] = (run.column + i) as u32;
        self.instance[lane] = instance.id;
        self.specular[lane] = face.specular;
        self.infrared[lane] = face.infrared;
        self.n = lane + 1;
        self.n == N_LANES
    }

    /// Adds the first pixels of a run; returns the remaining run when the block is full.
    #[inline]
    pub(crate) fn push_all<'a>(
        &mut self,
        run: &FaceRun<'a>,
        face: &FaceAttributes,
        instance: &InstanceAttributes,
    ) -> Option<FaceRun<'a>> {
        let (now, later) = run.split_at(run.x.len().min(N_LANES - self.n));
        let lanes = self.n..self.n + now.x.len();
        self.n = lanes.end;
        self.sample(&lanes, &now, face, instance);
        if instance.texture != Texture::None {
            tint(&instance.texture, &self.in_mesh, &mut self.albedo, &lanes);
        }
        self.row[lanes.clone()].fill(now.row as u32);
        for (i, column) in self.column[lanes.clone()].iter_mut().enumerate() {
            *column = (now.column + i) as u32;
        }
        self.instance[lanes.clone()].fill(instance.id);
        self.specular[lanes.clone()].fill(face.specular);
        self.infrared[lanes].fill(face.infrared);
        (self.n == N_LANES).then_some(later)
    }

    /// Samples the surface in the pixels of a run, without texture.
    fn sample(
        &mut self,
        lanes: &Range<usize>,
        run: &FaceRun<'_>,
        face: &FaceAttributes,
        instance: &InstanceAttributes,
    ) {
        let n = lanes.len();
        let [mx, my, mz] = part(&mut self.in_mesh, &(0..n));
        let [px, py, pz] = part(&mut self.point, lanes);
        let [nx, ny, nz] = part(&mut self.normal, lanes);
        let [red, green, blue] = part(&mut self.albedo, lanes);
        for i in 0..n {
            let point = run.point(i);
            let sample = face.sample(instance, point);
            [px[i], py[i], pz[i]] = point;
            [nx[i], ny[i], nz[i]] = sample.normal;
            [red[i], green[i], blue[i]] = sample.albedo;
            [mx[i], my[i], mz[i]] = sample.place;
        }
    }

    /// Shades the pixels of the block, passes them to `take` and empties the block.
    #[inline]
    pub(crate) fn flush(
        &mut self,
        lights: &CameraLights,
        shadow: &ShadowMap,
        mut take: impl FnMut(&LitPixel),
    ) {
        self.lighting.compute(
            lights,
            &self.point,
            &mut self.normal,
            &self.albedo,
            &self.specular,
        );
        shadow.project_all(&self.point, &mut self.in_shadow_map);
        let mut light = [0_u8; N_LANES];
        for (lane, light) in light.iter_mut().enumerate().take(self.n) {
            if self.radiance(lane).has_main_light() {
                *light = shadow.lit_share(&self.in_shadow_map.at(lane));
            }
        }
        let colors = self.colors(&light);
        let reflections = self.reflections();
        for lane in 0..self.n {
            take(&LitPixel {
                row: self.row[lane] as usize,
                column: self.column[lane] as usize,
                instance: self.instance[lane],
                depth_m: self.point[2][lane],
                radiance: self.radiance(lane),
                light: light[lane],
                place: [self.in_shadow_map.x[lane], self.in_shadow_map.y[lane]],
                color: [colors[0][lane], colors[1][lane], colors[2][lane]],
                reflection: reflections.at(lane),
            });
        }
        self.n = 0;
    }

    #[inline]
    fn radiance(&self, lane: usize) -> Radiance {
        let of = |vectors: &VectorLanes| [vectors[0][lane], vectors[1][lane], vectors[2][lane]];
        Radiance {
            unlit: of(&self.lighting.unlit),
            lit: of(&self.lighting.lit),
        }
    }

    #[inline]
    fn colors(&self, light: &[u8; N_LANES]) -> [[u16; N_LANES]; 3] {
        let mut colors = [[0; N_LANES]; 3];
        for (channel, colors) in colors.iter_mut().enumerate() {
            let (unlit, lit) = (&self.lighting.unlit[channel], &self.lighting.lit[channel]);
            for i in 0..N_LANES {
                colors[i] = color_channel(unlit[i], lit[i], light[i]);
            }
        }
        colors
    }

    #[inline]
    fn reflections(&self) -> Reflections {
        let mut reflections = Reflections::default();
        let [red, green, blue] = &self.albedo;
        for i in 0..N_LANES {
            let brightness = luminance([red[i], green[i], blue[i]]);
            let infrared = infrared_albedo(self.infrared[i], brightness);
            reflections.infrared[i] = byte(infrared);
            reflections.cosine[i] = byte(self.lighting.cosine[i]);
            reflections.specular[i] = byte(self.specular[i]);
        }
        for (parts, normals) in reflections.normal.iter_mut().zip(&self.normal) {
            for (part, &normal) in parts.iter_mut().zip(normals) {
                *part = truncate((normal * 127.0).clamp(-127.0, 127.0)) as i8;
            }
        }
        reflections
    }
}

/// Converts a share, 0 to 1, to a rounded byte.
#[inline]
fn byte(share: f32) -> u8 {
    floor((share * 255.0 + 0.5).clamp(0.0, 255.0)) as u8
}

/// Quantised reflections of a block, lane by lane.
struct Reflections {
    normal: [[i8; N_LANES]; 3],
    cosine: [u8; N_LANES],
    infrared: [u8; N_LANES],
    specular: [u8; N_LANES],
}

impl Default for Reflections {
    fn default() -> Self {
        Self {
            normal: [[0; N_LANES]; 3],
            cosine: [0; N_LANES],
            infrared: [0; N_LANES],
            specular: [0; N_LANES],
        }
    }
}

impl Reflections {
    #[inline]
    fn at(&self, lane: usize) -> Reflection {
        Reflection {
            normal: [
                self.normal[0][lane],
                self.normal[1][lane],
                self.normal[2][lane],
            ],
            cos_incidence: self.cosine[lane],
            infrared: self.infrared[lane],
            specular: self.specular[lane],
        }
    }
}

#[inline]
fn set([x, y, z]: &mut VectorLanes, lane: usize, vector: [f32; 3]) {
    [x[lane], y[lane], z[lane]] = vector;
}

#[inline]
fn part<'a>(vectors: &'a mut VectorLanes, lanes: &Range<usize>) -> [&'a mut [f32]; 3] {
    vectors.each_mut().map(|values| &mut values[lanes.clone()])
}

/// Multiplies the albedo of `lanes` by a texture; `places` starts with the first lane.
fn tint(texture: &Texture, places: &VectorLanes, albedo: &mut VectorLanes, lanes: &Range<usize>) {
    let mut factors = [[1.0; N_POINTS]; 3];
    for start in (0..lanes.len()).step_by(N_POINTS) {
        let place = places.each_ref().map(|along| {
            let mut values = [0.0; N_POINTS];
            values.copy_from_slice(&along[start..start + N_POINTS]);
            values
        });
        texture.factors(&place, &mut factors);
        let first = lanes.start + start;
        let end = lanes.end.min(first + N_POINTS);
        for (albedo, factors) in albedo.iter_mut().zip(&factors) {
            for (albedo, factor) in albedo[first..end].iter_mut().zip(factors) {
                *albedo *= factor;
            }
        }
    }
}
