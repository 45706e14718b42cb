//! Procedural detail of large surfaces.

/// A pattern over the mesh's own coordinates; it multiplies the mesh's colours.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Texture {
    /// The mesh's colours as they are.
    #[default]
    None,
    /// Boards along x with grain.
    WoodGrain {
        /// Width of a board along y, metres.
        board_m: f32,
        /// Contrast of the grain, 0 to 1.
        contrast: f32,
    },
    /// Two shades in a chequered pattern, in x, y and z.
    Checker {
        /// Side of a field, metres.
        side_m: f32,
        /// Brightness of the dark fields, 0 to 1.
        dark: f32,
    },
    /// Square tiles in x and y with dark joints and slightly different shades.
    Tiles {
        /// Side of a tile, metres.
        side_m: f32,
        /// Width of a joint, metres.
        joint_m: f32,
    },
    /// Irregular stains and fine grain, as of plaster or cloth.
    Mottle {
        /// Size of the stains, metres.
        scale_m: f32,
        /// Contrast, 0 to 1.
        contrast: f32,
    },
}

impl Texture {
    /// Factors of red, green and blue at a place in the mesh's frame.
    #[inline]
    pub(crate) fn factors(&self, [x, y, z]: [f32; 3]) -> [f32; 3] {
        match *self {
            Self::None => [1.0; 3],
            Self::WoodGrain { board_m, contrast } => wood(x, y, z, cells_per_m(board_m), contrast),
            Self::Checker { side_m, dark } => {
                let s = cells_per_m(side_m);
                // Half a cell apart, so that faces at whole multiples do not flicker.
                let parity = cell(x * s) ^ cell(y * s) ^ cell(z * s + 0.5);
                [if parity & 1 == 0 { 1.0 } else { dark }; 3]
            }
            Self::Tiles { side_m, joint_m } => tile(x, y, cells_per_m(side_m), joint_m),
            Self::Mottle { scale_m, contrast } => {
                let s = cells_per_m(scale_m);
                let coarse = value_noise(x * s, y * s, z * s);
                let fine = value_noise(x * s * 6.3, y * s * 6.3, z * s * 6.3);
                [1.0 - contrast * (0.7 * coarse + 0.3 * fine); 3]
            }
        }
    }
}

/// Cells on a metre; a size that makes no sense counts as 0.1 m.
fn cells_per_m(size_m: f32) -> f32 {
    if (1e-4..=1e3).contains(&size_m) {
        1.0 / size_m
    } else {
        10.0
    }
}

/// The whole number below.
#[inline]
fn cell(x: f32) -> i32 {
    let x = x.clamp(-1e8, 1e8);
    let truncated = x as i32;
    truncated - i32::from((truncated as f32) > x)
}

fn wood(x: f32, y: f32, z: f32, boards_per_m: f32, contrast: f32) -> [f32; 3] {
    let across = y * boards_per_m;
    let board = cell(across);
    let shade = lattice(board, 17, 3);
    let within = across - board as f32;
    let seam = if (0.012..=0.988).contains(&within) {
        1.0
    } else {
        0.55
    };
    // Rings: distance from an axis that wanders slowly along the board.
    let wander = value_noise(x * 1.7 + shade * 31.0, y * 6.0, z * 6.0);
    let rings = (within - 0.5) * 5.0 + wander * 4.0 + shade * 9.0;
    let ring = rings - cell(rings) as f32;
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

fn tile(x: f32, y: f32, tiles_per_m: f32, joint_m: f32) -> [f32; 3] {
    let (u, v) = (x * tiles_per_m, y * tiles_per_m);
    let (i, j) = (cell(u), cell(v));
    let half_joint = 0.5 * joint_m * tiles_per_m;
    let border = |t: f32| t < half_joint || t > 1.0 - half_joint;
    if border(u - i as f32) || border(v - j as f32) {
        return [0.5, 0.49, 0.47];
    }
    let cloud = value_noise(u * 5.0, v * 5.0, 0.0);
    [1.0 - 0.12 * lattice(i, j, 5) - 0.08 * cloud; 3]
}

/// Noise between 0 and 1 that changes smoothly over one unit.
fn value_noise(x: f32, y: f32, z: f32) -> f32 {
    let (i, j, k) = (cell(x), cell(y), cell(z));
    let smooth = |t: f32| t * t * (3.0 - 2.0 * t);
    let (u, v, w) = (
        smooth(x - i as f32),
        smooth(y - j as f32),
        smooth(z - k as f32),
    );
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let row = |dj: i32, dk: i32| {
        let (j, k) = (j.wrapping_add(dj), k.wrapping_add(dk));
        mix(lattice(i, j, k), lattice(i.wrapping_add(1), j, k), u)
    };
    mix(
        mix(row(0, 0), row(1, 0), v),
        mix(row(0, 1), row(1, 1), v),
        w,
    )
}

/// A number between 0 and 1 that belongs to a lattice point.
#[inline]
fn lattice(i: i32, j: i32, k: i32) -> f32 {
    let mut h = (i as u32).wrapping_mul(0x9e37_79b1)
        ^ (j as u32).wrapping_mul(0x85eb_ca77)
        ^ (k as u32).wrapping_mul(0xc2b2_ae3d);
    h = (h ^ (h >> 15)).wrapping_mul(0x2c1b_3c6d);
    h = (h ^ (h >> 12)).wrapping_mul(0x297a_2d39);
    ((h ^ (h >> 15)) >> 8) as f32 / 16_777_216.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_stay_between_zero_and_one_whatever_the_size() {
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
                    let factors = texture.factors(place);
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
        let at = |x: f32, y: f32| texture.factors([x, y, 0.0])[0];
        assert_eq!(at(0.05, 0.05), at(0.15, 0.15));
        assert_ne!(at(0.05, 0.05), at(0.15, 0.05));
        assert_ne!(at(-0.05, 0.05), at(0.05, 0.05));
    }
}
