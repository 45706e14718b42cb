//! Blinn–Phong shading of a pixel block.
//!
//! Lambertian diffuse reflection, Blinn's (1977) half-vector highlight, and ambient light from
//! above and below; all in the camera frame.

use crate::lanes::{Lanes, N_LANES, VectorLanes};
use crate::lights::{Light, LightPlacement, Lights};
use crate::projection::RigidTransformF32;

/// Strength of the highlight on a perfect mirror, relative to the light. Chosen.
const HIGHLIGHT_GAIN: f32 = 3.0;

/// Light source in the camera frame.
#[derive(Debug, Clone, Copy)]
struct CameraLight {
    rgb: [f32; 3],
    /// Unit direction to the light, or its position in metres.
    vector: [f32; 3],
    /// 1 for a point light, 0 for a directional light.
    is_point: f32,
}

impl CameraLight {
    fn new(light: &Light, camera_from_world: &RigidTransformF32) -> Self {
        let (vector, is_point) = match light.placement {
            LightPlacement::Directional(to_light) => {
                let to_light = to_light.try_normalize(1e-9).unwrap_or_default();
                (camera_from_world.direction(to_light.into()), 0.0)
            }
            LightPlacement::Point(lamp) => (camera_from_world.point(lamp.coords.into()), 1.0),
        };
        Self {
            rgb: light.illuminant.linear_rgb(),
            vector: vector.map(|part| if part.is_finite() { part } else { 0.0 }),
            is_point,
        }
    }
}

/// All light sources in the camera frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CameraLights {
    ambient: [f32; 3],
    up: [f32; 3],
    main: CameraLight,
    fill: Option<CameraLight>,
}

impl CameraLights {
    pub(crate) fn new(lights: &Lights, camera_from_world: &RigidTransformF32) -> Self {
        Self {
            ambient: lights.ambient_rgb(),
            up: camera_from_world.direction([0.0, 0.0, 1.0]),
            main: CameraLight::new(&lights.main, camera_from_world),
            fill: lights
                .fill
                .map(|fill| CameraLight::new(&fill, camera_from_world)),
        }
    }
}

/// Lighting results of a pixel block, linear sRGB.
#[derive(Debug, Clone)]
pub(crate) struct Lighting {
    to_eye: VectorLanes,
    /// Cosine between normal and direction to the camera, not negative.
    pub(crate) cosine: Lanes,
    /// Radiance of the pixels without the main light.
    pub(crate) unlit: VectorLanes,
    /// Radiance that the main light adds where no shadow falls.
    pub(crate) lit: VectorLanes,
}

impl Lighting {
    pub(crate) fn new() -> Self {
        const VECTORS: VectorLanes = [[0.0; N_LANES]; 3];
        Self {
            to_eye: VECTORS,
            cosine: [0.0; N_LANES],
            unlit: VECTORS,
            lit: VECTORS,
        }
    }

    /// Computes the lighting of all lanes from points and surfaces; normalises `normal` in place.
    pub(crate) fn compute(
        &mut self,
        lights: &CameraLights,
        point: &VectorLanes,
        normal: &mut VectorLanes,
        albedo: &VectorLanes,
        specular: &Lanes,
    ) {
        self.orient(point, normal);
        let surface = SurfaceLanes {
            point,
            normal,
            albedo,
            specular,
            to_eye: &self.to_eye,
        };
        surface.surroundings(lights, &self.cosine, &mut self.unlit);
        if let Some(fill) = &lights.fill {
            surface.add_reflected(fill, &mut self.unlit);
        }
        self.lit = [[0.0; N_LANES]; 3];
        surface.add_reflected(&lights.main, &mut self.lit);
    }

    /// Normalises the normals and computes the view directions and the cosines between them.
    fn orient(&mut self, point: &VectorLanes, normal: &mut VectorLanes) {
        let [nx, ny, nz] = normal;
        let [px, py, pz] = point;
        let [ex, ey, ez] = &mut self.to_eye;
        for i in 0..N_LANES {
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
}

/// Surface inputs of the lighting, lane by lane.
struct SurfaceLanes<'a> {
    point: &'a VectorLanes,
    normal: &'a VectorLanes,
    albedo: &'a VectorLanes,
    specular: &'a Lanes,
    to_eye: &'a VectorLanes,
}

impl SurfaceLanes<'_> {
    /// Ambient hemisphere light: full from above, half from below.
    fn surroundings(&self, lights: &CameraLights, cosine: &Lanes, unlit: &mut VectorLanes) {
        let ([nx, ny, nz], [ex, ey, ez]) = (self.normal, self.to_eye);
        let [ux, uy, uz] = lights.up;
        let (mut matte, mut mirrored) = ([0.0; N_LANES], [0.0; N_LANES]);
        for i in 0..N_LANES {
            let up = nx[i] * ux + ny[i] * uy + nz[i] * uz;
            let eye_up = ex[i] * ux + ey[i] * uy + ez[i] * uz;
            let mirrored_up = 2.0 * up * cosine[i] - eye_up;
            mirrored[i] = self.specular[i] * (0.55 + 0.45 * mirrored_up);
            matte[i] = (1.0 - self.specular[i]) * (0.75 + 0.25 * up);
        }
        for channel in 0..3 {
            let (albedo, unlit) = (&self.albedo[channel], &mut unlit[channel]);
            for i in 0..N_LANES {
                unlit[i] = (albedo[i] * matte[i] + mirrored[i]) * lights.ambient[channel];
            }
        }
    }

    /// Adds the diffuse and specular reflection of one light source.
    fn add_reflected(&self, light: &CameraLight, sum: &mut VectorLanes) {
        let ([nx, ny, nz], [ex, ey, ez]) = (self.normal, self.to_eye);
        let [px, py, pz] = self.point;
        let [lx, ly, lz] = light.vector;
        let (mut matte, mut glint) = ([0.0; N_LANES], [0.0; N_LANES]);
        for i in 0..N_LANES {
            let x = lx - px[i] * light.is_point;
            let y = ly - py[i] * light.is_point;
            let z = lz - pz[i] * light.is_point;
            let share = 1.0 / (x * x + y * y + z * z).max(1e-4);
            let per_distance = share.sqrt();
            let cosine = (nx[i] * x + ny[i] * y + nz[i] * z).max(0.0) * per_distance;
            let hx = x * per_distance + ex[i];
            let hy = y * per_distance + ey[i];
            let hz = z * per_distance + ez[i];
            matte[i] = (1.0 - self.specular[i]) * cosine * share;
            let half = (nx[i] * hx + ny[i] * hy + nz[i] * hz).max(0.0);
            // The 32nd power of the cosine to the half vector.
            let squared = half * half / (hx * hx + hy * hy + hz * hz).max(1e-30);
            let fourth = squared * squared;
            let eighth = fourth * fourth;
            let sixteenth = eighth * eighth;
            let power = sixteenth * sixteenth;
            let is_lit = if cosine > 0.0 { HIGHLIGHT_GAIN } else { 0.0 };
            glint[i] = is_lit * self.specular[i] * power * share;
        }
        for channel in 0..3 {
            let (albedo, sum) = (&self.albedo[channel], &mut sum[channel]);
            for i in 0..N_LANES {
                sum[i] += (albedo[i] * matte[i] + glint[i]) * light.rgb[channel];
            }
        }
    }
}
