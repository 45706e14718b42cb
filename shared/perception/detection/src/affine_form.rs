//! Affine form: one coordinate of a rigid transform or a signed plane distance, in single
//! precision for hot loops.

use geometry::{Plane, RigidTransform};

/// Affine form `n · p + d` in single precision: the coordinate of a point along an axis of
/// another frame, or its signed distance from a plane, metres.
#[derive(Debug, Clone, Copy)]
pub(crate) struct AffineForm {
    x: f32,
    y: f32,
    z: f32,
    offset: f32,
}

impl From<&Plane> for AffineForm {
    fn from(plane: &Plane) -> Self {
        let n = plane.normal.map(|value| value as f32);
        Self {
            x: n.x,
            y: n.y,
            z: n.z,
            offset: plane.offset_m as f32,
        }
    }
}

impl AffineForm {
    /// Affine forms of the three coordinates x, y, z of `target_from_source`.
    pub(crate) fn coordinates_of(target_from_source: &RigidTransform) -> [Self; 3] {
        let rotation = target_from_source.rotation.to_rotation_matrix();
        std::array::from_fn(|i| Self {
            x: rotation[(i, 0)] as f32,
            y: rotation[(i, 1)] as f32,
            z: rotation[(i, 2)] as f32,
            offset: target_from_source.translation.vector[i] as f32,
        })
    }

    /// Value of the affine form at a point.
    #[inline]
    pub(crate) fn at(&self, x: f32, y: f32, z: f32) -> f32 {
        self.x * x + self.y * y + self.z * z + self.offset
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Point3, Vector3};

    #[test]
    fn coordinates_agree_with_the_transform_and_the_plane() {
        let transform =
            RigidTransform::new(Vector3::new(0.2, -1.0, 0.7), Vector3::new(1.0, 0.3, -0.4));
        let plane = Plane::through(&Point3::new(0.1, 0.2, 1.3), Vector3::y_axis());
        let p = Point3::new(0.3, -0.2, 1.1);
        let [x, y, z] = [p.x as f32, p.y as f32, p.z as f32];
        for (axis, expected) in AffineForm::coordinates_of(&transform)
            .iter()
            .zip(&(transform * p).coords)
        {
            assert!((f64::from(axis.at(x, y, z)) - expected).abs() < 1e-6);
        }
        assert!(
            (f64::from(AffineForm::from(&plane).at(x, y, z)) - plane.height_m(&p)).abs() < 1e-6
        );
    }
}
