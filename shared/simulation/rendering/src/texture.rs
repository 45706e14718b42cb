//! Procedural textures of large surfaces.

use crate::rounding::floor;

/// Procedural texture over mesh coordinates; it multiplies the mesh's colours.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Texture {
    /// Plain surface without texture.
    #[default]
    None,
    /// Wooden boards along x with grain.
    WoodGrain {
        /// Width of a board along y, metres.
        board_m: f32,
        /// Contrast of the grain, 0 to 1.
        contrast: f32,
    },
    /// Checkerboard in x, y and z.
    Checker {
        /// Side of a checkerboard field, metres.
        side_m: f32,
        /// Brightness of the dark fields, 0 to 1.
        dark: f32,
    },
    /// Square tiles in x and y with dark joints and slightly different shades.
    Tiles {
        /// Side of a floor tile, metres.
        side_m: f32,
        /// Width of the joint between tiles, metres.
        joint_m: f32,
    },
    /// Value noise of irregular stains and fine grain, as of plaster or cloth.
    Mottle {
        /// Size of the texture's stains, metres.
        scale_m: f32,
        /// Contrast of the texture, 0 to 1.
        contrast: f32,
    },
}

/// Largest cell index of a texture; larger ones are clamped.
const CELL_MAX: f32 = 4e6;

/// Number of points that are evaluated together (SIMD).
pub(crate) const N_POINTS: usize = 16;

type Values = [f32; N_POINTS];

impl Texture {
    /// Colour factors (red, green, blue) at points in the mesh frame.
    ///
    /// Each texture is a loop without branches, so that it becomes vector instructions. The
    /// factors of a point do not depend on the other points.
    pub(crate) fn factors(&self, [x, y, z]: &[Values; 3], factors: &mut [Values; 3]) {
        let [red, green, blue] = factors;
        let mut set = |i: usize, factors: [f32; 3]| [red[i], green[i], blue[i]] = factors;
        match *self {
            Self::None => (0..N_POINTS).for_each(|i| set(i, [1.0; 3])),
            Self::WoodGrain { board_m, contrast } => {
                let s = cells_per_m(board_m);
                (0..N_POINTS).for_each(|i| set(i, wood(x[i], y[i], z[i], s, contrast)));
            }
            Self::Checker { side_m, dark } => {
                let s = cells_per_m(side_m);
                (0..N_POINTS).for_each(|i| set(i, [checker(x[i], y[i], z[i], s, dark); 3]));
            }
            Self::Tiles { side_m, joint_m } => {
                let s = cells_per_m(side_m);
                (0..N_POINTS).for_each(|i| set(i, tile(x[i], y[i], s, joint_m)));
            }
            Self::Mottle { scale_m, contrast } => {
                let s = cells_per_m(scale_m);
                (0..N_POINTS).for_each(|i| set(i, [mottle(x[i], y[i], z[i], s, contrast); 3]));
            }
        }
    }
}

/// Number of cells per metre; an invalid size counts as 0.1 m.
fn cells_per_m(size_m: f32) -> f32 {
    if (1e-4..=1e3).contains(&size_m) {
        1.0 / size_m
    } else {
        10.0
    }
}

/// Integer part (rounded down) and fractional part, 0 to 1.
#[inline]
fn cell(x: f32) -> (i32, f32) {
    let x = x.clamp(-CELL_MAX, CELL_MAX);
    let below = floor(x);
    (below, x - below as f32)
}

#[inline]
fn checker(x: f32, y: f32, z: f32, fields_per_m: f32, dark: f32) -> f32 {
    let s = fields_per_m;
    // Offset by half a cell, so that faces at whole multiples do not flicker.
    let parity = cell(x * s).0 ^ cell(y * s).0 ^ cell(z * s + 0.5).0;
    if parity & 1 == 0 { 1.0 } else { dark }
}

#[inline]
fn mottle(x: f32, y: f32, z: f32, stains_per_m: f32, contrast: f32) -> f32 {
    let s = stains_per_m;
    let coarse = value_noise(x * s, y * s, z * s);
    let fine = value_noise(x * s * 6.3, y * s * 6.3, z * s * 6.3);
    1.0 - contrast * (0.7 * coarse + 0.3 * fine)
}

#[inline]
fn wood(x: f32, y: f32, z: f32, boards_per_m: f32, contrast: f32) -> [f32; 3] {
    let (board, within) = cell(y * boards_per_m);
    let shade = lattice_hash(board, 17, 3);
    let seam = if (0.012..=0.988).contains(&within) {
        1.0
    } else {
        0.55
    };
    // Rings: distance from an axis that wanders slowly along the board.
    let wander = value_noise(x * 1.7 + shade * 31.0, y * 6.0, z * 6.0);
    let rings = (within - 0.5) * 5.0 + wander * 4.0 + shade * 9.0;
    let ring = cell(rings).1;
    let fibre = value_noise(x * 14.0, y * 380.0, z * 380.0);
    let darkness = contrast * (0.55 * ring * ring + 0.3 * fibre) + 0.12 * shade;
    let light = seam * (1.0 - darkness);
    // Darker wood is redder.
    [
        light,
        light * (1.0 - 0.22 * darkness),
        light * (1.0 - 0.4 * darkness),
    ]
}

#[inline]
fn tile(x: f32, y: f32, tiles_per_m: f32, joint_m: f32) -> [f32; 3] {
    let (u, v) = (x * tiles_per_m, y * tiles_per_m);
    let ((i, within_u), (j, within_v)) = (cell(u), cell(v));
    let half_joint = 0.5 * joint_m * tiles_per_m;
    let to_border = |t: f32| t.min(1.0 - t);
    let is_joint = to_border(within_u).min(to_border(within_v)) < half_joint;
    let cloud = value_noise_2d(u * 5.0, v * 5.0);
    let shade = 1.0 - 0.12 * lattice_hash(i, j, 5) - 0.08 * cloud;
    [0.5, 0.49, 0.47].map(|joint| if is_joint { joint } else { shade })
}

/// Value noise in three dimensions, 0 to 1, smooth over one unit.
#[expect(
    clippy::inline_always,
    reason = "a loop with a call in it is not vectorised; bench `frame_with_moving_camera`"
)]
#[inline(always)]
fn value_noise(x: f32, y: f32, z: f32) -> f32 {
    let ([i0, i1], u) = interval(x, 0x9e37_79b1);
    let ([j0, j1], v) = interval(y, 0x85eb_ca77);
    let ([k0, k1], w) = interval(z, 0xc2b2_ae3d);
    let row = |jk: u32| mix(hash_unit(i0 ^ jk), hash_unit(i1 ^ jk), u);
    let plane = |k: u32| mix(row(j0 ^ k), row(j1 ^ k), v);
    mix(plane(k0), plane(k1), w)
}

/// Value noise in two dimensions: [`value_noise`] at z = 0.
#[inline]
fn value_noise_2d(x: f32, y: f32) -> f32 {
    let ([i0, i1], u) = interval(x, 0x9e37_79b1);
    let ([j0, j1], v) = interval(y, 0x85eb_ca77);
    let row = |j: u32| mix(hash_unit(i0 ^ j), hash_unit(i1 ^ j), u);
    mix(row(j0), row(j1), v)
}

/// Hash inputs of the two lattice points around a value, and the smoothed position between them.
#[inline]
fn interval(x: f32, factor: u32) -> ([u32; 2], f32) {
    let (below, t) = cell(x);
    let product = (below as u32).wrapping_mul(factor);
    (
        [product, product.wrapping_add(factor)],
        t * t * (3.0 - 2.0 * t),
    )
}

#[inline]
fn mix(a: f32, b: f32, t: f32) -> f32 {
    a + (b - a) * t
}

/// Pseudo-random value of a lattice point, 0 to 1.
#[inline]
fn lattice_hash(i: i32, j: i32, k: i32) -> f32 {
    hash_unit(
        (i as u32).wrapping_mul(0x9e37_79b1)
            ^ (j as u32).wrapping_mul(0x85eb_ca77)
            ^ (k as u32).wrapping_mul(0xc2b2_ae3d),
    )
}

/// Hash to 0 to 1: the highest bits of a product, which depend on all bits of its factors.
#[inline]
fn hash_unit(mut h: u32) -> f32 {
    h = (h ^ (h >> 15)).wrapping_mul(0x2c1b_3c6d);
    (h >> 8) as i32 as f32 * (1.0 / 16_777_216.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Texture factors at one of many points.
    fn factors(texture: Texture, place: [f32; 3]) -> [f32; 3] {
        let mut places = [[7.7; N_POINTS]; 3];
        let mut all = [[f32::NAN; N_POINTS]; 3];
        (0..3).for_each(|axis| places[axis][5] = place[axis]);
        texture.factors(&places, &mut all);
        all.map(|channel| channel[5])
    }

    #[test]
    fn factors_stay_between_zero_and_one_for_any_size() {
        for size in [0.1, 0.0, -1.0, f32::NAN, f32::INFINITY] {
            for texture in [
                Texture::None,
                Texture::WoodGrain {
                    board_m: size,
                    contrast: 0.5,
                },
                Texture::Checker {
                    side_m: size,
                    dark: 0.2,
                },
                Texture::Tiles {
                    side_m: size,
                    joint_m: 0.01,
                },
                Texture::Mottle {
                    scale_m: size,
                    contrast: 0.5,
                },
            ] {
                for place in [[0.0; 3], [0.31, -0.77, 0.01], [-900.0, 900.0, 3.0]] {
                    let factors = factors(texture, place);
                    assert!(factors.iter().all(|f| (0.0..=1.0).contains(f)));
                }
            }
        }
    }

    #[test]
    fn a_checker_alternates() {
        let texture = Texture::Checker {
            side_m: 0.1,
            dark: 0.2,
        };
        let at = |x: f32, y: f32| factors(texture, [x, y, 0.0])[0];
        assert_eq!(at(0.05, 0.05), at(0.15, 0.15));
        assert_ne!(at(0.05, 0.05), at(0.15, 0.05));
        assert_ne!(at(-0.05, 0.05), at(0.05, 0.05));
    }
}
