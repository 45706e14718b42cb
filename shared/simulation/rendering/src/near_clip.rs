//! Near plane clipping of triangles (Sutherland and Hodgman 1974).

use crate::projection::{NEAR_M, Projection, ScreenCorner};

/// Clips a triangle at the near plane and calls `draw` with the parts in front of the camera, at
/// most two triangles. Corners are in the camera frame.
///
/// The intersection is computed from the corner in front towards the one behind, so that
/// neighbouring triangles clip a common edge identically.
pub(crate) fn clip(
    corners: [[f32; 3]; 3],
    projection: &Projection,
    mut draw: impl FnMut([ScreenCorner; 3]),
) {
    let mut polygon = [ScreenCorner::default(); 4];
    let mut n = 0;
    for i in 0..3 {
        let (here, next) = (corners[i], corners[(i + 1) % 3]);
        let (is_here_in, is_next_in) = (here[2] >= NEAR_M, next[2] >= NEAR_M);
        if is_here_in {
            polygon[n] = projection.project(here);
            n += 1;
        }
        if is_here_in != is_next_in {
            let (inside, outside) = if is_here_in {
                (here, next)
            } else {
                (next, here)
            };
            polygon[n] = projection.project(intersect_near_plane(inside, outside));
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

/// Intersection of an edge with the near plane.
fn intersect_near_plane(inside: [f32; 3], outside: [f32; 3]) -> [f32; 3] {
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

    const LENS: Projection = Projection::Pinhole {
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
                    .all(|c| c.reverse_z > 0.0 && c.reverse_z <= 1.0 / NEAR_M)
            );
            n += 1;
        });
        n
    }

    #[test]
    fn clipping_keeps_the_part_in_front() {
        assert_eq!(n_parts([1.0, 1.0, 1.0]), 1);
        assert_eq!(n_parts([1.0, 1.0, -1.0]), 2);
        assert_eq!(n_parts([-1.0, 1.0, -1.0]), 1);
        assert_eq!(n_parts([-1.0, -1.0, -1.0]), 0);
    }
}
