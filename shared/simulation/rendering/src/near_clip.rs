//! Cutting triangles at the near plane.

use crate::projection::{Lens, NEAR_M, ScreenCorner};

/// Calls `draw` with the parts of a triangle beyond the near plane, at most two
/// triangles. Corners are in the camera's frame.
///
/// Sutherland and Hodgman (1974), one plane. A cut is computed from the corner
/// in front towards the one behind, so that neighbours cut a common edge alike.
pub(crate) fn clip(corners: [[f32; 3]; 3], lens: &Lens, mut draw: impl FnMut([ScreenCorner; 3])) {
    let mut polygon = [ScreenCorner::default(); 4];
    let mut n = 0;
    for i in 0..3 {
        let (here, next) = (corners[i], corners[(i + 1) % 3]);
        let (is_here_in, is_next_in) = (here[2] >= NEAR_M, next[2] >= NEAR_M);
        if is_here_in {
            polygon[n] = lens.project(here);
            n += 1;
        }
        if is_here_in != is_next_in {
            let (inside, outside) = if is_here_in {
                (here, next)
            } else {
                (next, here)
            };
            polygon[n] = lens.project(cut(inside, outside));
            n += 1;
        }
    }
    if n >= 3 {
        draw([polygon[0], polygon[1], polygon[2]]);
    }
    if n == 4 {
        draw([polygon[0], polygon[2], polygon[3]]);
    }
}

/// Where an edge meets the near plane.
fn cut(inside: [f32; 3], outside: [f32; 3]) -> [f32; 3] {
    let t = (NEAR_M - inside[2]) / (outside[2] - inside[2]);
    [
        inside[0] + t * (outside[0] - inside[0]),
        inside[1] + t * (outside[1] - inside[1]),
        NEAR_M,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    const LENS: Lens = Lens::Pinhole {
        focal: [100.0; 2],
        center: [0.0; 2],
    };

    fn n_parts(depths: [f32; 3]) -> usize {
        let corners = [
            [0.0, 0.0, depths[0]],
            [1.0, 0.0, depths[1]],
            [0.0, 1.0, depths[2]],
        ];
        let mut n = 0;
        clip(corners, &LENS, |part| {
            assert!(
                part.iter()
                    .all(|c| c.closeness > 0.0 && c.closeness <= 1.0 / NEAR_M)
            );
            n += 1;
        });
        n
    }

    #[test]
    fn the_part_in_front_remains() {
        assert_eq!(n_parts([1.0, 1.0, 1.0]), 1);
        assert_eq!(n_parts([1.0, 1.0, -1.0]), 2);
        assert_eq!(n_parts([-1.0, 1.0, -1.0]), 1);
        assert_eq!(n_parts([-1.0, -1.0, -1.0]), 0);
    }
}
