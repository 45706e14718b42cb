//! Pixels that are lit together.
//!
//! Pixels are gathered into blocks whose values lie side by side, so that the
//! arithmetic becomes vector instructions; a pixel's result does not depend on
//! its neighbours in a block.

use crate::Texture;
use crate::illuminant::luminance;
use crate::image::Reflection;
use crate::prepared_mesh::infrared_albedo;
use crate::reflected_light::{CameraLights, Lighting};
use crate::shading::{FaceLook, InstanceLook, Radiance, color_channel};
use crate::shadow_map::{Places, ShadowMap};
use crate::texture::N_PLACES;
use crate::whole_number::{floor, truncated};
use std::ops::Range;

/// Pixels of a block.
pub(crate) const LANES: usize = 64;

/// Pixels of one face from which a loop over them is worth its set-up.
pub(crate) const RUN_MIN: usize = 8;

/// A value of each pixel.
pub(crate) type Lanes = [f32; LANES];
/// A vector or colour of each pixel.
pub(crate) type Vectors = [Lanes; 3];

/// Neighbouring pixels of a row in which the same face is seen.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Run<'a> {
    pub(crate) row: usize,
    /// First column.
    pub(crate) column: usize,
    /// Directions of the viewing rays along x, and of all of them along y.
    pub(crate) x: &'a [f32],
    pub(crate) y: f32,
    /// Inverse depths, per metre; as many as directions.
    pub(crate) closeness: &'a [f32],
}

impl<'a> Run<'a> {
    /// The point seen in a pixel, camera frame.
    #[inline]
    fn point(&self, i: usize) -> [f32; 3] {
        let depth_m = 1.0 / self.closeness[i];
        [self.x[i] * depth_m, self.y * depth_m, depth_m]
    }

    /// The first `n` pixels and the rest.
    #[inline]
    fn split_at(&self, n: usize) -> (Self, Self) {
        let (x, x_rest) = self.x.split_at(n);
        let (closeness, closeness_rest) = self.closeness.split_at(n);
        let part = |column: usize, x: &'a [f32], closeness: &'a [f32]| Self {
            column,
            x,
            closeness,
            ..*self
        };
        (
            part(self.column, x, closeness),
            part(self.column + n, x_rest, closeness_rest),
        )
    }
}

/// Pixels that wait for their light, camera frame.
#[derive(Debug, Clone)]
pub(crate) struct PixelBlock {
    n: usize,
    row: [u32; LANES],
    column: [u32; LANES],
    instance: [u16; LANES],
    point: Vectors,
    /// Of any length but zero.
    normal: Vectors,
    /// Linear sRGB.
    albedo: Vectors,
    specular: Lanes,
    infrared: Lanes,
    /// Of the run that was added last, mesh frame.
    in_mesh: Vectors,
    lighting: Lighting,
    in_shadow_map: Places,
}

/// A pixel with its light.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LitPixel {
    pub(crate) row: usize,
    pub(crate) column: usize,
    pub(crate) instance: u16,
    pub(crate) depth_m: f32,
    pub(crate) radiance: Radiance,
    /// Share of the main light that arrives, times 255; 0 where it has no effect.
    pub(crate) light: u8,
    /// Where it lies in the shadow map.
    pub(crate) place: [f32; 2],
    pub(crate) color: [u16; 3],
    pub(crate) reflection: Reflection,
}

impl PixelBlock {
    pub(crate) fn new() -> Self {
        const VECTORS: Vectors = [[0.0; LANES]; 3];
        Self {
            n: 0,
            row: [0; LANES],
            column: [0; LANES],
            instance: [0; LANES],
            point: VECTORS,
            normal: VECTORS,
            albedo: VECTORS,
            specular: [0.0; LANES],
            infrared: [0.0; LANES],
            lighting: Lighting::new(),
            in_mesh: VECTORS,
            in_shadow_map: Places::new(),
        }
    }

    /// Adds one pixel of a run; whether the block is full then.
    #[inline]
    pub(crate) fn push(
        &mut self,
        run: &Run<'_>,
        i: usize,
        face: &FaceLook,
        look: &InstanceLook,
    ) -> bool {
        let lane = self.n % LANES;
        let point = run.point(i);
        let sample = face.sample(look, point);
        set(&mut self.point, lane, point);
        set(&mut self.normal, lane, sample.normal);
        set(&mut self.albedo, lane, sample.albedo);
        if look.texture != Texture::None {
            set(&mut self.in_mesh, 0, sample.place);
            tint(
                &look.texture,
                &self.in_mesh,
                &mut self.albedo,
                &(lane..lane + 1),
            );
        }
        self.row[lane] = run.row as u32;
        self.column[lane] = (run.column + i) as u32;
        self.instance[lane] = look.id;
        self.specular[lane] = face.specular;
        self.infrared[lane] = face.infrared;
        self.n = lane + 1;
        self.n == LANES
    }

    /// Adds the first pixels of a run; gives the rest when the block is full.
    #[inline]
    pub(crate) fn push_all<'a>(
        &mut self,
        run: &Run<'a>,
        face: &FaceLook,
        look: &InstanceLook,
    ) -> Option<Run<'a>> {
        let (now, later) = run.split_at(run.x.len().min(LANES - self.n));
        let lanes = self.n..self.n + now.x.len();
        self.n = lanes.end;
        self.sample(&lanes, &now, face, look);
        if look.texture != Texture::None {
            tint(&look.texture, &self.in_mesh, &mut self.albedo, &lanes);
        }
        self.row[lanes.clone()].fill(now.row as u32);
        for (i, column) in self.column[lanes.clone()].iter_mut().enumerate() {
            *column = (now.column + i) as u32;
        }
        self.instance[lanes.clone()].fill(look.id);
        self.specular[lanes.clone()].fill(face.specular);
        self.infrared[lanes].fill(face.infrared);
        (self.n == LANES).then_some(later)
    }

    /// Finds what is seen in the pixels of a run, without texture.
    fn sample(
        &mut self,
        lanes: &Range<usize>,
        run: &Run<'_>,
        face: &FaceLook,
        look: &InstanceLook,
    ) {
        let n = lanes.len();
        let [mx, my, mz] = part(&mut self.in_mesh, &(0..n));
        let [px, py, pz] = part(&mut self.point, lanes);
        let [nx, ny, nz] = part(&mut self.normal, lanes);
        let [red, green, blue] = part(&mut self.albedo, lanes);
        for i in 0..n {
            let point = run.point(i);
            let sample = face.sample(look, point);
            [px[i], py[i], pz[i]] = point;
            [nx[i], ny[i], nz[i]] = sample.normal;
            [red[i], green[i], blue[i]] = sample.albedo;
            [mx[i], my[i], mz[i]] = sample.place;
        }
    }

    /// Lights the pixels of the block, hands them out and empties it.
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
        shadow.locate_all(&self.point, &mut self.in_shadow_map);
        let mut light = [0_u8; LANES];
        for (lane, light) in light.iter_mut().enumerate().take(self.n) {
            if self.radiance(lane).has_main_light() {
                *light = shadow.light_at(&self.in_shadow_map.at(lane));
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
        let of = |vectors: &Vectors| [vectors[0][lane], vectors[1][lane], vectors[2][lane]];
        Radiance {
            unlit: of(&self.lighting.unlit),
            lit: of(&self.lighting.lit),
        }
    }

    #[inline]
    fn colors(&self, light: &[u8; LANES]) -> [[u16; LANES]; 3] {
        let mut colors = [[0; LANES]; 3];
        for (channel, colors) in colors.iter_mut().enumerate() {
            let (unlit, lit) = (&self.lighting.unlit[channel], &self.lighting.lit[channel]);
            for i in 0..LANES {
                colors[i] = color_channel(unlit[i], lit[i], light[i]);
            }
        }
        colors
    }

    #[inline]
    fn reflections(&self) -> Reflections {
        let mut reflections = Reflections::default();
        let [red, green, blue] = &self.albedo;
        for i in 0..LANES {
            let brightness = luminance([red[i], green[i], blue[i]]);
            let infrared = infrared_albedo(self.infrared[i], brightness);
            reflections.infrared[i] = byte(infrared);
            reflections.cosine[i] = byte(self.lighting.cosine[i]);
            reflections.specular[i] = byte(self.specular[i]);
        }
        for (parts, normals) in reflections.normal.iter_mut().zip(&self.normal) {
            for (part, &normal) in parts.iter_mut().zip(normals) {
                *part = truncated((normal * 127.0).clamp(-127.0, 127.0)) as i8;
            }
        }
        reflections
    }
}

/// A share times 255, rounded.
#[inline]
fn byte(share: f32) -> u8 {
    floor((share * 255.0 + 0.5).clamp(0.0, 255.0)) as u8
}

/// How the surfaces of a block send light back.
struct Reflections {
    normal: [[i8; LANES]; 3],
    cosine: [u8; LANES],
    infrared: [u8; LANES],
    specular: [u8; LANES],
}

impl Default for Reflections {
    fn default() -> Self {
        Self {
            normal: [[0; LANES]; 3],
            cosine: [0; LANES],
            infrared: [0; LANES],
            specular: [0; LANES],
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
fn set([x, y, z]: &mut Vectors, lane: usize, vector: [f32; 3]) {
    [x[lane], y[lane], z[lane]] = vector;
}

#[inline]
fn part<'a>(vectors: &'a mut Vectors, lanes: &Range<usize>) -> [&'a mut [f32]; 3] {
    vectors.each_mut().map(|values| &mut values[lanes.clone()])
}

/// Multiplies the colours of `lanes` by a texture; `places` begin with the first.
fn tint(texture: &Texture, places: &Vectors, albedo: &mut Vectors, lanes: &Range<usize>) {
    let mut factors = [[1.0; N_PLACES]; 3];
    for start in (0..lanes.len()).step_by(N_PLACES) {
        let place = places.each_ref().map(|along| {
            let mut values = [0.0; N_PLACES];
            values.copy_from_slice(&along[start..start + N_PLACES]);
            values
        });
        texture.factors(&place, &mut factors);
        let first = lanes.start + start;
        let end = lanes.end.min(first + N_PLACES);
        for (albedo, factors) in albedo.iter_mut().zip(&factors) {
            for (albedo, factor) in albedo[first..end].iter_mut().zip(factors) {
                *albedo *= factor;
            }
        }
    }
}
