//! Scanline rasterisation of triangles.

use crate::projection::ScreenCorner;
use crate::rounding::ceil_f64;

/// Limit to which column and row numbers are clamped, pixels.
const PIXEL_MAX: f64 = 1e6;

/// Side of a face that is drawn (face culling).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum FaceSide {
    /// Faces that look towards the viewpoint.
    Front,
    /// Faces that look away from the viewpoint.
    Back,
}

/// Span of pixels in one row, with interpolated reverse-Z depth.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ScanlineSpan {
    pub(crate) row: usize,
    /// First column of the span.
    pub(crate) start: usize,
    /// Column after the last one of the span; greater than the first.
    pub(crate) end: usize,
    /// Reverse-Z depth in the centre of the span's first pixel.
    reverse_z: f32,
    step: f32,
    reverse_z_min: f32,
    reverse_z_max: f32,
}

impl ScanlineSpan {
    /// Reverse-Z depth in the i-th pixel of the span.
    ///
    /// Clamped to the corners' values: a face seen nearly edge-on has a huge step, and a pixel
    /// centre may be outside by a rounding error.
    #[inline]
    pub(crate) fn reverse_z_at(&self, i: i32) -> f32 {
        (self.reverse_z + self.step * i as f32)
            .max(self.reverse_z_min)
            .min(self.reverse_z_max)
    }
}

/// Triangle edge between two corners, upper first.
struct Edge {
    x: f64,
    y: f64,
    slope: f64,
}

impl Edge {
    #[inline]
    fn new(upper: &ScreenCorner, lower: &ScreenCorner) -> Self {
        let (x, y) = (f64::from(upper.x), f64::from(upper.y));
        Self {
            x,
            y,
            slope: (f64::from(lower.x) - x) / (f64::from(lower.y) - y),
        }
    }

    /// First pixel whose centre is not left of the edge.
    #[inline]
    fn column(&self, row: i32) -> i32 {
        ceil(self.x + (f64::from(row) - self.y) * self.slope)
    }
}

/// Rasterises a triangle: calls `visit` with the span of each row whose pixel centres are inside.
///
/// A pixel on a common edge belongs to exactly one of the two faces (top-left rule): both compute
/// the edge from its upper corner, left edges are inside, right ones outside, and the upper end
/// of an edge is inside. Rows and columns are within `size` (width, height). Corners must be
/// finite.
#[inline]
pub(crate) fn rasterize(
    corners: [&ScreenCorner; 3],
    side: FaceSide,
    size: (usize, usize),
    mut visit: impl FnMut(ScanlineSpan),
) {
    let doubled_area = doubled_area(corners);
    let is_shown = match side {
        FaceSide::Front => doubled_area < 0.0,
        FaceSide::Back => doubled_area > 0.0,
    };
    if !is_shown {
        return;
    }
    let [upper, middle, lower] = by_row(corners);
    let first_row = ceil(f64::from(upper.y)).max(0);
    let end_row = ceil(f64::from(lower.y)).min(size.1 as i32);
    if first_row >= end_row || !may_cover_a_column(corners, size.0) {
        return;
    }
    let mut plane = None;
    let long = Edge::new(upper, lower);
    let is_middle_right = is_right_of(middle, upper, lower);
    let middle_row = ceil(f64::from(middle.y)).clamp(first_row, end_row);
    for (ends, rows) in [
        ((upper, middle), first_row..middle_row),
        ((middle, lower), middle_row..end_row),
    ] {
        if rows.is_empty() {
            continue;
        }
        let short = Edge::new(ends.0, ends.1);
        for row in rows {
            let (l, s) = (long.column(row), short.column(row));
            let (start, end) = if is_middle_right { (l, s) } else { (s, l) };
            let (start, end) = (start.max(0), end.min(size.0 as i32));
            if start < end {
                // Many small faces cover no pixel centre and need no plane.
                let plane = plane.get_or_insert_with(|| DepthPlane::new(corners, doubled_area));
                visit(plane.span(row as usize, start as usize, end as usize));
            }
        }
    }
}

/// Doubled signed area; negative when counter-clockwise to the viewer, since rows go down.
#[inline]
fn doubled_area([a, b, c]: [&ScreenCorner; 3]) -> f64 {
    let (x, y) = (f64::from(a.x), f64::from(a.y));
    (f64::from(b.x) - x) * (f64::from(c.y) - y) - (f64::from(c.x) - x) * (f64::from(b.y) - y)
}

/// Sorts the corners from top to bottom.
#[inline]
fn by_row([a, b, c]: [&ScreenCorner; 3]) -> [&ScreenCorner; 3] {
    let (a, b) = if b.y < a.y { (b, a) } else { (a, b) };
    let (b, c) = if c.y < b.y { (c, b) } else { (b, c) };
    let (a, b) = if b.y < a.y { (b, a) } else { (a, b) };
    [a, b, c]
}

/// True if a column centre of the image is between the outermost corners.
#[inline]
fn may_cover_a_column([a, b, c]: [&ScreenCorner; 3], width: usize) -> bool {
    let first = ceil(f64::from(a.x.min(b.x).min(c.x))).max(0);
    let end = ceil(f64::from(a.x.max(b.x).max(c.x))).min(width as i32);
    first < end
}

/// True if `middle` is right of the line from `upper` to `lower`.
#[inline]
fn is_right_of(middle: &ScreenCorner, upper: &ScreenCorner, lower: &ScreenCorner) -> bool {
    let (x, y) = (f64::from(upper.x), f64::from(upper.y));
    (f64::from(middle.x) - x) * (f64::from(lower.y) - y)
        > (f64::from(lower.x) - x) * (f64::from(middle.y) - y)
}

/// Reverse-Z depth as a linear function of the pixel.
struct DepthPlane {
    x: f64,
    y: f64,
    reverse_z: f64,
    per_column: f64,
    per_row: f64,
    reverse_z_min: f32,
    reverse_z_max: f32,
}

impl DepthPlane {
    #[inline]
    fn new([a, b, c]: [&ScreenCorner; 3], doubled_area: f64) -> Self {
        let (x, y, w) = (f64::from(a.x), f64::from(a.y), f64::from(a.reverse_z));
        let (x1, y1) = (f64::from(b.x) - x, f64::from(b.y) - y);
        let (x2, y2) = (f64::from(c.x) - x, f64::from(c.y) - y);
        let (w1, w2) = (f64::from(b.reverse_z) - w, f64::from(c.reverse_z) - w);
        let scale = 1.0 / doubled_area;
        Self {
            x,
            y,
            reverse_z: w,
            per_column: (w1 * y2 - w2 * y1) * scale,
            per_row: (w2 * x1 - w1 * x2) * scale,
            reverse_z_min: a.reverse_z.min(b.reverse_z).min(c.reverse_z),
            reverse_z_max: a.reverse_z.max(b.reverse_z).max(c.reverse_z),
        }
    }

    #[inline]
    fn span(&self, row: usize, start: usize, end: usize) -> ScanlineSpan {
        let reverse_z = self.reverse_z
            + self.per_column * (start as f64 - self.x)
            + self.per_row * (row as f64 - self.y);
        ScanlineSpan {
            row,
            start,
            end,
            reverse_z: reverse_z as f32,
            step: self.per_column as f32,
            reverse_z_min: self.reverse_z_min,
            reverse_z_max: self.reverse_z_max,
        }
    }
}

/// Rounds up to an integer, clamped to [`PIXEL_MAX`].
#[inline]
fn ceil(x: f64) -> i32 {
    ceil_f64(x.clamp(-PIXEL_MAX, PIXEL_MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner(x: f32, y: f32) -> ScreenCorner {
        ScreenCorner {
            x,
            y,
            reverse_z: 1.0,
        }
    }

    /// Coverage count of each pixel of a 40 x 40 image, both face sides drawn.
    fn coverage(triangles: &[[ScreenCorner; 3]]) -> Vec<u32> {
        let mut n = vec![0; 1600];
        for triangle in triangles {
            for side in [FaceSide::Front, FaceSide::Back] {
                rasterize(triangle.each_ref(), side, (40, 40), |span| {
                    n[span.row * 40 + span.start..span.row * 40 + span.end]
                        .iter_mut()
                        .for_each(|n| *n += 1);
                });
            }
        }
        n
    }

    #[test]
    fn a_fan_covers_each_pixel_of_its_outline_exactly_once() {
        for shift in [0.0, 0.25, 0.37] {
            let center = corner(20.0 + shift, 19.0 - shift);
            let rim: Vec<_> = (0..7)
                .map(|i| {
                    let angle = i as f32 * std::f32::consts::TAU / 7.0;
                    corner(20.0 + 15.0 * angle.cos(), 20.0 + 15.0 * angle.sin())
                })
                .collect();
            let fan: Vec<_> = (0..7).map(|i| [center, rim[i], rim[(i + 1) % 7]]).collect();
            let covered = coverage(&fan);
            assert!(covered.iter().all(|&n| n <= 1));
            for (i, &n) in covered.iter().enumerate() {
                let distance = ((i % 40) as f32 - 20.0).hypot((i / 40) as f32 - 20.0);
                if distance < 13.0 {
                    assert_eq!(n, 1, "pixel {i}");
                }
            }
        }
    }

    #[test]
    fn whole_coordinates_are_covered_once_by_two_halves_of_a_square() {
        let [a, b, c, d] =
            [(3.0, 4.0), (13.0, 4.0), (13.0, 14.0), (3.0, 14.0)].map(|(x, y)| corner(x, y));
        let covered = coverage(&[[a, b, c], [a, c, d]]);
        assert_eq!(covered.iter().sum::<u32>(), 100);
        assert!(covered.iter().all(|&n| n <= 1));
    }

    #[test]
    fn huge_and_degenerate_triangles_do_not_panic() {
        let far = [corner(-1e30, -1e30), corner(1e30, -1e30), corner(0.0, 1e30)];
        assert!(coverage(&[far]).iter().all(|&n| n <= 1));
        let line = [corner(1.0, 1.0), corner(20.0, 20.0), corner(39.0, 39.0)];
        assert_eq!(coverage(&[line]).iter().sum::<u32>(), 0);
    }
}
