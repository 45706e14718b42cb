//! Procedural colour patterns over a surface.

use crate::palette::{Rgb, contrasting, mix, shaded};
use crate::variation::Variation;
use nalgebra::{Point3, Vector3};
use std::f32::consts::TAU;

fn hash(x: i32, y: i32, z: i32, seed: u64) -> f32 {
    let mut h = seed
        ^ (x as u64).wrapping_mul(0x8da6_b343)
        ^ (y as u64).wrapping_mul(0xd816_3841_0000)
        ^ (z as u64).wrapping_mul(0xcb1a_b31f);
    h = (h ^ h >> 32).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    h = (h ^ h >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (h >> 40) as f32 / (1_u64 << 24) as f32
}

/// Value noise, 0 to 1, with blobs of about `size_m` metres.
pub(crate) fn noise(p: &Point3<f32>, size_m: f32, seed: u64) -> f32 {
    let q = p / size_m;
    let cell = q.map(f32::floor);
    let t = (q - cell).map(|t| t * t * (3.0 - 2.0 * t));
    let corner = |i: i32| {
        let bit = |axis: i32| i >> axis & 1;
        let weight = |axis: i32, t: f32| if bit(axis) == 1 { t } else { 1.0 - t };
        let value = hash(
            cell.x as i32 + bit(0),
            cell.y as i32 + bit(1),
            cell.z as i32 + bit(2),
            seed,
        );
        value * weight(0, t.x) * weight(1, t.y) * weight(2, t.z)
    };
    (0..8).map(corner).sum()
}

/// Azimuth around the z axis, 0 to 1.
pub(crate) fn azimuth(p: &Point3<f32>) -> f32 {
    (p.y.atan2(p.x) / TAU).rem_euclid(1.0)
}

/// Distance of a point from the z axis.
pub(crate) fn radius(p: &Point3<f32>) -> f32 {
    p.x.hypot(p.y)
}

/// True if a face belongs to the inside of a vessel.
pub(crate) fn is_inside(p: &Point3<f32>, n: &Vector3<f32>) -> bool {
    n.z > 0.6 || p.x * n.x + p.y * n.y < -0.2 * radius(p)
}

/// Stripe pattern: true in every other one of `n` stripes over 0 to 1.
pub(crate) fn is_stripe(t: f32, n: usize) -> bool {
    (t * 2.0 * n as f32) as usize % 2 == 1
}

/// Speckle pattern: blotches of a second colour over a share of the surface.
pub(crate) fn speckled(
    p: &Point3<f32>,
    (base, spot): (Rgb, Rgb),
    size_m: f32,
    share: f32,
    seed: u64,
) -> Rgb {
    mix(spot, base, (noise(p, size_m, seed) - share) * 8.0 + 0.5)
}

/// Mottled pattern: fine brightness variation of a natural colour.
pub(crate) fn mottled(p: &Point3<f32>, base: Rgb, size_m: f32, depth: f32, seed: u64) -> Rgb {
    shaded(base, 1.0 + depth * (noise(p, size_m, seed) - 0.5))
}

/// Wood grain along the x axis.
pub(crate) fn wood(p: &Point3<f32>, base: Rgb, seed: u64) -> Rgb {
    let stretched = Point3::new(p.x * 0.12, p.y, p.z);
    let rings = (noise(&stretched, 0.006, seed) * 5.0).fract();
    shaded(base, 0.78 + 0.3 * rings)
}

/// Printed label: a ground, a band with a title, a picture, lines of text.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PrintedLabel {
    pub(crate) ground: Rgb,
    band: Rgb,
    picture: Rgb,
    ink: Rgb,
    band_at: f32,
    band_height: f32,
    picture_at: (f32, f32),
    picture_half: (f32, f32),
    is_round: bool,
}

impl PrintedLabel {
    /// Label with random layout and colours from a palette.
    pub(crate) fn new(v: &mut Variation, palette: &[Rgb]) -> Self {
        let (ground, band) = (v.color(palette), v.color(palette));
        let is_top = v.with_probability(0.7);
        Self {
            ground,
            band: if band == ground {
                contrasting(ground)
            } else {
                band
            },
            picture: v.color(palette),
            ink: contrasting(ground),
            band_at: if is_top {
                v.between(0.7, 0.82)
            } else {
                v.between(0.12, 0.25)
            },
            band_height: v.between(0.14, 0.22),
            picture_at: (v.between(0.4, 0.6), if is_top { 0.4 } else { 0.62 }),
            picture_half: (v.between(0.2, 0.36), v.between(0.14, 0.22)),
            is_round: v.with_probability(0.6),
        }
    }

    /// Colour at a position on the label: `u` to the right and `w` upwards, 0 to 1.
    pub(crate) fn at(&self, u: f32, w: f32) -> Rgb {
        let (x, y) = (
            (u - self.picture_at.0) / self.picture_half.0,
            (w - self.picture_at.1) / self.picture_half.1,
        );
        let distance = if self.is_round {
            x.hypot(y)
        } else {
            x.abs().max(y.abs())
        };
        let from_band = (w - self.band_at).abs();
        if from_band < self.band_height / 2.0 {
            let is_letter = from_band < self.band_height * 0.28 && (0.12..0.88).contains(&u);
            let gap = (u * 9.0).fract() < 0.28;
            if is_letter && !gap {
                contrasting(self.band)
            } else {
                self.band
            }
        } else if distance < 1.0 {
            mix(self.picture, shaded(self.picture, 0.6), distance * distance)
        } else if w < 0.1 && (0.15..0.85).contains(&u) && is_stripe(w * 10.0, 2) {
            self.ink
        } else {
            self.ground
        }
    }

    /// Label wrapped twice around a body of revolution between two heights.
    pub(crate) fn wrapped(&self, p: &Point3<f32>, low: f32, high: f32) -> Rgb {
        self.at((azimuth(p) * 2.0).fract(), (p.z - low) / (high - low))
    }

    /// Label on the faces of a box of these sides, centred at the origin.
    pub(crate) fn boxed(&self, p: &Point3<f32>, n: &Vector3<f32>, sides: [f32; 3]) -> Rgb {
        let at = |axis: usize| p[axis] / sides[axis] + 0.5;
        match n.iamax() {
            0 if sides[0] < 0.6 * sides[1] || sides[1] > 0.6 * sides[0] => self.at(at(1), at(2)),
            1 if sides[1] < sides[0] || sides[0] > 0.6 * sides[1] => self.at(at(0), at(2)),
            2 => self.ground,
            _ => mix(self.ground, self.band, f32::from(at(2) > 0.75)),
        }
    }
}
