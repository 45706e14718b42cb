//! Antipodal pairs: two contact points whose normals are opposite along the line between them
//! (Nguyen 1988).

use crate::contact_point::{ContactEvidence, ContactPoint};
use nalgebra::{Point3, Vector3};
use std::collections::BTreeMap;

/// Number of contact points from which partners are looked for.
const N_SEEDS: usize = 140;
/// Least distance of two contacts, metres: below it they are one sheet of noise.
const WIDTH_MIN_M: f64 = 0.001;
/// Distance up to which two contacts may be those of a thin wall, and the spacing of the contacts by
/// which they may be beside each other, metres.
const THIN_M: f64 = 0.02;
const SPACING_M: f64 = 0.008;
/// Side of the cells of the middle by which pairs are thinned, metres.
const CELL_M: f64 = 0.012;
/// Number of steps of the half sphere of closing directions by which pairs are thinned.
const N_TURNS: f64 = 4.0;

/// Pair of opposite contact points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct AntipodalPair {
    /// Middle between the contacts, frame of planning.
    pub(crate) middle: Point3<f64>,
    /// Closing direction: unit vector between the contacts, upwards or towards +x.
    pub(crate) closing: Vector3<f64>,
    /// Distance of the contacts, metres.
    pub(crate) width_m: f64,
    /// Smaller cosine between a contact's normal and the closing direction.
    pub(crate) facing: f64,
    /// Weaker evidence of the two contacts.
    pub(crate) evidence: ContactEvidence,
    /// True for a squeeze, in which the object turns between the pads until they face.
    pub(crate) is_squeeze: bool,
}

/// Antipodal pairs of contact points, thinned to the best of each place and closing direction,
/// best first.
///
/// `facing_min` is the cosine of the friction cone. Pairs wider than `width_max_m` are left out;
/// the narrowest of them is the second value, for a remark that the object is too wide.
pub(crate) fn antipodal_pairs(
    contacts: &[ContactPoint],
    width_max_m: f64,
    facing_min: f64,
) -> (Vec<AntipodalPair>, Option<AntipodalPair>) {
    let mut best = BTreeMap::<[i32; 6], AntipodalPair>::new();
    let mut too_wide: Option<AntipodalPair> = None;
    let step = contacts.len().div_ceil(N_SEEDS).max(1);
    for (index, first) in contacts.iter().enumerate().step_by(step) {
        for (other, second) in contacts.iter().enumerate() {
            // Of two seeds, each finds the other.
            if other % step == 0 && other <= index {
                continue;
            }
            let Some(pair) = pair_of(first, second, facing_min) else {
                continue;
            };
            if pair.width_m > width_max_m {
                if too_wide.is_none_or(|known| pair.width_m < known.width_m) {
                    too_wide = Some(pair);
                }
                continue;
            }
            let entry = best.entry(cell_of(&pair)).or_insert(pair);
            if quality(&pair) > quality(entry) {
                *entry = pair;
            }
        }
    }
    let mut pairs: Vec<AntipodalPair> = best.into_values().collect();
    pairs.sort_by(|a, b| quality(b).total_cmp(&quality(a)));
    (pairs, too_wide)
}

fn pair_of(first: &ContactPoint, second: &ContactPoint, facing_min: f64) -> Option<AntipodalPair> {
    let between = second.position - first.position;
    // Most pairs lie on one side, or face one another.
    if between.dot(&first.normal) >= 0.0 || between.dot(&second.normal) <= 0.0 {
        return None;
    }
    // The contacts are samples: those of a thin wall face each other only nearly, so that the
    // normals, not the line between them, say how it is closed on.
    let thickness = (second.normal - first.normal).try_normalize(1e-6)?;
    let aside_m = (between - thickness * between.dot(&thickness)).norm();
    let distance_m = between.norm();
    let is_thin = distance_m < THIN_M && aside_m < SPACING_M;
    let closing = if is_thin {
        thickness
    } else {
        between.try_normalize(WIDTH_MIN_M)?
    };
    let width_m = between.dot(&closing);
    let facing = (-closing.dot(&first.normal)).min(closing.dot(&second.normal));
    if width_m < WIDTH_MIN_M || facing < facing_min {
        return None;
    }
    let is_upwards = closing.z > 1e-9 || (closing.z > -1e-9 && closing.x > 0.0);
    Some(AntipodalPair {
        middle: first.position + between * 0.5,
        closing: if is_upwards { closing } else { -closing },
        width_m,
        facing,
        evidence: first.evidence.max(second.evidence),
        is_squeeze: false,
    })
}

/// Quality by which pairs of one cell are compared.
fn quality(pair: &AntipodalPair) -> f64 {
    let evidence = match pair.evidence {
        ContactEvidence::Model | ContactEvidence::Seen => 0.10,
        ContactEvidence::Contour => 0.05,
        ContactEvidence::Mirrored => 0.0,
    };
    pair.facing + evidence
}

fn cell_of(pair: &AntipodalPair) -> [i32; 6] {
    let place = pair.middle.coords.map(|c| (c / CELL_M).floor() as i32);
    let turn = pair.closing.map(|c| (c * N_TURNS).round() as i32);
    [place.x, place.y, place.z, turn.x, turn.y, turn.z]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contact(place: [f64; 3], normal: [f64; 3]) -> ContactPoint {
        ContactPoint {
            position: place.into(),
            normal: normal.into(),
            evidence: ContactEvidence::Seen,
        }
    }

    #[test]
    fn opposite_sides_of_a_slab_are_a_pair_and_its_front_is_none() {
        let contacts = [
            contact([0.0, -0.03, 0.05], [0.0, -1.0, 0.0]),
            contact([0.0, 0.03, 0.05], [0.0, 1.0, 0.0]),
            contact([-0.02, 0.0, 0.05], [-1.0, 0.0, 0.0]),
        ];
        let (pairs, too_wide) = antipodal_pairs(&contacts, 0.1, 0.9);
        assert_eq!((pairs.len(), too_wide), (1, None));
        assert!((pairs[0].width_m - 0.06).abs() < 1e-12 && pairs[0].facing > 0.999);
        assert!((pairs[0].middle - Point3::new(0.0, 0.0, 0.05)).norm() < 1e-12);
        // A hand that opens less far leaves it out, and tells how wide it is.
        let (pairs, too_wide) = antipodal_pairs(&contacts, 0.05, 0.9);
        assert!(pairs.is_empty());
        assert!((too_wide.unwrap().width_m - 0.06).abs() < 1e-12);
    }

    #[test]
    fn normals_outside_of_the_friction_cone_are_no_pair() {
        let tilt = 0.6_f64;
        let contacts = [
            contact([0.0, -0.03, 0.0], [0.0, -tilt.cos(), tilt.sin()]),
            contact([0.0, 0.03, 0.0], [0.0, 1.0, 0.0]),
        ];
        assert_eq!(antipodal_pairs(&contacts, 0.1, tilt.cos() + 0.01).0, []);
        assert_eq!(
            antipodal_pairs(&contacts, 0.1, tilt.cos() - 0.01).0.len(),
            1
        );
    }
}
