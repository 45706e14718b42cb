//! Dimensions of the table, and of what stands on it: bin, shelf and tray.

use nalgebra::Point3;

/// Dimensions of the table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TableDimensions {
    /// Sides along world x and y, metres.
    pub size_m: [f64; 2],
    /// Height of the table top, metres.
    pub height_m: f64,
}

impl Default for TableDimensions {
    fn default() -> Self {
        Self {
            size_m: [1.3, 0.8],
            height_m: 0.72,
        }
    }
}

impl TableDimensions {
    /// Middle of the table top, world frame.
    pub fn middle(&self) -> Point3<f64> {
        Point3::new(0.0, 0.0, self.height_m)
    }
}

/// Pattern of a table top.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TablePattern {
    /// Boards with grain.
    #[default]
    WoodGrain,
    /// Irregular stains, as of linoleum or cloth.
    Mottle,
    /// Plain colour.
    Plain,
}

/// Colour and pattern of the table top.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TableFinish {
    /// sRGB colour of the table.
    pub color: [u8; 3],
    /// Pattern of the table top.
    pub pattern: TablePattern,
    /// Contrast of the pattern, percent.
    pub contrast_percent: u8,
}

impl Default for TableFinish {
    /// Oak.
    fn default() -> Self {
        Self {
            color: [178, 136, 92],
            pattern: TablePattern::WoodGrain,
            contrast_percent: 35,
        }
    }
}

/// Open bin (box without a lid) in the middle of the table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bin {
    /// Inner sides along world x, y and z, metres.
    pub inner_size_m: [f64; 3],
}

impl Default for Bin {
    fn default() -> Self {
        Self {
            inner_size_m: [0.42, 0.34, 0.14],
        }
    }
}

/// Shelf: boards over the table, as large as it, between two sides and a back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shelf {
    /// Number of boards over the table.
    pub n_boards: usize,
    /// Distance from the top of one board to the top of the next, metres.
    pub spacing_m: f64,
}

impl Default for Shelf {
    fn default() -> Self {
        Self {
            n_boards: 2,
            spacing_m: 0.34,
        }
    }
}

impl Shelf {
    /// Thickness of boards, sides and back, metres.
    pub const BOARD_M: f64 = 0.018;

    /// Heights of the boards over the table, metres, from the lowest.
    pub fn board_heights_m(&self) -> impl Iterator<Item = f64> + use<> {
        let spacing_m = self.spacing_m;
        (1..=self.n_boards).map(move |board| board as f64 * spacing_m)
    }

    /// Height of the highest board over the table, metres.
    pub fn height_m(&self) -> f64 {
        self.n_boards as f64 * self.spacing_m
    }
}

/// Tray with a rim in the middle of the table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tray {
    /// Inner sides of the floor along world x and y, metres.
    pub inner_size_m: [f64; 2],
    /// Height of the floor over the table, metres.
    pub floor_m: f64,
    /// Height of the rim over the floor, metres.
    pub rim_m: f64,
}

impl Default for Tray {
    fn default() -> Self {
        Self {
            inner_size_m: [0.46, 0.34],
            floor_m: 0.012,
            rim_m: 0.03,
        }
    }
}

impl Tray {
    /// Width of the rim, metres.
    pub const RIM_WIDTH_M: f64 = 0.012;
}
