//! Triangle meshes and convex parts of the arm's links.

use geometry::OrientedBox;
use mesh::{Solid, Surface, lathe, rounded_box};
use nalgebra::{Isometry3, Point2, UnitQuaternion, Vector3};
use std::f32::consts::FRAC_PI_2;

use crate::tapered_cylinder::{TaperedCylinder, tapered_cylinders};
use crate::{Arm, N_JOINTS};

/// Colour of the rail and the fingers.
const HAND: [u8; 3] = [70, 72, 76];

/// Colour of the rubber pads.
const PAD: [u8; 3] = [34, 34, 36];

/// Surface finish of matte plastic.
const PLASTIC: Surface = Surface {
    specular: 0.05,
    infrared: 1.0,
};

/// Number of segments around a tapered cylinder.
const N_AROUND: usize = 32;

/// Number of points on a rounded rim.
const N_RIM: usize = 4;

/// Closed meshes of the arm's bodies with their convex parts, each in the frame of its body, see
/// [`Arm::body_poses`]. A link may consist of several overlapping parts.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkMeshes {
    /// Link meshes: the base, then the link behind each joint.
    pub links: [Solid; N_JOINTS + 1],
    /// Rail on which the fingers slide, tool frame.
    pub rail: Solid,
    /// One finger with its pad, finger frame; both fingers are alike.
    pub finger: Solid,
}

impl LinkMeshes {
    /// Builds the meshes of an arm.
    pub fn new(arm: &Arm) -> Self {
        let hand = arm.gripper();
        let mut links: [Solid; N_JOINTS + 1] = Default::default();
        for cylinder in tapered_cylinders(arm.dimensions(), hand.palm_m) {
            let link = std::mem::take(&mut links[cylinder.link]);
            links[cylinder.link] = link.joined(cylinder_solid(&cylinder));
        }
        Self {
            links,
            rail: box_solid(&hand.rail_in_tool(), 0.008, HAND),
            finger: box_solid(&hand.finger_body_in_finger(), 0.004, HAND).joined(box_solid(
                &hand.pad_in_finger(),
                0.002,
                PAD,
            )),
        }
    }
}

fn cylinder_solid(cylinder: &TaperedCylinder) -> Solid {
    let axis = (cylinder.ends[1] - cylinder.ends[0]).cast::<f32>();
    let [lower, upper] = cylinder.radii_m.map(|radius_m| radius_m as f32);
    let rotation = UnitQuaternion::rotation_between(&Vector3::z(), &axis)
        .unwrap_or_else(UnitQuaternion::identity);
    let pose = Isometry3::from_parts(cylinder.ends[0].cast::<f32>().into(), rotation);
    lathe(&rounded_profile(axis.norm(), lower, upper), N_AROUND)
        .transformed(&pose)
        .colored(cylinder.color)
        .with_surface(PLASTIC)
}

/// Lathe profile of a tapered cylinder with rounded rims, from height 0 to `length_m`: points of
/// (radius, height), metres.
fn rounded_profile(length_m: f32, lower_m: f32, upper_m: f32) -> Vec<Point2<f32>> {
    let rim = 0.010_f32
        .min(0.4 * length_m)
        .min(0.5 * lower_m.min(upper_m));
    let arc = |k: usize| (k as f32 / N_RIM as f32 * FRAC_PI_2).sin_cos();
    let mut profile = vec![Point2::new(0.0, 0.0)];
    profile.extend(
        (0..=N_RIM)
            .map(arc)
            .map(|(sin, cos)| Point2::new(lower_m - rim * (1.0 - sin), rim * (1.0 - cos))),
    );
    profile.extend(
        (0..=N_RIM).rev().map(arc).map(|(sin, cos)| {
            Point2::new(upper_m - rim * (1.0 - sin), length_m - rim * (1.0 - cos))
        }),
    );
    profile.push(Point2::new(0.0, length_m));
    profile
}

fn box_solid(body: &OrientedBox, rounding_m: f32, color: [u8; 3]) -> Solid {
    let sides = body.sides_m().cast::<f32>();
    rounded_box(sides.into(), rounding_m, 0.05)
        .transformed(&body.frame_from_box.cast())
        .colored(color)
        .with_surface(PLASTIC)
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::RigidTransform;
    use nalgebra::Point3;

    #[test]
    fn meshes_are_closed_and_face_outwards() {
        let meshes = LinkMeshes::new(&Arm::jaco_like());
        for solid in meshes.links.iter().chain([&meshes.rail, &meshes.finger]) {
            let found = solid.mesh.diagnostics();
            assert!(found.is_sound(), "{found:?}");
            assert!(solid.mesh.signed_volume() > 0.0);
        }
    }

    /// Least distance of the vertices of `solid` from a point, both in the parent's frame.
    fn gap(solid: &Solid, parent_from_body: &RigidTransform, point: Point3<f64>) -> f64 {
        solid
            .mesh
            .vertices
            .iter()
            .map(|v| (parent_from_body * v.position.cast::<f64>() - point).norm())
            .fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn each_link_reaches_from_its_joint_to_the_next() {
        let arm = Arm::jaco_like();
        let meshes = LinkMeshes::new(&arm);
        for (i, joint) in arm.chain().joints.iter().enumerate() {
            let here = joint.parent_from_joint.translation.vector.into();
            assert!(gap(&meshes.links[i], &RigidTransform::identity(), here) < 0.08);
            assert!(gap(&meshes.links[i + 1], &joint.parent_from_joint, here) < 0.01);
        }
    }

    #[test]
    fn pads_meet_when_the_hand_is_closed() {
        let meshes = LinkMeshes::new(&Arm::jaco_like());
        let least = |f: fn(&Point3<f32>) -> f32| {
            meshes
                .finger
                .mesh
                .vertices
                .iter()
                .map(|v| f(&v.position))
                .fold(f32::INFINITY, f32::min)
        };
        assert!(least(|p| p.x).abs() < 1e-6);
        assert!((least(|p| -p.z) + 0.025).abs() < 1e-6);
    }
}
