//! Contact points of a stored model: samples of its faces with their normals.

use geometry::RigidTransform;
use grasping::{ContactEvidence, ContactPoint};
use mesh::TriangleMesh;
use nalgebra::{Point3, Vector3};
use std::collections::BTreeMap;

/// Spacing of the contact points, metres.
const SPACING_M: f64 = 0.006;
/// Subdivisions of one side of a triangle at most.
const N_SUBDIVISIONS_MAX: f64 = 200.0;

/// Contact points of a mesh at a pose, at most one for each cell and side of a wall; none for a
/// mesh without triangles.
pub fn model_contacts(mesh: &TriangleMesh, plan_from_model: &RigidTransform) -> Vec<ContactPoint> {
    let mut cells = BTreeMap::<([i32; 3], [bool; 3]), ContactPoint>::new();
    for triangle in &mesh.triangles {
        let corner = |i: usize| mesh.vertices.get(triangle.vertices[i] as usize);
        let (Some(a), Some(b), Some(c)) = (corner(0), corner(1), corner(2)) else {
            continue;
        };
        let [a, b, c] = [a, b, c].map(|v| plan_from_model * v.position.cast::<f64>());
        let (ab, ac) = (b - a, c - a);
        let Some(normal) = ab.cross(&ac).try_normalize(1e-12) else {
            continue;
        };
        let longest_m = ab.norm().max(ac.norm()).max((c - b).norm());
        let n = (longest_m / SPACING_M)
            .ceil()
            .clamp(1.0, N_SUBDIVISIONS_MAX) as usize;
        for i in 0..=n {
            for j in 0..=n - i {
                let (s, t) = (i as f64 / n as f64, j as f64 / n as f64);
                let position = a + ab * s + ac * t;
                cells
                    .entry(cell_of(&position, &normal))
                    .or_insert(ContactPoint {
                        position,
                        normal,
                        evidence: ContactEvidence::Model,
                    });
            }
        }
    }
    cells.into_values().collect()
}

/// Cell of a place, and the octant of its normal: both sides of a thin wall are in one cell.
fn cell_of(place: &Point3<f64>, normal: &Vector3<f64>) -> ([i32; 3], [bool; 3]) {
    let cell = place.coords.map(|c| (c / SPACING_M).floor() as i32);
    (
        cell.into(),
        [normal.x > 0.0, normal.y > 0.0, normal.z > 0.0],
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contacts_of_a_box_lie_on_its_faces_with_outward_normals() {
        let mesh = mesh::rounded_box([0.06, 0.04, 0.10], 0.0005, 1.0).mesh;
        let pose = RigidTransform::translation(0.1, 0.0, 0.5);
        let contacts = model_contacts(&mesh, &pose);
        assert!(contacts.len() > 200, "{}", contacts.len());
        for contact in &contacts {
            let off = pose.inverse() * contact.position;
            assert!(off.coords.dot(&contact.normal) > 0.0, "{contact:?}");
            let beyond = (off.x.abs() - 0.03)
                .max(off.y.abs() - 0.02)
                .max(off.z.abs() - 0.05);
            assert!(beyond.abs() < 1e-3, "{contact:?}");
        }
        assert!(model_contacts(&TriangleMesh::default(), &pose).is_empty());
    }
}
