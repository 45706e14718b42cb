//! Procedural textures of the synthetic surfaces.

use nalgebra::Point3;

/// Procedural colour as a function of the position on a surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Paint {
    pattern: Pattern,
    /// Red, green, blue of the pattern's even and odd cells.
    colors: [[u8; 3]; 2],
}

/// Region of a paint's second colour.
#[derive(Debug, Clone, Copy)]
pub(super) enum Pattern {
    /// Plain paint: no second colour.
    Plain,
    /// Every other band of this height, metres.
    Bands(f64),
    /// Every other cube of this side, metres.
    Checks(f64),
    /// Wood grain: veins along x.
    Wood,
}

/// Side of the cells of slightly different brightness, metres. Chosen.
const SPECKLE_M: f64 = 0.006;
/// Offset of the cell grid, as a share of a cell, so that no face lies on a cell border.
const CELL_OFFSET: f64 = 0.37;

impl Paint {
    pub(super) const fn new(pattern: Pattern, colors: [[u8; 3]; 2]) -> Self {
        Self { pattern, colors }
    }

    pub(super) const fn plain(color: [u8; 3]) -> Self {
        Self::new(Pattern::Plain, [color; 2])
    }

    /// Red, green, blue (0 to 255) at a point in the object frame.
    pub(super) fn color_at(&self, p: &Point3<f64>) -> [f64; 3] {
        let cell = |x: f64, side: f64| (x / side + CELL_OFFSET).floor() as i64;
        let blend = match self.pattern {
            Pattern::Plain => 0.0,
            Pattern::Bands(height) => (cell(p.z, height) & 1) as f64,
            Pattern::Checks(side) => {
                ((cell(p.x, side) + cell(p.y, side) + cell(p.z, side)) & 1) as f64
            }
            Pattern::Wood => 0.5 + 0.5 * (130.0 * p.y + 4.0 * (3.1 * p.x + 9.0 * p.y).sin()).sin(),
        };
        let speckle = [p.x, p.y, p.z].iter().fold(0, |bits, x| {
            random::counter_based(bits ^ cell(*x, SPECKLE_M) as u64)
        });
        let brightness = 0.95 + 0.1 * random::unit(speckle);
        let [even, odd] = self.colors;
        std::array::from_fn(|i| {
            brightness * ((1.0 - blend) * f64::from(even[i]) + blend * f64::from(odd[i]))
        })
    }
}
