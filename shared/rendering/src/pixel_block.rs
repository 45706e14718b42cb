//! Light in many pixels at once.
//!
//! Lambert's law, Blinn's (1977) half-vector highlight, and light of the
//! surroundings from above and below, camera frame. Pixels are gathered into
//! blocks whose values lie side by side, so that the arithmetic becomes vector
//! instructions; a pixel's result does not depend on its neighbours in a block.

use crate::illuminant::luminance;
use crate::image::Reflection;
use crate::lights::{Light, LightPlacement, Lights};
use crate::prepared_mesh::infrared_albedo;
use crate::projection::Placement;
use crate::shading::Radiance;

/// Pixels of a block.
const LANES: usize = 16;
/// Brightness of a highlight on a perfect mirror, relative to the light.
const HIGHLIGHT: f32 = 3.0;

type Lanes = [f32; LANES];
type Vectors = [Lanes; 3];

/// What is seen in a pixel, camera frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sample {
    pub(crate) point: [f32; 3],
    /// Of any length but zero.
    pub(crate) normal: [f32; 3],
    /// Linear sRGB.
    pub(crate) albedo: [f32; 3],
    pub(crate) specular: f32,
    pub(crate) infrared: f32,
    pub(crate) instance: u16,
}

/// A light in the camera's frame.
#[derive(Debug, Clone, Copy)]
struct CameraLight {
    rgb: [f32; 3],
    /// Unit direction to the light, or its place.
    vector: [f32; 3],
    /// 1 for a place, 0 for a direction.
    is_place: f32,
}

impl CameraLight {
    fn new(light: &Light, camera_from_world: &Placement) -> Self {
        let (vector, is_place) = match light.placement {
            LightPlacement::Directional(to_light) => {
                let to_light = to_light.try_normalize(1e-9).unwrap_or_default();
                (camera_from_world.direction(to_light.into()), 0.0)
            }
            LightPlacement::Point(lamp) => (camera_from_world.point(lamp.coords.into()), 1.0),
        };
        Self {
            rgb: light.illuminant.linear_rgb(),
            vector: vector.map(|part| if part.is_finite() { part } else { 0.0 }),
            is_place,
        }
    }
}

/// All lights in the camera's frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CameraLights {
    ambient: [f32; 3],
    up: [f32; 3],
    main: CameraLight,
    fill: Option<CameraLight>,
}

impl CameraLights {
    pub(crate) fn new(lights: &Lights, camera_from_world: &Placement) -> Self {
        Self {
            ambient: lights.ambient.linear_rgb(),
            up: camera_from_world.direction([0.0, 0.0, 1.0]),
            main: CameraLight::new(&lights.main, camera_from_world),
            fill: lights
                .fill
                .map(|fill| CameraLight::new(&fill, camera_from_world)),
        }
    }
}

/// Pixels that wait for their light.
#[derive(Debug, Clone)]
pub(crate) struct PixelBlock {
    n: usize,
    pixel: [usize; LANES],
    instance: [u16; LANES],
    point: Vectors,
    normal: Vectors,
    albedo: Vectors,
    specular: Lanes,
    infrared: Lanes,
    to_eye: Vectors,
    cosine: Lanes,
    unlit: Vectors,
    lit: Vectors,
}

/// A pixel with its light.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LitPixel {
    pub(crate) pixel: usize,
    pub(crate) instance: u16,
    pub(crate) point: [f32; 3],
    pub(crate) radiance: Radiance,
    pub(crate) reflection: Reflection,
}

impl PixelBlock {
    pub(crate) fn new() -> Self {
        const VECTORS: Vectors = [[0.0; LANES]; 3];
        Self {
            n: 0,
            pixel: [0; LANES],
            instance: [0; LANES],
            point: VECTORS,
            normal: VECTORS,
            albedo: VECTORS,
            specular: [0.0; LANES],
            infrared: [0.0; LANES],
            to_eye: VECTORS,
            cosine: [0.0; LANES],
            unlit: VECTORS,
            lit: VECTORS,
        }
    }

    /// Adds a pixel; whether the block is full then.
    #[inline]
    pub(crate) fn push(&mut self, pixel: usize, sample: &Sample) -> bool {
        let lane = self.n % LANES;
        self.n = lane + 1;
        self.pixel[lane] = pixel;
        self.instance[lane] = sample.instance;
        for axis in 0..3 {
            self.point[axis][lane] = sample.point[axis];
            self.normal[axis][lane] = sample.normal[axis];
            self.albedo[axis][lane] = sample.albedo[axis];
        }
        self.specular[lane] = sample.specular;
        self.infrared[lane] = sample.infrared;
        self.n == LANES
    }

    /// Lights the pixels of the block, hands them out and empties it.
    pub(crate) fn flush(&mut self, lights: &CameraLights, mut take: impl FnMut(LitPixel)) {
        self.orient();
        self.surroundings(lights);
        if let Some(fill) = &lights.fill {
            let more = self.reflected(fill);
            for (sum, more) in self.unlit.iter_mut().zip(&more) {
                for (sum, more) in sum.iter_mut().zip(more) {
                    *sum += more;
                }
            }
        }
        self.lit = self.reflected(&lights.main);
        for lane in 0..self.n {
            take(self.lit_pixel(lane));
        }
        self.n = 0;
    }

    /// Unit normals, directions to the eye, and the cosines between them.
    fn orient(&mut self) {
        let [nx, ny, nz] = &mut self.normal;
        let [px, py, pz] = &self.point;
        let [ex, ey, ez] = &mut self.to_eye;
        for i in 0..LANES {
            let length = (nx[i] * nx[i] + ny[i] * ny[i] + nz[i] * nz[i]).max(1e-30);
            let per_length = 1.0 / length.sqrt();
            nx[i] *= per_length;
            ny[i] *= per_length;
            nz[i] *= per_length;
            let distance = (px[i] * px[i] + py[i] * py[i] + pz[i] * pz[i]).max(1e-30);
            let per_distance = -1.0 / distance.sqrt();
            ex[i] = px[i] * per_distance;
            ey[i] = py[i] * per_distance;
            ez[i] = pz[i] * per_distance;
            self.cosine[i] = (nx[i] * ex[i] + ny[i] * ey[i] + nz[i] * ez[i]).max(0.0);
        }
    }

    /// Light of the surroundings: full from above, half from below.
    fn surroundings(&mut self, lights: &CameraLights) {
        let ([nx, ny, nz], [ex, ey, ez]) = (&self.normal, &self.to_eye);
        let [ux, uy, uz] = lights.up;
        let (mut matte, mut mirrored) = ([0.0; LANES], [0.0; LANES]);
        for i in 0..LANES {
            let up = nx[i] * ux + ny[i] * uy + nz[i] * uz;
            let eye_up = ex[i] * ux + ey[i] * uy + ez[i] * uz;
            let mirrored_up = 2.0 * up * self.cosine[i] - eye_up;
            mirrored[i] = self.specular[i] * (0.55 + 0.45 * mirrored_up);
            matte[i] = (1.0 - self.specular[i]) * (0.75 + 0.25 * up);
        }
        for channel in 0..3 {
            let (albedo, unlit) = (&self.albedo[channel], &mut self.unlit[channel]);
            for i in 0..LANES {
                unlit[i] = (albedo[i] * matte[i] + mirrored[i]) * lights.ambient[channel];
            }
        }
    }

    /// What arrives from a light and goes on to the eye.
    fn reflected(&self, light: &CameraLight) -> Vectors {
        let ([nx, ny, nz], [ex, ey, ez]) = (&self.normal, &self.to_eye);
        let [px, py, pz] = &self.point;
        let [lx, ly, lz] = light.vector;
        let (mut matte, mut glint) = ([0.0; LANES], [0.0; LANES]);
        for i in 0..LANES {
            let x = lx - px[i] * light.is_place;
            let y = ly - py[i] * light.is_place;
            let z = lz - pz[i] * light.is_place;
            let share = 1.0 / (x * x + y * y + z * z).max(1e-4);
            let per_distance = share.sqrt();
            let cosine = (nx[i] * x + ny[i] * y + nz[i] * z).max(0.0) * per_distance;
            let hx = x * per_distance + ex[i];
            let hy = y * per_distance + ey[i];
            let hz = z * per_distance + ez[i];
            let half = (nx[i] * hx + ny[i] * hy + nz[i] * hz).max(0.0);
            // The 32nd power of the cosine to the half vector.
            let squared = half * half / (hx * hx + hy * hy + hz * hz).max(1e-30);
            let fourth = squared * squared;
            let eighth = fourth * fourth;
            let sixteenth = eighth * eighth;
            let power = sixteenth * sixteenth;
            let is_lit = if cosine > 0.0 { HIGHLIGHT } else { 0.0 };
            glint[i] = is_lit * self.specular[i] * power * share;
            matte[i] = (1.0 - self.specular[i]) * cosine * share;
        }
        let mut reflected = [[0.0; LANES]; 3];
        for channel in 0..3 {
            let (albedo, reflected) = (&self.albedo[channel], &mut reflected[channel]);
            for i in 0..LANES {
                reflected[i] = (albedo[i] * matte[i] + glint[i]) * light.rgb[channel];
            }
        }
        reflected
    }

    #[inline]
    fn lit_pixel(&self, lane: usize) -> LitPixel {
        let of = |vectors: &Vectors| [vectors[0][lane], vectors[1][lane], vectors[2][lane]];
        let byte = |share: f32| (share * 255.0 + 0.5) as u8;
        LitPixel {
            pixel: self.pixel[lane],
            instance: self.instance[lane],
            point: of(&self.point),
            radiance: Radiance {
                unlit: of(&self.unlit),
                lit: of(&self.lit),
            },
            reflection: Reflection {
                normal: of(&self.normal).map(|part| (part * 127.0) as i8),
                cos_incidence: byte(self.cosine[lane]),
                infrared: byte(infrared_albedo(
                    self.infrared[lane],
                    luminance(of(&self.albedo)),
                )),
                specular: byte(self.specular[lane]),
            },
        }
    }
}
