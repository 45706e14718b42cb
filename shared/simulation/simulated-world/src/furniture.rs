//! Dimensions of the table and the bin.

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
