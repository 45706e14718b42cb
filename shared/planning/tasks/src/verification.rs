//! Verification by sight: an object was lifted, or stands at its place.

use crate::table_object::TableObject;
use geometry::OrientedBox;
use nalgebra::Point3;

/// Distance within which something stands where an object stood, seen from above, metres. Chosen.
const SAME_PLACE_M: f64 = 0.03;
/// Rise above which an object is lifted, metres. Chosen: twice the depth noise of a Kinect at 2 m and
/// less than half of a lift.
const RISE_M: f64 = 0.03;
/// Distance from the planned place within which an object was set down there, metres. Chosen: it may
/// have turned between the fingers.
const AT_PLACE_M: f64 = 0.06;

/// True if a scene shows that an object no longer stands where it stood: neither its track nor any
/// other seen one is there.
pub fn is_place_empty(stood: &OrientedBox, objects: &[TableObject]) -> bool {
    let was = stood.centre();
    !objects.iter().any(|object| {
        let is = object.body.centre();
        let is_there = (is.xy() - was.xy()).norm() <= SAME_PLACE_M;
        object.is_seen && is_there && is.z - was.z < RISE_M
    })
}

/// Seen object nearest to a place at which one was set down; `None` when nothing stands there.
pub fn object_at<'a>(foot: &Point3<f64>, objects: &'a [TableObject]) -> Option<&'a TableObject> {
    let distance_m = |object: &TableObject| (object.body.centre().xy() - foot.xy()).norm();
    objects
        .iter()
        .filter(|object| object.is_seen && distance_m(object) <= AT_PLACE_M)
        .min_by(|a, b| distance_m(a).total_cmp(&distance_m(b)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table_object::tests::object;

    const CUP: [f64; 3] = [0.08, 0.08, 0.1];

    #[test]
    fn place_is_empty_when_its_object_is_lifted_or_gone() {
        let stood = object(1, "cup", [0.3, 0.0, 0.0], CUP);
        let beside = object(2, "cup", [0.4, 0.0, 0.0], CUP);
        let at = |z_m: f64| object(1, "cup", [0.3, 0.0, z_m], CUP);
        assert!(!is_place_empty(&stood.body, &[at(0.0), beside.clone()]));
        assert!(is_place_empty(&stood.body, &[at(0.1), beside.clone()]));
        assert!(is_place_empty(&stood.body, &[beside]));
        let mut hidden = at(0.0);
        hidden.is_seen = false;
        assert!(is_place_empty(&stood.body, &[hidden]));
    }

    #[test]
    fn object_at_its_place_is_the_nearest_one() {
        let objects = [
            object(1, "cup", [0.34, 0.0, 0.0], CUP),
            object(2, "cup", [0.31, 0.0, 0.0], CUP),
        ];
        let at = |x_m: f64| object_at(&Point3::new(x_m, 0.0, 0.0), &objects);
        assert_eq!(at(0.3).map(|found| found.track), Some(2));
        assert_eq!(at(0.5), None);
    }
}
