//! Observed surface of an object: measured points with normals, and its occluding contour.

use crate::contact_point::{ContactEvidence, ContactPoint};
use crate::grasp_scene::GraspScene;
use nalgebra::{Matrix3, Point3, Vector3};
use point_cloud::least_eigenvector;

/// Number of measured contact points of an object, about.
const N_SEEN_AIMED: f64 = 500.0;
/// Number of contour points of an object, about.
const N_CONTOUR_AIMED: usize = 120;
/// Radius of the patch by which a normal is estimated, metres. Chosen: four times the noise of a
/// Kinect at a metre.
const PATCH_M: f64 = 0.007;
/// Greatest difference of depth within a patch, metres: a further point is on another surface.
const PATCH_DEPTH_M: f64 = 0.012;
/// Least number of points of a patch.
const N_PATCH_MIN: f64 = 6.0;
/// Radius of the window by which the direction of the contour is estimated, pixels.
const CONTOUR_RADIUS_PX: isize = 3;
/// Height above the support up to which the sides of an object count as vertical, metres: a flat
/// thing has no surface there that the camera could measure.
const FLAT_M: f64 = 0.03;

/// Contact points of what the camera shows of an object.
pub(crate) fn observed_surface(scene: &GraspScene<'_>, object: usize) -> Vec<ContactPoint> {
    let pixels = scene.pixels(object);
    let [width, _] = scene.space.size_px();
    let stride = ((pixels.len() as f64 / N_SEEN_AIMED).sqrt().round() as usize).max(1);
    let sampled = pixels
        .iter()
        .filter(|&&pixel| (pixel % width) % stride == 0 && (pixel / width) % stride == 0);
    let mut contacts: Vec<ContactPoint> = sampled
        .filter_map(|&pixel| seen_contact(scene, object, pixel))
        .collect();
    add_contour(scene, object, &mut contacts);
    contacts
}

/// Measured point with the normal of the patch around it (principal component analysis; Hoppe et
/// al. 1992), towards the camera.
fn seen_contact(scene: &GraspScene<'_>, object: usize, pixel: usize) -> Option<ContactPoint> {
    let middle = scene.space.in_camera(pixel)?;
    let radius = (PATCH_M * scene.space.focal_px() / middle.z).round();
    let radius = radius.clamp(2.0, 8.0) as isize;
    let (mut n, mut sum, mut squares) = (0.0, Vector3::zeros(), Matrix3::zeros());
    for_window(scene, pixel, radius, |_, neighbour| {
        let is_same = scene.owner(neighbour) == Some(object);
        let place = scene.space.in_camera(neighbour).filter(|_| is_same);
        if let Some(place) = place.filter(|place| (place.z - middle.z).abs() < PATCH_DEPTH_M) {
            let offset = place - middle;
            n += 1.0;
            sum += offset;
            squares += offset * offset.transpose();
        }
    });
    if n < N_PATCH_MIN {
        return None;
    }
    let mean = sum / n;
    let (_, normal) = least_eigenvector(&(squares / n - mean * mean.transpose()));
    let towards_camera = if normal.dot(&middle.coords) > 0.0 {
        -normal
    } else {
        normal
    };
    Some(ContactPoint {
        position: scene.space.in_plan(pixel)?,
        normal: scene.space.direction_in_plan(&towards_camera),
        evidence: ContactEvidence::Seen,
    })
}

/// Adds the occluding contour: where the object ends in the image before something farther, its
/// surface is tangent to the line of sight, so that its normal is known without depth (Koenderink
/// 1984).
fn add_contour(scene: &GraspScene<'_>, object: usize, contacts: &mut Vec<ContactPoint>) {
    let carrier = scene.carrier_of(contacts);
    let border: Vec<usize> = scene
        .pixels(object)
        .iter()
        .copied()
        .filter(|&pixel| is_contour(scene, object, pixel))
        .collect();
    let step = (border.len() / N_CONTOUR_AIMED).max(1);
    for &pixel in border.iter().step_by(step) {
        let Some(place) = scene.space.in_plan(pixel) else {
            continue;
        };
        let height_m = carrier.map(|carrier| scene.surfaces[carrier].plane.height_m(&place));
        let is_flat = height_m.is_some_and(|height_m| height_m < FLAT_M);
        if let Some(normal) = contour_normal(scene, object, pixel, &place, is_flat) {
            contacts.push(ContactPoint {
                position: place,
                normal,
                evidence: ContactEvidence::Contour,
            });
        }
    }
}

/// True if a pixel next to this one shows something behind the object.
fn is_contour(scene: &GraspScene<'_>, object: usize, pixel: usize) -> bool {
    let Some(own) = scene.space.in_camera(pixel) else {
        return false;
    };
    let [width, height] = scene.space.size_px();
    let (column, row) = (pixel % width, pixel / width);
    if column == 0 || row == 0 || column + 1 == width || row + 1 == height {
        return false;
    }
    let neighbours = [pixel - 1, pixel + 1, pixel - width, pixel + width];
    let is_own = |&neighbour: &usize| scene.owner(neighbour) == Some(object);
    let others: Vec<usize> = neighbours.into_iter().filter(|n| !is_own(n)).collect();
    let is_nearer = |&neighbour: &usize| {
        let other = scene.space.in_camera(neighbour);
        other.is_some_and(|other| other.z < own.z - PATCH_DEPTH_M)
    };
    !others.is_empty() && !others.iter().any(is_nearer)
}

/// Outward normal at the contour: at a right angle to the line of sight, and level for flat things.
fn contour_normal(
    scene: &GraspScene<'_>,
    object: usize,
    pixel: usize,
    place: &Point3<f64>,
    is_flat: bool,
) -> Option<Vector3<f64>> {
    let mut outward = Vector3::zeros();
    for_window(
        scene,
        pixel,
        CONTOUR_RADIUS_PX,
        |[right, down], neighbour| {
            if scene.owner(neighbour) != Some(object) {
                // The other side of a thin part counts little.
                let offset = Vector3::new(right as f64, down as f64, 0.0);
                outward += offset / offset.norm();
            }
        },
    );
    let mut normal = scene.space.direction_in_plan(&outward);
    let sight = (place - scene.space.eye()).normalize();
    normal -= sight * normal.dot(&sight);
    if is_flat {
        normal.z = 0.0;
    }
    normal.try_normalize(1e-6)
}

/// Calls with the offset and the index of each pixel in a square window.
fn for_window(
    scene: &GraspScene<'_>,
    pixel: usize,
    radius: isize,
    mut take: impl FnMut([isize; 2], usize),
) {
    let [width, height] = scene.space.size_px();
    let (column, row) = ((pixel % width) as isize, (pixel / width) as isize);
    for down in -radius..=radius {
        for right in -radius..=radius {
            let (x, y) = (column + right, row + down);
            if (0..width as isize).contains(&x) && (0..height as isize).contains(&y) {
                take([right, down], y as usize * width + x as usize);
            }
        }
    }
}
