//! Perspective and orthographic projection.

use geometry::{PinholeCamera, RigidTransform};

/// Distance of the near plane, metres.
pub(crate) const NEAR_M: f32 = 0.02;

/// Projected corner: pixel position and reverse-Z depth.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct ScreenCorner {
    /// Column of the projected corner, pixels.
    pub(crate) x: f32,
    /// Row of the projected corner, pixels.
    pub(crate) y: f32,
    /// Reverse-Z depth, linear in the image: the inverse depth, per metre, for a pinhole. Not
    /// positive where the corner cannot be projected.
    pub(crate) reverse_z: f32,
}

/// Rigid transform in single precision (`f32`).
#[derive(Debug, Clone, Copy)]
pub(crate) struct RigidTransformF32 {
    rows: [[f32; 4]; 3],
}

impl RigidTransformF32 {
    /// Converts a transform; `None` when a number is not finite.
    pub(crate) fn new(target_from_source: &RigidTransform) -> Option<Self> {
        let rotation = target_from_source.rotation.to_rotation_matrix();
        let rows: [[f32; 4]; 3] = std::array::from_fn(|i| {
            let along = |j| rotation.matrix()[(i, j)] as f32;
            let shift = target_from_source.translation.vector[i] as f32;
            [along(0), along(1), along(2), shift]
        });
        rows.iter()
            .flatten()
            .all(|part| part.abs() < 1e6)
            .then_some(Self { rows })
    }

    #[inline]
    pub(crate) fn point(&self, [x, y, z]: [f32; 3]) -> [f32; 3] {
        self.rows.map(|[a, b, c, d]| a * x + b * y + c * z + d)
    }

    #[inline]
    pub(crate) fn direction(&self, [x, y, z]: [f32; 3]) -> [f32; 3] {
        self.rows.map(|[a, b, c, _]| a * x + b * y + c * z)
    }
}

/// Projection of a camera or a light.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Projection {
    /// Pinhole camera: focal lengths and principal point, pixels.
    Pinhole { focal: [f32; 2], center: [f32; 2] },
    /// Orthographic projection along z: pixels per metre, centre in pixels, and decrease of the
    /// reverse-Z depth per metre.
    Orthographic {
        px_per_m: f32,
        center_px: f32,
        reverse_z_per_m: f32,
    },
}

impl Projection {
    pub(crate) fn of_camera(camera: &PinholeCamera) -> Self {
        Self::Pinhole {
            focal: [camera.fx_px as f32, camera.fy_px as f32],
            center: [camera.cx_px as f32, camera.cy_px as f32],
        }
    }

    /// Frustum culling: true if a sphere may be within an image of `size` pixels (width, height).
    pub(crate) fn is_sphere_visible(
        &self,
        ball: [f32; 3],
        radius_m: f32,
        size: (usize, usize),
    ) -> bool {
        match *self {
            Self::Pinhole { focal, center } => {
                let ends = [size.0 as f32, size.1 as f32];
                let is_beside = (0..2).any(|axis| {
                    // The slopes of the two outermost rays; a sphere is outside when its centre
                    // is farther from a border plane than its radius.
                    let low = (-1.0 - center[axis]) / focal[axis];
                    let high = (ends[axis] - center[axis]) / focal[axis];
                    ball[axis] - low * ball[2] < -radius_m * low.hypot(1.0)
                        || ball[axis] - high * ball[2] > radius_m * high.hypot(1.0)
                });
                ball[2] + radius_m >= NEAR_M && !is_beside
            }
            Self::Orthographic {
                px_per_m,
                center_px,
                ..
            } => {
                let reach_px = center_px + radius_m * px_per_m + 1.0;
                (0..2).all(|axis| (ball[axis] * px_per_m).abs() <= reach_px)
            }
        }
    }

    /// Projects a point in the frame of the camera or light.
    #[inline]
    pub(crate) fn project(&self, [x, y, z]: [f32; 3]) -> ScreenCorner {
        match *self {
            Self::Pinhole { focal, center } => {
                // Selections instead of a branch, so that a loop can be vectorised.
                let reverse_z = 1.0 / z;
                let unless_near = |value: f32| if z < NEAR_M { 0.0 } else { value };
                ScreenCorner {
                    x: unless_near(focal[0] * x * reverse_z + center[0]),
                    y: unless_near(focal[1] * y * reverse_z + center[1]),
                    reverse_z: unless_near(reverse_z),
                }
            }
            Self::Orthographic {
                px_per_m,
                center_px,
                reverse_z_per_m,
            } => ScreenCorner {
                x: px_per_m * x + center_px,
                y: px_per_m * y + center_px,
                reverse_z: 1.0 - reverse_z_per_m * z,
            },
        }
    }
}
