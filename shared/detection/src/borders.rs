//! Where two parts of a cluster meet.

use point_cloud::Point;

/// Of the pixels of a border that lie on one surface, this share must be on a
/// crease for the border to part two objects.
const CREASE_SHARE_MIN: f64 = 0.7;

/// A step of depth beyond this, metres at 1 m, growing with squared depth, is
/// an outline: by itself it says neither that the parts are one nor two.
const STEP_M: f32 = 0.006;

/// What two neighbouring pixels of different parts say.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Evidence {
    Smooth,
    Crease,
    Step,
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
        let evidence = if (a - b).abs() > STEP_M * a * a {
            Evidence::Step
        } else if is_crease {
            Evidence::Crease
        } else {
            Evidence::Smooth
        };
        self.pairs
            .push((parts[0].min(parts[1]), parts[0].max(parts[1]), evidence));
    }

    /// Calls `join` for each two parts whose border is no crease, in the order
    /// of their numbers.
    pub(crate) fn join_smooth(&mut self, mut join: impl FnMut(u32, u32)) {
        self.pairs.sort_unstable();
        for border in self.pairs.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1)) {
            if !parts_two_objects(border) {
                join(border[0].0, border[0].1);
            }
        }
    }
}

fn parts_two_objects(border: &[(u32, u32, Evidence)]) -> bool {
    let count = |evidence| border.iter().filter(|pair| pair.2 == evidence).count();
    let (n_creases, n_smooth) = (count(Evidence::Crease), count(Evidence::Smooth));
    n_creases > 0 && n_creases as f64 >= CREASE_SHARE_MIN * (n_creases + n_smooth) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use point_cloud::Rgba;

    fn joined(evidence: &[(f32, bool)]) -> Vec<(u32, u32)> {
        let at = |z: f32| Point {
            x: 0.0,
            y: 0.0,
            z,
            color: Rgba::default(),
        };
        let mut borders = Borders::default();
        for &(step_m, is_crease) in evidence {
            borders.add([7, 3], [&at(1.0), &at(1.0 + step_m)], is_crease);
        }
        let mut joined = Vec::new();
        borders.join_smooth(|a, b| joined.push((a, b)));
        joined
    }

    #[test]
    fn only_a_crease_along_most_of_the_border_parts() {
        let (smooth, crease, step) = ((0.0, false), (0.0, true), (0.1, true));
        assert_eq!(joined(&[smooth, smooth, crease]), [(3, 7)]);
        assert_eq!(joined(&[crease, crease, crease, crease, smooth]), []);
        // Outlines say nothing, neither for nor against.
        assert_eq!(joined(&[step, step, step]), [(3, 7)]);
        assert_eq!(joined(&[step, step, step, crease]), []);
        assert_eq!(joined(&[step, smooth, smooth, crease]), [(3, 7)]);
        assert_eq!(joined(&[]), []);
    }
}
