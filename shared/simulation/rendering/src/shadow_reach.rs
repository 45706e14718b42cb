//! Which parts of the shadow map have changed.

use crate::projection::ScreenCorner;
use crate::scanline::Span;
use crate::shadow_map::SIDE;
use crate::visibility::Extent;

/// Cells on a side of a block.
const BLOCK: usize = 4;
/// Cells before and after a place's own that the filter reads.
const BEFORE: usize = 1;
const AFTER: usize = 2;
/// Blocks on a side of the map.
const N_BLOCKS: usize = SIDE / BLOCK;

/// A rectangle of cells.
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

/// Blocks of cells at which the filter reads something that was drawn.
#[derive(Debug)]
pub(crate) struct ShadowReach {
    reached: Vec<bool>,
    /// What was drawn of the present instance in each row.
    drawn: Vec<Extent>,
}

impl ShadowReach {
    pub(crate) fn new() -> Self {
        Self {
            reached: vec![false; N_BLOCKS * N_BLOCKS],
            drawn: vec![Extent::EMPTY; SIDE],
        }
    }

    pub(crate) fn clear(&mut self) {
        self.reached.fill(false);
    }

    /// Draws pixels of an instance.
    #[inline]
    pub(crate) fn draw(&mut self, span: &Span) {
        self.drawn[span.row].include(span.start, span.end);
    }

    /// Ends an instance: what lies between its outermost pixels of a row counts as drawn.
    pub(crate) fn end_instance(&mut self) {
        let block = |cell: usize| cell.min(SIDE - 1) / BLOCK;
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
            *drawn = Extent::EMPTY;
        }
    }

    /// Whether light may have changed at a place of the map.
    #[inline]
    pub(crate) fn contains(&self, place: &ScreenCorner) -> bool {
        let side = SIDE as f32;
        let is_inside = place.x >= 0.0 && place.y >= 0.0 && place.x < side && place.y < side;
        is_inside && self.reached[place.y as usize / BLOCK * N_BLOCKS + place.x as usize / BLOCK]
    }

    /// Whether light may have changed anywhere in a rectangle.
    pub(crate) fn touches(&self, cells: &CellRectangle) -> bool {
        let block = |cell: f32| (cell.clamp(0.0, SIDE as f32 - 1.0)) as usize / BLOCK;
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
    fn what_is_drawn_reaches_its_neighbours_only() {
        let corner = |x: f32, y: f32| ScreenCorner {
            x,
            y,
            closeness: 1.0,
        };
        let mut reach = ShadowReach::new();
        let triangle = [
            corner(100.0, 100.0),
            corner(100.0, 104.0),
            corner(104.0, 100.0),
        ];
        let mut n_spans = 0;
        crate::scanline::scan(
            triangle.each_ref(),
            crate::scanline::Side::Front,
            (SIDE, SIDE),
            |span| {
                reach.draw(&span);
                n_spans += 1;
            },
        );
        reach.end_instance();
        assert!(n_spans > 0);
        assert!(reach.contains(&corner(101.0, 101.0)) && reach.contains(&corner(98.5, 98.5)));
        assert!(!reach.contains(&corner(115.0, 101.0)) && !reach.contains(&corner(-1.0, 101.0)));
        let mut near = CellRectangle::EMPTY;
        near.include([20.0, 90.0]);
        assert!(!reach.touches(&near));
        near.include([97.0, 110.0]);
        assert!(reach.touches(&near));
    }
}
