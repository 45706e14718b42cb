//! Confidence of each face of a measured bounding box under occlusion.
//!
//! Occlusion moves a face of the measured box although the object does not move. Each
//! face is therefore a separate measurement, and it counts only where the surface could
//! have been seen.

use crate::depth_view::DepthView;
use crate::viewing_conditions::{HandContact, ViewingConditions};
use geometry::OrientedBox;
use nalgebra::{Translation3, Vector3};

/// Gate, in sigmas, within which the measured and the expected side length agree.
/// Chosen.
const SIDE_NOISE_SIGMAS: f64 = 3.0;

/// Smallest tolerance between the measured and the expected side length, metres. Chosen.
const SIDE_NOISE_MIN_M: f64 = 0.006;

/// Largest growth of a side between two frames that is accepted at once, metres. A
/// larger growth means that another body was merged or a hidden part was revealed, and
/// must persist. Chosen.
const GROWTH_MAX_M: f64 = 0.02;

/// Lateral scale of an occlusion slab relative to the face: only the middle of the face
/// is tested. Chosen.
const SLAB_RATIO: f64 = 0.85;

/// Smallest half thickness of an occlusion slab, metres. Chosen.
const SLAB_HALF_MIN_M: f64 = 0.002;

/// Occluded fraction of a slab above which a surface may be present but unseen. Chosen.
const OCCLUDED_FRACTION_MAX: f64 = 0.15;

/// Occluded fraction for slabs below the measured box. It is higher because a lifted
/// object occludes most of the space under itself. Chosen.
const FOOT_OCCLUDED_FRACTION_MAX: f64 = 0.7;

/// Unseen fraction of a slab above which the object may continue there without depth: a
/// surface that is too close to the sensor or that reflects has none. More of the slab is
/// unseen than seen.
const UNSEEN_FRACTION_MAX: f64 = 0.5;

/// Thickness of the slab beyond a measured face in which a truncated object may continue,
/// metres. It is wider than the lateral noise of the depth image at 2 m (1.2 pixels of 3.4
/// mm), so that a border of the image shows up in it.
const CUT_SLAB_M: f64 = 0.01;

/// Unseen fraction of the slab beyond a measured face above which the image border cuts the
/// object there: the slab is more out of the image than in it.
const CUT_UNSEEN_FRACTION_MIN: f64 = 0.5;

/// Index of the box axis that points up.
pub(crate) const UPRIGHT: usize = 2;

/// Signs of the two faces along an axis.
const SIGNS: [f64; 2] = [-1.0, 1.0];

/// Confidence in a face of the measured box.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum FaceConfidence {
    /// Reliable face: the object ends at this face.
    Reliable,
    /// Doubtful face: the object seems to end here, against earlier measurements.
    Doubtful,
    /// Occluded face: the space beyond it is hidden, so it carries no information.
    Occluded,
}

/// One-dimensional comparison of the measured with the expected box, along an axis of
/// the expected box.
#[derive(Debug, Clone, Copy)]
struct AxisComparison {
    expected_half_m: f64,
    /// Measured centre minus expected centre, metres.
    shift_m: f64,
    measured_half_m: f64,
    noise_m: f64,
}

impl AxisComparison {
    /// Signed distance of a measured face beyond the expected one, metres; `sign`
    /// selects the face (-1 or 1).
    fn beyond_m(&self, sign: f64) -> f64 {
        sign * self.shift_m + self.measured_half_m - self.expected_half_m
    }

    /// Coordinate of a measured face along the axis, metres.
    fn measured_m(&self, sign: f64) -> f64 {
        self.shift_m + sign * self.measured_half_m
    }

    fn growth_m(&self) -> f64 {
        2.0 * (self.measured_half_m - self.expected_half_m)
    }
}

/// Smallest translation along each axis of the expected box that explains the measured
/// box, metres. Zero where the measured box lies within the expected one, as the box of
/// a visible part does.
pub(crate) fn minimal_shifts_m(measured: &OrientedBox, expected: &OrientedBox) -> Vector3<f64> {
    let shift = (expected.frame_from_box.inverse() * measured.centre()).coords;
    let growth = measured.half_sides_m - expected.half_sides_m;
    shift.zip_map(&growth, |shift, growth| {
        let (low, high) = (shift - growth, shift + growth);
        if low * high <= 0.0 {
            0.0
        } else if low.abs() < high.abs() {
            low
        } else {
            high
        }
    })
}

/// Confidence of the faces of a measured box, `[negative, positive]` for each axis.
///
/// `measured` is aligned with the axes of `expected`; `sigmas_m` is the noise of a face
/// along them, metres. The lower face of an object that stands on the table is
/// `Reliable`. Without a depth image a face inside the expected box is `Occluded` if the
/// object is truncated, and `Doubtful` otherwise.
pub(crate) fn face_confidences(
    measured: &OrientedBox,
    expected: &OrientedBox,
    sigmas_m: &Vector3<f64>,
    conditions: &ViewingConditions,
    view: Option<&DepthView<'_>>,
) -> [[FaceConfidence; 2]; 3] {
    let shift = expected.frame_from_box.inverse() * measured.centre();
    let may_be_cut = conditions.is_truncated && !conditions.is_handled();
    std::array::from_fn(|axis| {
        let comparison = AxisComparison {
            expected_half_m: expected.half_sides_m[axis],
            shift_m: shift[axis],
            measured_half_m: measured.half_sides_m[axis],
            noise_m: (SIDE_NOISE_SIGMAS * sigmas_m[axis]).max(SIDE_NOISE_MIN_M),
        };
        let is_occluded = |ends_m: [f64; 2]| match view {
            Some(view) => {
                let is_foot = axis == UPRIGHT && ends_m[1] < ends_m[0];
                let fraction_max = if is_foot {
                    FOOT_OCCLUDED_FRACTION_MAX
                } else {
                    OCCLUDED_FRACTION_MAX
                };
                let slab = slab(expected, axis, ends_m);
                view.occluded_fraction(&slab) > fraction_max
                    || !conditions.is_handled() && view.unseen_fraction(&slab) > UNSEEN_FRACTION_MAX
            }
            None => conditions.is_truncated,
        };
        if conditions.hand_contact == HandContact::Overlapping
            && comparison.growth_m() > comparison.noise_m
        {
            // Either face may belong to the hand.
            return [FaceConfidence::Occluded; 2];
        }
        let mut faces = confidences_along_axis(&comparison, is_occluded);
        for (face, sign) in faces.iter_mut().zip(SIGNS) {
            let face_m = comparison.measured_m(sign);
            let beyond = slab(expected, axis, [face_m, face_m + sign * CUT_SLAB_M]);
            let is_inside = comparison.beyond_m(sign) <= 0.0;
            if may_be_cut && is_inside && is_out_of_sight(&beyond, view) {
                *face = FaceConfidence::Occluded;
            }
        }
        let [low, high] = faces.map(|confidence| {
            // A hand merged with the object must not make it grow.
            if conditions.is_handled()
                && confidence == FaceConfidence::Doubtful
                && comparison.growth_m() > 0.0
            {
                FaceConfidence::Occluded
            } else {
                confidence
            }
        });
        if conditions.stands_on_table && axis == UPRIGHT {
            [FaceConfidence::Reliable, high]
        } else {
            [low, high]
        }
    })
}

/// Confidence of the two faces along one axis. `is_occluded` tests the slab between two
/// coordinates on it.
fn confidences_along_axis(
    comparison: &AxisComparison,
    is_occluded: impl Fn([f64; 2]) -> bool,
) -> [FaceConfidence; 2] {
    let growth_m = comparison.growth_m();
    if growth_m > GROWTH_MAX_M {
        // The face that has moved less belongs to the object.
        return SIGNS.map(|sign| {
            if comparison.beyond_m(sign) > 0.5 * growth_m {
                FaceConfidence::Doubtful
            } else {
                FaceConfidence::Reliable
            }
        });
    }
    if growth_m >= -comparison.noise_m {
        return [FaceConfidence::Reliable; 2];
    }
    SIGNS.map(|sign| {
        let beyond_m = comparison.beyond_m(sign);
        let seen_m = comparison.measured_m(sign);
        let other_seen_m = comparison.measured_m(-sign);
        if beyond_m >= comparison.noise_m {
            FaceConfidence::Reliable
        } else if is_occluded([seen_m, sign * comparison.expected_half_m]) {
            FaceConfidence::Occluded
        } else if beyond_m < -comparison.noise_m
            && is_occluded([other_seen_m, other_seen_m + sign * growth_m])
        {
            // This face is visible, and the other one has room behind an occluder: the
            // object has moved. A smaller shift does not prove a visible end: the
            // outermost points of a round object may be occluded, and following them
            // would make the track creep.
            FaceConfidence::Reliable
        } else {
            FaceConfidence::Doubtful
        }
    })
}

/// True if most of the slab beyond a face is out of sight: there the border of the image
/// cuts a truncated object, however little its face has moved. A track would otherwise
/// follow the border over an object that leaves the image. A cut face beyond the expected
/// one is a lower bound and still lets an object grow that enters the image.
fn is_out_of_sight(beyond: &OrientedBox, view: Option<&DepthView<'_>>) -> bool {
    view.is_some_and(|view| view.unseen_fraction(beyond) > CUT_UNSEEN_FRACTION_MIN)
}

/// Slab between two coordinates along an axis of the expected box.
fn slab(expected: &OrientedBox, axis: usize, ends_m: [f64; 2]) -> OrientedBox {
    let [from_m, to_m] = ends_m;
    let mut centre = Vector3::zeros();
    centre[axis] = 0.5 * (from_m + to_m);
    let mut half_sides_m = expected.half_sides_m * SLAB_RATIO;
    half_sides_m[axis] = (0.5 * (to_m - from_m).abs()).max(SLAB_HALF_MIN_M);
    OrientedBox {
        frame_from_box: expected.frame_from_box * Translation3::from(centre),
        half_sides_m,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use FaceConfidence::{Doubtful, Occluded, Reliable};
    use geometry::RigidTransform;
    use sensor_noise::DepthNoise;

    /// Confidences along x of a box from `low` to `high` where -0.1 to 0.1 is expected.
    fn along_x(low: f64, high: f64, is_truncated: bool) -> [FaceConfidence; 2] {
        let shape = |low: f64, high: f64| OrientedBox {
            frame_from_box: RigidTransform::translation(0.5 * (low + high), 0.0, 0.0),
            half_sides_m: Vector3::new(0.5 * (high - low), 0.05, 0.05),
        };
        let conditions = ViewingConditions {
            depth_m: 1.0,
            depth_noise: DepthNoise::KINECT_V1,
            ray_in_world: Vector3::y_axis(),
            variances_m2: Vector3::repeat(1e-3),
            stands_on_table: false,
            is_truncated,
            hand_contact: HandContact::None,
        };
        let sigmas_m = Vector3::repeat(0.002);
        face_confidences(
            &shape(low, high),
            &shape(-0.1, 0.1),
            &sigmas_m,
            &conditions,
            None,
        )[0]
    }

    #[test]
    fn a_box_of_the_expected_size_is_reliable_at_any_position() {
        for shift in [0.0, 0.003, -0.05, 0.2] {
            assert_eq!(along_x(-0.1 + shift, 0.101 + shift, true), [Reliable; 2]);
        }
    }

    #[test]
    fn a_smaller_box_is_reliable_where_it_sticks_out() {
        assert_eq!(along_x(-0.11, 0.05, true), [Reliable, Occluded]);
        assert_eq!(along_x(-0.11, 0.05, false), [Reliable, Doubtful]);
        assert_eq!(along_x(-0.06, 0.11, true), [Occluded, Reliable]);
        assert_eq!(along_x(-0.06, 0.06, true), [Occluded, Occluded]);
        // It has moved out on one side, which is visible.
        assert_eq!(along_x(-0.03, 0.13, true), [Occluded, Reliable]);
    }

    #[test]
    fn a_smaller_box_at_rest_is_not_motion() {
        for end in [0.097, 0.1, 0.103] {
            assert_eq!(along_x(-0.06, end, true), [Occluded, Occluded]);
        }
    }

    #[test]
    fn a_visible_end_moves_when_the_other_is_occluded() {
        let lifted = AxisComparison {
            expected_half_m: 0.1,
            shift_m: 0.03,
            measured_half_m: 0.07,
            noise_m: 0.006,
        };
        let hidden_above = confidences_along_axis(&lifted, |[from, to]| from.max(to) > 0.1);
        assert_eq!(hidden_above, [Reliable, Doubtful]);
        assert_eq!(
            confidences_along_axis(&lifted, |_| false),
            [Doubtful, Doubtful]
        );
        assert_eq!(
            confidences_along_axis(&lifted, |_| true),
            [Occluded, Occluded]
        );
    }

    #[test]
    fn a_sudden_growth_is_reliable_at_the_face_that_stays() {
        assert_eq!(along_x(-0.1, 0.11, false), [Reliable, Reliable]);
        assert_eq!(along_x(-0.1, 0.16, false), [Reliable, Doubtful]);
        assert_eq!(along_x(-0.17, 0.1, false), [Doubtful, Reliable]);
    }

    #[test]
    fn a_face_without_depth_beyond_it_is_occluded() {
        // A wall at 1.4 m with depth from column 320 on only: the object, 1 m away, leaves
        // the view to the left.
        let camera = geometry::PinholeCamera::KINECT_V1;
        let column = |i: usize| i as u32 % camera.width;
        let depth_m = |i: usize| if column(i) < 320 { f32::NAN } else { 1.4 };
        let point = |i: usize| point_cloud::Point {
            z: depth_m(i),
            ..point_cloud::Point::default()
        };
        let cloud: Vec<_> = (0..camera.n_pixels()).map(point).collect();
        let pose = RigidTransform::identity();
        let view = DepthView::new(&cloud, camera, &pose, DepthNoise::KINECT_V1).unwrap();
        let shape = |low: f64, high: f64| OrientedBox {
            frame_from_box: RigidTransform::translation(0.5 * (low + high), 0.0, 1.0),
            half_sides_m: Vector3::new(0.5 * (high - low), 0.05, 0.05),
        };
        let conditions = |is_truncated| ViewingConditions {
            depth_m: 1.0,
            depth_noise: DepthNoise::KINECT_V1,
            ray_in_world: Vector3::z_axis(),
            variances_m2: Vector3::repeat(1e-3),
            stands_on_table: false,
            is_truncated,
            hand_contact: HandContact::None,
        };
        let along_x = |low: f64, expected_low: f64, is_truncated| {
            let (measured, expected) = (shape(low, 0.1), shape(expected_low, 0.1));
            let (sigmas_m, conditions) = (Vector3::repeat(0.002), conditions(is_truncated));
            face_confidences(&measured, &expected, &sigmas_m, &conditions, Some(&view))[0]
        };
        assert_eq!(along_x(0.0, -0.003, true), [Occluded, Reliable]);
        assert_eq!(along_x(0.0, -0.003, false), [Reliable, Reliable]);
        // It enters the image: the visible part is at least as large as this.
        assert_eq!(along_x(-0.006, -0.003, true), [Reliable, Reliable]);
        // Half of it is too close to have depth, or ends where the wall is seen.
        assert_eq!(along_x(0.0, -0.05, false), [Occluded, Doubtful]);
        assert_eq!(along_x(0.06, 0.01, false), [Doubtful, Doubtful]);
    }

    #[test]
    fn a_slab_lies_between_the_faces() {
        let expected = OrientedBox {
            frame_from_box: RigidTransform::translation(0.0, 0.0, 1.0),
            half_sides_m: Vector3::new(0.1, 0.05, 0.08),
        };
        let between = slab(&expected, 0, [0.06, 0.1]);
        assert!((between.centre().x - 0.08).abs() < 1e-12);
        assert!((between.half_sides_m.x - 0.02).abs() < 1e-12);
    }
}
