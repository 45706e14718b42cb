//! Visibility buffer: depth buffer with the index of the nearest face.

use crate::scanline::ScanlineSpan;

/// Face index of a pixel in which nothing was drawn since the buffer was restored.
pub(crate) const NO_FACE: u32 = u32::MAX;

/// Span length from which the vectorised loop pays off, pixels. Chosen.
const MIN_VECTOR_SPAN: usize = 8;

/// Range of columns in a row in which something was drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ColumnRange {
    pub(crate) start: usize,
    pub(crate) end: usize,
}

impl ColumnRange {
    pub(crate) const EMPTY: Self = Self {
        start: usize::MAX,
        end: 0,
    };

    #[inline]
    pub(crate) fn include(&mut self, start: usize, end: usize) {
        self.start = self.start.min(start);
        self.end = self.end.max(end);
    }

    /// Column indices; empty when nothing was drawn.
    #[inline]
    pub(crate) fn columns(self) -> std::ops::Range<usize> {
        if self.start < self.end {
            self.start..self.end
        } else {
            0..0
        }
    }
}

/// Depth buffer (reverse-Z) with the index of the nearest face of each pixel.
#[derive(Debug)]
pub(crate) struct VisibilityBuffer {
    width: usize,
    /// Reverse-Z depth of the nearest face; 0 in empty pixels.
    pub(crate) reverse_z: Vec<f32>,
    /// Index of the nearest face; [`NO_FACE`] in empty pixels.
    pub(crate) face: Vec<u32>,
    /// Range of columns drawn in each row.
    pub(crate) row_ranges: Vec<ColumnRange>,
}

impl VisibilityBuffer {
    pub(crate) fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            reverse_z: vec![0.0; width * height],
            face: vec![NO_FACE; width * height],
            row_ranges: vec![ColumnRange::EMPTY; height],
        }
    }

    pub(crate) fn clear(&mut self) {
        self.reverse_z.fill(0.0);
        self.face.fill(NO_FACE);
        self.row_ranges.fill(ColumnRange::EMPTY);
    }

    /// Draws a span with a depth test; at equal depth the first face wins.
    #[inline]
    pub(crate) fn draw(&mut self, span: &ScanlineSpan, face: u32) {
        let first = span.row * self.width;
        let pixels = first + span.start..first + span.end;
        self.row_ranges[span.row].include(span.start, span.end);
        let nearest = self.reverse_z[pixels.clone()]
            .iter_mut()
            .zip(&mut self.face[pixels]);
        let candidates = nearest.enumerate();
        if span.end - span.start < MIN_VECTOR_SPAN {
            for (i, (reverse_z, nearest_face)) in candidates {
                let candidate = span.reverse_z_at(i as i32);
                if candidate > *reverse_z {
                    *reverse_z = candidate;
                    *nearest_face = face;
                }
            }
            return;
        }
        // Selections instead of a branch, so that the loop can be vectorised.
        candidates.for_each(|(i, (reverse_z, nearest_face))| {
            let candidate = span.reverse_z_at(i as i32);
            let is_nearer = candidate > *reverse_z;
            *reverse_z = if is_nearer { candidate } else { *reverse_z };
            *nearest_face = if is_nearer { face } else { *nearest_face };
        });
    }
}
