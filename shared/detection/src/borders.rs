//! Where two parts of a cluster meet.

use point_cloud::Point;

/// A border with less than this share of creases lies within one object.
const CREASE_SHARE_MIN: f64 = 0.75;

/// A step of depth beyond this, metres at 1 m, growing with squared depth, is
/// an outline: it says neither that the parts are one nor that they are two.
const STEP_M: f32 = 0.006;

/// What two neighbouring pixels of different parts say.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Evidence {
    Smooth,
    Crease,
}

/// The pixel pairs along all borders. Reused from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct Borders {
    pairs: Vec<(u32, u32, Evidence)>,
}

impl Borders {
    pub(crate) fn clear(&mut self) {
        self.pairs.clear();
    }

    /// Adds two neighbouring pixels of different parts.
    #[inline]
    pub(crate) fn add(&mut self, parts: [u32; 2], points: [&Point; 2], is_crease: bool) {
        let [a, b] = points.map(|point| point.z);
        if (a - b).abs() <= STEP_M * a * a {
            let evidence = if is_crease { Evidence::Crease } else { Evidence::Smooth };
            self.pairs.push((parts[0].min(parts[1]), parts[0].max(parts[1]), evidence));
        }
    }

    /// Calls `join` for each two parts whose border is mostly smooth, in the
    /// order of their numbers.
    pub(crate) fn join_smooth(&mut self, mut join: impl FnMut(u32, u32)) {
        self.pairs.sort_unstable();
        for border in self.pairs.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1)) {
            let n_creases = border.iter().filter(|pair| pair.2 == Evidence::Crease).count();
            if (n_creases as f64) < CREASE_SHARE_MIN * border.len() as f64 {
                join(border[0].0, border[0].1);
            }
        }
    }
}
