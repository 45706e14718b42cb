//! Bounding rectangle of pixels, for image-border tests.

use point_cloud::{OrganizedCloud, Point};

/// Row step of the search for the outermost columns with depth.
const ROWS_STEP: usize = 8;

/// Bounding rectangle of pixels. That of all pixels with depth is the effective image
/// border, because registered depth leaves empty margins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct PixelBounds {
    pub(crate) columns: [usize; 2],
    pub(crate) rows: [usize; 2],
}

impl PixelBounds {
    const NOTHING: Self = Self {
        columns: [usize::MAX, 0],
        rows: [usize::MAX, 0],
    };

    /// Bounding rectangle of the pixels with depth: exact in rows, and in columns from
    /// every [`ROWS_STEP`]-th row.
    pub(crate) fn of(cloud: &OrganizedCloud<'_>) -> Self {
        let mut seen = Self::NOTHING;
        let first = |row: usize| cloud.row(row).iter().position(Point::is_finite);
        let mut add_row = |row: usize| {
            if let Some(column) = first(row) {
                seen.add(column, row);
                let last = cloud.row(row).iter().rposition(Point::is_finite);
                seen.add(last.unwrap_or(column), row);
            }
        };
        let mut rows = 0..cloud.height();
        let top = rows.find(|&row| first(row).is_some());
        let bottom = rows.rfind(|&row| first(row).is_some());
        top.into_iter().chain(bottom).for_each(&mut add_row);
        (0..cloud.height()).step_by(ROWS_STEP).for_each(add_row);
        seen
    }

    #[inline]
    pub(crate) fn add(&mut self, column: usize, row: usize) {
        self.columns = [self.columns[0].min(column), self.columns[1].max(column)];
        self.rows = [self.rows[0].min(row), self.rows[1].max(row)];
    }

    /// `true` when a rectangle inside this one comes within `margin_px` of its border.
    pub(crate) fn is_touched_by(&self, inner: &Self, margin_px: usize) -> bool {
        let near = |outer: [usize; 2], inner: [usize; 2]| {
            inner[0] <= outer[0] + margin_px || inner[1] + margin_px >= outer[1]
        };
        near(self.columns, inner.columns) || near(self.rows, inner.rows)
    }
}

impl Default for PixelBounds {
    fn default() -> Self {
        Self::NOTHING
    }
}
