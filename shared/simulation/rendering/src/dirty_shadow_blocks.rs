//! Dirty blocks of the shadow map: regions that moving instances have changed.

use crate::projection::ScreenCorner;
use crate::scanline::ScanlineSpan;
use crate::shadow_grid::{BLOCK, MAP_SIDE, N_BLOCKS};
use crate::visibility_buffer::ColumnRange;

/// Number of cells before a coordinate's own that the filter reads.
const BEFORE: usize = 1;
/// Number of cells after a coordinate's own that the filter reads.
const AFTER: usize = 2;

/// Bounding rectangle of shadow map cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CellRectangle {
    low: [f32; 2],
    high: [f32; 2],
}

impl CellRectangle {
    pub(crate) const EMPTY: Self = Self {
        low: [f32::INFINITY; 2],
        high: [f32::NEG_INFINITY; 2],
    };

    #[inline]
    pub(crate) fn include(&mut self, [x, y]: [f32; 2]) {
        self.low = [self.low[0].min(x), self.low[1].min(y)];
        self.high = [self.high[0].max(x), self.high[1].max(y)];
    }
}

/// Dirty flags of the blocks in which the shadow filter reads a newly drawn cell.
#[derive(Debug)]
pub(crate) struct DirtyShadowBlocks {
    reached: Vec<bool>,
    /// Columns of each row that the current instance has drawn.
    drawn: Vec<ColumnRange>,
}

impl DirtyShadowBlocks {
    pub(crate) fn new() -> Self {
        Self {
            reached: vec![false; N_BLOCKS * N_BLOCKS],
            drawn: vec![ColumnRange::EMPTY; MAP_SIDE],
        }
    }

    pub(crate) fn clear(&mut self) {
        self.reached.fill(false);
    }

    /// Records a span of the current instance.
    #[inline]
    pub(crate) fn draw(&mut self, span: &ScanlineSpan) {
        self.drawn[span.row].include(span.start, span.end);
    }

    /// Marks the blocks of the current instance. In each row, everything between its outermost
    /// pixels counts as drawn.
    pub(crate) fn end_instance(&mut self) {
        let block = |cell: usize| cell.min(MAP_SIDE - 1) / BLOCK;
        for (row, drawn) in self.drawn.iter_mut().enumerate() {
            let columns = drawn.columns();
            if columns.is_empty() {
                continue;
            }
            let start = block(columns.start.saturating_sub(AFTER));
            let end = block(columns.end - 1 + BEFORE) + 1;
            for row in block(row.saturating_sub(AFTER))..=block(row + BEFORE) {
                self.reached[row * N_BLOCKS + start..row * N_BLOCKS + end].fill(true);
            }
            *drawn = ColumnRange::EMPTY;
        }
    }

    /// True if the light at a shadow map coordinate may have changed.
    #[inline]
    pub(crate) fn contains(&self, place: &ScreenCorner) -> bool {
        let side = MAP_SIDE as f32;
        let is_inside = place.x >= 0.0 && place.y >= 0.0 && place.x < side && place.y < side;
        is_inside && self.reached[place.y as usize / BLOCK * N_BLOCKS + place.x as usize / BLOCK]
    }

    /// True if the light anywhere in a rectangle may have changed.
    pub(crate) fn touches(&self, cells: &CellRectangle) -> bool {
        let block = |cell: f32| (cell.clamp(0.0, MAP_SIDE as f32 - 1.0)) as usize / BLOCK;
        (block(cells.low[1])..=block(cells.high[1])).any(|row| {
            let first = row * N_BLOCKS;
            self.reached
                .get(first + block(cells.low[0])..=first + block(cells.high[0]))
                .is_some_and(|blocks| blocks.contains(&true))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drawing_marks_only_neighbouring_blocks_dirty() {
        let corner = |x: f32, y: f32| ScreenCorner {
            x,
            y,
            reverse_z: 1.0,
        };
        let mut dirty_blocks = DirtyShadowBlocks::new();
        let triangle = [
            corner(100.0, 100.0),
            corner(100.0, 104.0),
            corner(104.0, 100.0),
        ];
        let mut n_spans = 0;
        crate::scanline::rasterize(
            triangle.each_ref(),
            crate::scanline::FaceSide::Front,
            (MAP_SIDE, MAP_SIDE),
            |span| {
                dirty_blocks.draw(&span);
                n_spans += 1;
            },
        );
        dirty_blocks.end_instance();
        assert!(n_spans > 0);
        assert!(
            dirty_blocks.contains(&corner(101.0, 101.0))
                && dirty_blocks.contains(&corner(98.5, 98.5))
        );
        assert!(
            !dirty_blocks.contains(&corner(115.0, 101.0))
                && !dirty_blocks.contains(&corner(-1.0, 101.0))
        );
        let mut near = CellRectangle::EMPTY;
        near.include([20.0, 90.0]);
        assert!(!dirty_blocks.touches(&near));
        near.include([97.0, 110.0]);
        assert!(dirty_blocks.touches(&near));
    }
}
