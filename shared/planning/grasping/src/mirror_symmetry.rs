//! Mirror symmetry of an object about a vertical plane, by which its hidden side is estimated
//! (Bohg et al. 2011, "Mind the gap").

use crate::contact_point::{ContactEvidence, ContactPoint};
use crate::grasp_scene::GraspScene;
use crate::observed_space::SpaceState;
use nalgebra::Vector3;
use std::f64::consts::PI;

/// Directions of the plane's normal, over ±60° about the horizontal line of sight.
const N_DIRECTIONS: usize = 13;
const SPREAD_RAD: f64 = PI / 3.0;
/// Offsets of the plane along its normal: from the middle of what is seen to the far end of it and
/// beyond by half of its width.
const N_OFFSETS: usize = 10;
/// Number of points by which a plane is scored.
const N_SCORED: usize = 90;
/// Score of a mirrored point in free space, and of one on the seen surface of the object; one that
/// is hidden scores nothing. Chosen on the odd half of the scanned objects.
const FREE: f64 = -3.0;
const SAME: f64 = 1.0;
/// Lengths of the sides that are seen from their edge only, metres, and the spacing of their points.
const BRIDGED_M: std::ops::Range<f64> = 0.008..0.25;
const BRIDGE_STEP_M: f64 = 0.010;
/// Share of an edge's normal that must be at a right angle to its side.
const BRIDGE_NORMAL_MIN: f64 = 0.5;
/// Cosine between normal and line of sight up to which a side is seen from its edge.
const EDGE_ON: f64 = 0.17;
/// Score of the depth of the completed object over its width, for each difference of one.
const DEPTH_PRIOR: f64 = 0.25;

/// Vertical mirror plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MirrorPlane {
    /// Horizontal unit normal, away from the camera.
    pub(crate) normal: Vector3<f64>,
    /// Places p of the plane fulfil `normal · p = offset_m`.
    pub(crate) offset_m: f64,
}

impl MirrorPlane {
    fn mirrored(&self, contact: &ContactPoint) -> ContactPoint {
        let height_m = self.normal.dot(&contact.position.coords) - self.offset_m;
        ContactPoint {
            position: contact.position - self.normal * (2.0 * height_m),
            normal: contact.normal - self.normal * (2.0 * self.normal.dot(&contact.normal)),
            evidence: ContactEvidence::Mirrored,
        }
    }
}

/// Best mirror plane of the observed surface of an object; `None` for too few points.
pub(crate) fn mirror_plane(
    scene: &GraspScene<'_>,
    object: usize,
    seen: &[ContactPoint],
) -> Option<MirrorPlane> {
    if seen.len() < 10 {
        return None;
    }
    let step = seen.len().div_ceil(N_SCORED);
    let sampled: Vec<&ContactPoint> = seen.iter().step_by(step).collect();
    let middle = sampled.iter().fold(Vector3::zeros(), |sum, contact| {
        sum + contact.position.coords
    }) / sampled.len() as f64;
    let mut sight = middle - scene.space.eye().coords;
    sight.z = 0.0;
    // From straight above, each direction is as good as another.
    let sight = sight.try_normalize(1e-6).unwrap_or_else(Vector3::y);
    let search = PlaneSearch {
        scene,
        object,
        sampled: &sampled,
        sight,
        middle,
    };
    let coarse = (0..N_DIRECTIONS).flat_map(|direction| {
        let turn_rad = SPREAD_RAD * (2.0 * direction as f64 / (N_DIRECTIONS - 1) as f64 - 1.0);
        (0..N_OFFSETS).map(move |k| [turn_rad, k as f64 / (N_OFFSETS - 1) as f64])
    });
    let best = search.best(coarse)?;
    let (turn_step, share_step) = (
        SPREAD_RAD / (N_DIRECTIONS - 1) as f64,
        1.0 / (N_OFFSETS - 1) as f64,
    );
    let fine = [-1.0, 0.0, 1.0].into_iter().flat_map(|turn| {
        (-3..=3).map(move |k| {
            let share = best[1] + share_step * f64::from(k) / 4.0;
            [best[0] + turn_step * turn, share]
        })
    });
    search.best(fine).map(|found| search.plane(found).0)
}

/// Search of the plane by its turn about the vertical, radians, and its offset, as a share of the way
/// from the middle of what is seen to the farthest that counts.
struct PlaneSearch<'a> {
    scene: &'a GraspScene<'a>,
    object: usize,
    sampled: &'a [&'a ContactPoint],
    sight: Vector3<f64>,
    middle: Vector3<f64>,
}

impl PlaneSearch<'_> {
    /// Best of several planes.
    fn best(&self, planes: impl Iterator<Item = [f64; 2]>) -> Option<[f64; 2]> {
        let scored = planes.map(|place| (self.score(place), place));
        scored
            .reduce(|best, next| if next.0 > best.0 { next } else { best })
            .map(|(_, place)| place)
    }

    /// Plane, and the depth of the completed object over its width.
    fn plane(&self, [turn_rad, share]: [f64; 2]) -> (MirrorPlane, f64) {
        let (sine, cosine) = turn_rad.sin_cos();
        let normal = Vector3::new(
            cosine * self.sight.x - sine * self.sight.y,
            sine * self.sight.x + cosine * self.sight.y,
            0.0,
        );
        let across = Vector3::z().cross(&normal);
        let [near_m, far_m] = extent(self.sampled, &normal);
        let [left_m, right_m] = extent(self.sampled, &across);
        let (middle_m, width_m) = (normal.dot(&self.middle), (right_m - left_m).max(0.01));
        let offset_m = middle_m + share * (far_m - middle_m + 0.5 * width_m);
        let depth = 2.0 * (offset_m - near_m) / width_m;
        (MirrorPlane { normal, offset_m }, depth)
    }

    /// Score of a plane: of the mirrored points, and of the depth.
    fn score(&self, place: [f64; 2]) -> f64 {
        let (plane, depth) = self.plane(place);
        let prior = -DEPTH_PRIOR * (depth - 1.0).abs().min(2.0);
        score(self.scene, self.object, self.sampled, &plane) + prior
    }
}

/// Least and greatest coordinate of points along a direction.
fn extent(points: &[&ContactPoint], along: &Vector3<f64>) -> [f64; 2] {
    points.iter().fold(
        [f64::INFINITY, f64::NEG_INFINITY],
        |[low, high], contact| {
            let along_m = along.dot(&contact.position.coords);
            [low.min(along_m), high.max(along_m)]
        },
    )
}

/// Mean score of the mirrored points.
fn score(
    scene: &GraspScene<'_>,
    object: usize,
    points: &[&ContactPoint],
    plane: &MirrorPlane,
) -> f64 {
    let of_point = |contact: &&ContactPoint| {
        let mirrored = plane.mirrored(contact);
        match scene.space.state(&mirrored.position) {
            SpaceState::Free => FREE,
            SpaceState::Surface(pixel) if scene.owner(pixel) == Some(object) => {
                // A surface that faces away from the camera cannot be the one that it measures.
                let towards = scene.space.eye() - mirrored.position;
                let faces = mirrored.normal.dot(&towards.normalize());
                if faces > 0.0 { SAME } else { 0.0 }
            }
            SpaceState::Surface(_) | SpaceState::Hidden(_) | SpaceState::Unmeasured => 0.0,
        }
    };
    points.iter().map(of_point).sum::<f64>() / points.len() as f64
}

/// Hidden side of an object: mirrored points, and sides that are seen from their edge only.
pub(crate) fn hidden_side(
    scene: &GraspScene<'_>,
    seen: &[ContactPoint],
    plane: &MirrorPlane,
) -> Vec<ContactPoint> {
    let mut hidden: Vec<ContactPoint> = seen
        .iter()
        .filter(|contact| contact.evidence == ContactEvidence::Seen)
        .map(|contact| plane.mirrored(contact))
        .collect();
    let contour = seen
        .iter()
        .filter(|c| c.evidence == ContactEvidence::Contour);
    hidden.retain(|contact| is_hidden(scene, contact));
    for edge in contour.step_by(2) {
        let side = bridge(edge, &plane.mirrored(edge));
        // An open container is free between its edges.
        if side.iter().all(|contact| is_hidden(scene, contact)) {
            hidden.extend(side);
        }
    }
    hidden
}

/// Side of an object between an edge of its contour and the mirrored edge.
fn bridge(edge: &ContactPoint, mirrored: &ContactPoint) -> Vec<ContactPoint> {
    let between = mirrored.position - edge.position;
    let length_m = between.norm();
    if !BRIDGED_M.contains(&length_m) {
        return Vec::new();
    }
    let along = between / length_m;
    let normal = edge.normal - along * along.dot(&edge.normal);
    let Some(normal) = normal.try_normalize(BRIDGE_NORMAL_MIN) else {
        return Vec::new();
    };
    let n = (length_m / BRIDGE_STEP_M).ceil() as usize;
    (1..n)
        .map(|k| ContactPoint {
            position: edge.position + between * (k as f64 / n as f64),
            normal,
            evidence: ContactEvidence::Mirrored,
        })
        .collect()
}

/// True for a place that the image does not show to be free, nor shows anyhow.
fn is_hidden(scene: &GraspScene<'_>, contact: &ContactPoint) -> bool {
    match scene.space.state(&contact.position) {
        SpaceState::Hidden(_) | SpaceState::Unmeasured => true,
        // The far side of a thin wall, or a side that is seen from its edge.
        SpaceState::Surface(_) => {
            let towards_eye = (scene.space.eye() - contact.position).normalize();
            contact.normal.dot(&towards_eye) < EDGE_ON
        }
        SpaceState::Free => false,
    }
}
