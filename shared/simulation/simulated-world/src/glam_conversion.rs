//! Conversions between nalgebra transforms and the physics engine's single-precision glam types.

use geometry::RigidTransform;
use nalgebra::{Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use rapier3d::math::{Pose, Rotation, Vector};

pub(crate) fn vector_to_glam(vector: &Vector3<f64>) -> Vector {
    Vector::new(vector.x as f32, vector.y as f32, vector.z as f32)
}

pub(crate) fn point_to_glam(point: &Point3<f32>) -> Vector {
    Vector::new(point.x, point.y, point.z)
}

pub(crate) fn vector_from_glam(vector: Vector) -> Vector3<f64> {
    Vector3::new(vector.x.into(), vector.y.into(), vector.z.into())
}

pub(crate) fn pose_to_glam(pose: &RigidTransform) -> Pose {
    let r = pose.rotation.coords;
    Pose::from_parts(
        vector_to_glam(&pose.translation.vector),
        Rotation::from_xyzw(r.x as f32, r.y as f32, r.z as f32, r.w as f32).normalize(),
    )
}

pub(crate) fn pose_from_glam(pose: &Pose) -> RigidTransform {
    let r = pose.rotation;
    RigidTransform::from_parts(
        Translation3::from(vector_from_glam(pose.translation)),
        UnitQuaternion::new_normalize(Quaternion::new(
            r.w.into(),
            r.x.into(),
            r.y.into(),
            r.z.into(),
        )),
    )
}
