//! Wire types of poses, transforms and covariances.

use bytemuck::{AnyBitPattern, Pod, Zeroable};
use geometry::RigidTransform;
use iceoryx2::prelude::ZeroCopySend;
use nalgebra::{Matrix3, Quaternion, Rotation3, Translation3, UnitQuaternion, Vector3};

/// Rigid transform as a 3 x 4 matrix, row-major, metres: `target_from_source`.
#[derive(Debug, Clone, Copy, PartialEq, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.Transform.v1")]
#[repr(C)]
pub struct WireTransform {
    /// Rows of the matrix [R | t].
    pub rows: [[f64; 4]; 3],
}

/// Pose as position and unit quaternion: `frame_from_object`.
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable, ZeroCopySend)]
#[type_name("tabula.Pose.v1")]
#[repr(C)]
pub struct WirePose {
    /// Position of the pose, metres.
    pub position_m: [f64; 3],
    /// Orientation of the pose, quaternion: x, y, z, w.
    pub orientation_xyzw: [f64; 4],
}

const _: () = assert!(size_of::<WireTransform>() == 96 && size_of::<WirePose>() == 56);

/// Tolerance of a received rotation: maximum deviation from orthonormality. Chosen.
const ROTATION_TOLERANCE: f64 = 1e-3;

impl WireTransform {
    /// Identity transform.
    pub const IDENTITY: Self = Self {
        rows: [
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, 1.0, 0.0],
        ],
    };

    /// Validated rigid transform; `None` when an entry is not finite, the rotation deviates by more
    /// than 1e-3 from orthonormality, or it is a reflection.
    pub fn checked(&self) -> Option<RigidTransform> {
        let rotation = Matrix3::from_fn(|r, c| self.rows[r][c]);
        let translation = Vector3::from_fn(|r, _| self.rows[r][3]);
        if !rotation
            .iter()
            .chain(translation.iter())
            .all(|v| v.is_finite())
        {
            return None;
        }
        let drift = (rotation.transpose() * rotation - Matrix3::identity())
            .abs()
            .max();
        if drift > ROTATION_TOLERANCE || rotation.determinant() <= 0.0 {
            return None;
        }
        // Exactly the numbers of the message, so that a replay is bit-identical.
        let rotation =
            UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation));
        Some(RigidTransform::from_parts(
            Translation3::from(translation),
            rotation,
        ))
    }
}

impl From<&RigidTransform> for WireTransform {
    fn from(transform: &RigidTransform) -> Self {
        let matrix = transform.to_homogeneous();
        Self {
            rows: std::array::from_fn(|r| std::array::from_fn(|c| matrix[(r, c)])),
        }
    }
}

impl WirePose {
    /// Validated pose; `None` when a number is not finite or the quaternion is not of unit length.
    pub fn checked(&self) -> Option<RigidTransform> {
        let [x, y, z, w] = self.orientation_xyzw;
        let orientation = Quaternion::new(w, x, y, z);
        let finite = self
            .position_m
            .iter()
            .chain(&self.orientation_xyzw)
            .all(|v| v.is_finite());
        let is_unit = (orientation.norm() - 1.0).abs() <= ROTATION_TOLERANCE;
        (finite && is_unit).then(|| {
            RigidTransform::from_parts(
                Translation3::from(Vector3::from(self.position_m)),
                UnitQuaternion::from_quaternion(orientation),
            )
        })
    }
}

/// Packed symmetric matrix (upper triangle): xx, xy, xz, yy, yz, zz.
pub fn upper_triangle(matrix: &Matrix3<f64>) -> [f32; 6] {
    [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|place| matrix[place] as f32)
}

/// True if a packed symmetric matrix can be a covariance: finite, variances of at least zero,
/// covariances within the Cauchy-Schwarz bound.
pub(crate) fn is_covariance(&[xx, xy, xz, yy, yz, zz]: &[f32; 6]) -> bool {
    let within = |ab: f32, aa: f32, bb: f32| {
        let [ab, aa, bb] = [ab, aa, bb].map(f64::from);
        ab.is_finite() && ab * ab <= aa * bb * (1.0 + 1e-5)
    };
    let is_variance = |v: f32| v.is_finite() && v >= 0.0;
    [xx, yy, zz].into_iter().all(is_variance)
        && within(xy, xx, yy)
        && within(xz, xx, zz)
        && within(yz, yy, zz)
}

impl From<&RigidTransform> for WirePose {
    fn from(pose: &RigidTransform) -> Self {
        Self {
            position_m: pose.translation.vector.into(),
            orientation_xyzw: pose.rotation.coords.into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transforms_survive_the_wire() {
        let pose = RigidTransform::new(Vector3::new(1.0, -2.0, 3.0), Vector3::new(0.3, 2.0, -1.0));
        let matrix = WireTransform::from(&pose).checked().unwrap();
        let parts = WirePose::from(&pose).checked().unwrap();
        for back in [matrix, parts] {
            assert!((back.inverse() * pose).translation.vector.norm() < 1e-12);
            assert!((back.inverse() * pose).rotation.angle() < 1e-7);
        }
    }

    #[test]
    fn covariances_are_told_from_other_matrices() {
        let root = Matrix3::new(0.1, 0.0, 0.0, 0.03, 0.2, 0.0, -0.1, 0.05, 0.3);
        let wire = upper_triangle(&(root * root.transpose()));
        assert!((wire[1] - 0.003).abs() < 1e-9 && (wire[5] - 0.1025).abs() < 1e-7);
        assert!(is_covariance(&wire) && is_covariance(&[0.0; 6]));
        for (i, wrong) in [(0, -1.0), (1, f32::NAN), (3, f32::INFINITY), (2, 1e9)] {
            let mut wire = wire;
            wire[i] = wrong;
            assert!(!is_covariance(&wire), "{wire:?}");
        }
    }

    #[test]
    fn invalid_transforms_are_refused() {
        let mut scaled = WireTransform::IDENTITY;
        scaled.rows[0][0] = 1.1;
        let mut mirrored = WireTransform::IDENTITY;
        mirrored.rows[2][2] = -1.0;
        let mut unknown = WireTransform::IDENTITY;
        unknown.rows[1][3] = f64::NAN;
        for wrong in [scaled, mirrored, unknown] {
            assert_eq!(wrong.checked(), None);
        }
        assert_eq!(WirePose::default().checked(), None);
    }
}
