//! Meshes of the simulated person: clothed limbs and a bare hand.

use geometry::{Capsule, RigidTransform};
use mesh::{Solid, TubeSection, ellipsoid, rounded_tube};
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use rendering::PreparedMesh;

/// Colour of the person's skin.
const SKIN: [u8; 3] = [206, 160, 132];
/// Colour of the person's pullover.
const PULLOVER: [u8; 3] = [62, 84, 118];
/// Colour of the person's trousers.
const TROUSERS: [u8; 3] = [58, 56, 60];
/// Number of segments around a limb.
const N_SIDES: usize = 16;

/// Meshes of torso, head, upper arm, forearm, hand and legs in true size, from the origin along
/// z; the head is centred.
#[derive(Debug)]
pub(super) struct PersonMeshes {
    torso: PreparedMesh,
    head: PreparedMesh,
    upper_arm: PreparedMesh,
    forearm: PreparedMesh,
    hand: PreparedMesh,
    legs: PreparedMesh,
}

impl PersonMeshes {
    pub(super) fn new() -> Self {
        let prepared = |solid: Solid| PreparedMesh::new(&solid.mesh);
        Self {
            torso: prepared(torso()),
            head: prepared(ellipsoid([0.085, 0.095, 0.115], 24).colored(SKIN)),
            upper_arm: prepared(limb(0.31, 0.055, 0.045).colored(PULLOVER)),
            forearm: prepared(limb(0.27, 0.045, 0.032).colored(PULLOVER)),
            hand: prepared(hand().colored(SKIN)),
            legs: prepared(legs()),
        }
    }

    /// Limb meshes with their poses, for the body's capsules in their order.
    pub(super) fn limbs(
        &self,
        capsules: &[Capsule],
    ) -> impl Iterator<Item = (&PreparedMesh, RigidTransform)> {
        let meshes = [
            &self.torso,
            &self.head,
            &self.upper_arm,
            &self.forearm,
            &self.hand,
            &self.legs,
        ];
        let poses: Vec<RigidTransform> = capsules.iter().map(along).collect();
        meshes.into_iter().zip(poses)
    }
}

/// Frame at the start of a capsule whose z points along it.
fn along(capsule: &Capsule) -> RigidTransform {
    let axis = capsule.to - capsule.from;
    let rotation = UnitQuaternion::rotation_between(&Vector3::z(), &axis)
        .unwrap_or_else(UnitQuaternion::identity);
    RigidTransform::from_parts(Translation3::from(capsule.from.coords), rotation)
}

fn torso() -> Solid {
    let sections = [
        section(0.0, 0.17, 0.12),
        section(0.25, 0.16, 0.11),
        section(0.50, 0.19, 0.12),
        section(0.62, 0.16, 0.11),
    ];
    rounded_tube(&sections, Vector3::y(), 24).colored(PULLOVER)
}

fn legs() -> Solid {
    let sections = [section(0.0, 0.14, 0.11), section(0.54, 0.17, 0.12)];
    rounded_tube(&sections, Vector3::y(), 24).colored(TROUSERS)
}

fn section(z: f32, half_width: f32, half_height: f32) -> TubeSection {
    TubeSection {
        centre: Point3::new(0.0, 0.0, z),
        half_width,
        half_height,
    }
}

fn limb(length_m: f32, from_radius_m: f32, to_radius_m: f32) -> Solid {
    let at = |z, radius| TubeSection::round(Point3::new(0.0, 0.0, z), radius);
    rounded_tube(
        &[at(0.0, from_radius_m), at(length_m, to_radius_m)],
        Vector3::y(),
        N_SIDES,
    )
}

/// Hand along z, fingers together and slightly bent.
fn hand() -> Solid {
    let palm = ellipsoid([0.042, 0.018, 0.052], 16).moved(0.0, 0.0, 0.05);
    let fingers = [-0.027, -0.009, 0.009, 0.027].map(|x| {
        let length = if x < 0.0 { 0.065 } else { 0.072 };
        finger(length).transformed(&Isometry3::from_parts(
            Translation3::new(x, 0.0, 0.09),
            UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 0.25),
        ))
    });
    let thumb = finger(0.055).transformed(&Isometry3::from_parts(
        Translation3::new(0.036, 0.0, 0.05),
        UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 0.7),
    ));
    let wrist = limb(0.05, 0.028, 0.030);
    fingers
        .into_iter()
        .fold(palm.joined(thumb).joined(wrist), Solid::joined)
}

fn finger(length_m: f32) -> Solid {
    limb(length_m, 0.0095, 0.0075)
}
