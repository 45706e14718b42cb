//! The nearest face in each pixel.

use crate::scanline::Span;

/// Stands for a pixel where nothing was drawn since the buffer was restored.
pub(crate) const NO_FACE: u32 = u32::MAX;

/// Pixels of a span from which vector instructions are worth their set-up.
const SPAN_MIN: usize = 8;

/// Columns of a row in which something was drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Extent {
    pub(crate) start: usize,
    pub(crate) end: usize,
}

impl Extent {
    pub(crate) const EMPTY: Self = Self {
        start: usize::MAX,
        end: 0,
    };

    #[inline]
    pub(crate) fn include(&mut self, start: usize, end: usize) {
        self.start = self.start.min(start);
        self.end = self.end.max(end);
    }

    /// The columns; none when empty.
    #[inline]
    pub(crate) fn columns(self) -> std::ops::Range<usize> {
        if self.start < self.end {
            self.start..self.end
        } else {
            0..0
        }
    }
}

/// A z-buffer of inverse depths that remembers which face is nearest.
#[derive(Debug)]
pub(crate) struct Visibility {
    width: usize,
    /// Inverse depth of the nearest face, 0 where there is none.
    pub(crate) closeness: Vec<f32>,
    /// The nearest face, [`NO_FACE`] where nothing was drawn.
    pub(crate) face: Vec<u32>,
    /// What was drawn in each row.
    pub(crate) extents: Vec<Extent>,
}

impl Visibility {
    pub(crate) fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            closeness: vec![0.0; width * height],
            face: vec![NO_FACE; width * height],
            extents: vec![Extent::EMPTY; height],
        }
    }

    pub(crate) fn clear(&mut self) {
        self.closeness.fill(0.0);
        self.face.fill(NO_FACE);
        self.extents.fill(Extent::EMPTY);
    }

    /// Draws a span; what is nearer stays, at equal depth what came first.
    #[inline]
    pub(crate) fn draw(&mut self, span: &Span, face: u32) {
        let first = span.row * self.width;
        let pixels = first + span.start..first + span.end;
        self.extents[span.row].include(span.start, span.end);
        let nearest = self.closeness[pixels.clone()]
            .iter_mut()
            .zip(&mut self.face[pixels]);
        let candidates = nearest.enumerate();
        if span.end - span.start < SPAN_MIN {
            for (i, (closeness, nearest_face)) in candidates {
                let candidate = span.closeness_at(i as i32);
                if candidate > *closeness {
                    *closeness = candidate;
                    *nearest_face = face;
                }
            }
            return;
        }
        // Choices instead of a branch, so that the loop can be vectorised.
        candidates.for_each(|(i, (closeness, nearest_face))| {
            let candidate = span.closeness_at(i as i32);
            let is_nearer = candidate > *closeness;
            *closeness = if is_nearer { candidate } else { *closeness };
            *nearest_face = if is_nearer { face } else { *nearest_face };
        });
    }
}
