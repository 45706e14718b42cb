//! Which faces of a measured box are those of the object.
//!
//! What hides a part of an object moves a face of its measured box, not the object.
//! So each face is a measurement of its own, and believed only where the surface
//! could have been seen.

use crate::depth_view::DepthView;
use crate::measurement::{Circumstances, Handling};
use geometry::OrientedBox;
use nalgebra::{Translation3, Vector3};

/// Sides differ by noise up to so many sigma, and at least by this, metres.
const NOISE_SIGMAS: f64 = 3.0;
const NOISE_MIN_M: f64 = 0.006;

/// A box that grows by more from one frame to the next has taken in something
/// else, or shows what was hidden: it has to last, metres.
const GROWTH_MAX_M: f64 = 0.02;

/// A slab is drawn in at its rim: it is the middle of a face that counts.
const SLAB_SHARE: f64 = 0.85;

/// A slab is at least so thick, half of it, metres.
const SLAB_HALF_MIN_M: f64 = 0.002;

/// With more than this share of a slab hidden, a surface may be there, unseen. An
/// object hides the most of what is under it when it is lifted.
const OBSTRUCTED_SHARE: f64 = 0.15;
const FOOT_OBSTRUCTED_SHARE: f64 = 0.7;

/// The axis of a box that points up.
pub(crate) const UPRIGHT: usize = 2;

/// How far a face is to be believed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Trust {
    /// The object ends there.
    Sure,
    /// It seems to end there, against what was seen before.
    Doubtful,
    /// What lies beyond is hidden: it says nothing.
    Hidden,
}

/// A measured box beside the expected one, along one axis of the latter.
#[derive(Debug, Clone, Copy)]
struct Interval {
    expected_half_m: f64,
    /// Measured centre minus expected one.
    shift_m: f64,
    measured_half_m: f64,
    noise_m: f64,
}

impl Interval {
    /// How far the face at an end (-1, 1) lies beyond the expected one.
    fn beyond_m(&self, sign: f64) -> f64 {
        sign * self.shift_m + self.measured_half_m - self.expected_half_m
    }

    fn growth_m(&self) -> f64 {
        2.0 * (self.measured_half_m - self.expected_half_m)
    }
}

/// How far the object must have moved along each axis of the expected box for its
/// ends to fit what was measured of it, metres: not at all where the measured box
/// lies within the expected one, as that of a part does.
pub(crate) fn least_shifts_m(measured: &OrientedBox, expected: &OrientedBox) -> Vector3<f64> {
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

/// The trust in each face of a measured box, `[low, high]` for each axis.
///
/// `measured` is read along the axes of `expected`; `sigmas_m` is the noise of a
/// face along them. What stands on the table is `Sure` to end there. Without a view
/// into the frame a face within the expected box is `Hidden` where the object is
/// cut, and `Doubtful` otherwise.
pub(crate) fn trust(
    measured: &OrientedBox,
    expected: &OrientedBox,
    sigmas_m: &Vector3<f64>,
    seen: &Circumstances,
    view: Option<&DepthView<'_>>,
) -> [[Trust; 2]; 3] {
    let shift = expected.frame_from_box.inverse() * measured.centre();
    std::array::from_fn(|axis| {
        let interval = Interval {
            expected_half_m: expected.half_sides_m[axis],
            shift_m: shift[axis],
            measured_half_m: measured.half_sides_m[axis],
            noise_m: (NOISE_SIGMAS * sigmas_m[axis]).max(NOISE_MIN_M),
        };
        let is_obstructed = |ends_m: [f64; 2]| match view {
            Some(view) => {
                let is_foot = axis == UPRIGHT && ends_m[1] < ends_m[0];
                let share_max = if is_foot {
                    FOOT_OBSTRUCTED_SHARE
                } else {
                    OBSTRUCTED_SHARE
                };
                view.obstructed_share(&slab(expected, axis, ends_m)) > share_max
            }
            None => seen.is_cut,
        };
        if seen.handling == Handling::WithinHand && interval.growth_m() > interval.noise_m {
            // Which end of it is the hand's is not known.
            return [Trust::Hidden; 2];
        }
        let [low, high] = trust_along(&interval, is_obstructed).map(|trust| {
            // A hand that is taken for a part of the object does not make it grow.
            if seen.is_handled() && trust == Trust::Doubtful && interval.growth_m() > 0.0 {
                Trust::Hidden
            } else {
                trust
            }
        });
        if seen.stands_on_table && axis == UPRIGHT {
            [Trust::Sure, high]
        } else {
            [low, high]
        }
    })
}

/// The trust in the two faces along an axis. `is_obstructed` is asked of places
/// between two coordinates on it.
fn trust_along(interval: &Interval, is_obstructed: impl Fn([f64; 2]) -> bool) -> [Trust; 2] {
    const SIGNS: [f64; 2] = [-1.0, 1.0];
    let growth_m = interval.growth_m();
    if growth_m > GROWTH_MAX_M {
        // The end that has grown less is the object's.
        return SIGNS.map(|sign| {
            if interval.beyond_m(sign) > 0.5 * growth_m {
                Trust::Doubtful
            } else {
                Trust::Sure
            }
        });
    }
    if growth_m >= -interval.noise_m {
        return [Trust::Sure; 2];
    }
    SIGNS.map(|sign| {
        let beyond_m = interval.beyond_m(sign);
        let seen_m = interval.shift_m + sign * interval.measured_half_m;
        let other_seen_m = interval.shift_m - sign * interval.measured_half_m;
        if beyond_m >= interval.noise_m {
            Trust::Sure
        } else if is_obstructed([seen_m, sign * interval.expected_half_m]) {
            Trust::Hidden
        } else if beyond_m < -interval.noise_m
            && is_obstructed([other_seen_m, other_seen_m + sign * growth_m])
        {
            // It is seen to end here, and has room behind something at the other
            // end: it has moved. What has moved less is not surely an end: the
            // outermost points of what is round may be hidden, and following them
            // creeps.
            Trust::Sure
        } else {
            Trust::Doubtful
        }
    })
}

/// The place between two coordinates along an axis of the expected box.
fn slab(expected: &OrientedBox, axis: usize, ends_m: [f64; 2]) -> OrientedBox {
    let [from_m, to_m] = ends_m;
    let mut centre = Vector3::zeros();
    centre[axis] = 0.5 * (from_m + to_m);
    let mut half_sides_m = expected.half_sides_m * SLAB_SHARE;
    half_sides_m[axis] = (0.5 * (to_m - from_m).abs()).max(SLAB_HALF_MIN_M);
    OrientedBox {
        frame_from_box: expected.frame_from_box * Translation3::from(centre),
        half_sides_m,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Trust::{Doubtful, Hidden, Sure};
    use geometry::RigidTransform;

    /// The trust along x of a box from `low` to `high` where -0.1 to 0.1 is expected.
    fn along_x(low: f64, high: f64, is_cut: bool) -> [Trust; 2] {
        let shape = |low: f64, high: f64| OrientedBox {
            frame_from_box: RigidTransform::translation(0.5 * (low + high), 0.0, 0.0),
            half_sides_m: Vector3::new(0.5 * (high - low), 0.05, 0.05),
        };
        let seen = Circumstances {
            depth_m: 1.0,
            ray_in_world: Vector3::y_axis(),
            variances_m2: Vector3::repeat(1e-3),
            stands_on_table: false,
            is_cut,
            handling: Handling::Alone,
        };
        let sigmas_m = Vector3::repeat(0.002);
        trust(&shape(low, high), &shape(-0.1, 0.1), &sigmas_m, &seen, None)[0]
    }

    #[test]
    fn a_box_of_the_expected_size_is_believed_wherever_it_is() {
        for shift in [0.0, 0.003, -0.05, 0.2] {
            assert_eq!(along_x(-0.1 + shift, 0.101 + shift, true), [Sure; 2]);
        }
    }

    #[test]
    fn a_smaller_box_is_believed_where_it_sticks_out() {
        assert_eq!(along_x(-0.11, 0.05, true), [Sure, Hidden]);
        assert_eq!(along_x(-0.11, 0.05, false), [Sure, Doubtful]);
        assert_eq!(along_x(-0.06, 0.11, true), [Hidden, Sure]);
        assert_eq!(along_x(-0.06, 0.06, true), [Hidden, Hidden]);
        // It has moved out on one side: that side is seen.
        assert_eq!(along_x(-0.03, 0.13, true), [Hidden, Sure]);
    }

    #[test]
    fn a_smaller_box_at_rest_tells_of_no_motion() {
        for end in [0.097, 0.1, 0.103] {
            assert_eq!(along_x(-0.06, end, true), [Hidden, Hidden]);
        }
    }

    #[test]
    fn an_end_that_is_seen_free_moves_when_the_other_is_hidden() {
        let lifted = Interval {
            expected_half_m: 0.1,
            shift_m: 0.03,
            measured_half_m: 0.07,
            noise_m: 0.006,
        };
        let hidden_above = trust_along(&lifted, |[from, to]| from.max(to) > 0.1);
        assert_eq!(hidden_above, [Sure, Doubtful]);
        assert_eq!(trust_along(&lifted, |_| false), [Doubtful, Doubtful]);
        assert_eq!(trust_along(&lifted, |_| true), [Hidden, Hidden]);
    }

    #[test]
    fn a_sudden_growth_is_believed_at_the_end_that_stays() {
        assert_eq!(along_x(-0.1, 0.11, false), [Sure, Sure]);
        assert_eq!(along_x(-0.1, 0.16, false), [Sure, Doubtful]);
        assert_eq!(along_x(-0.17, 0.1, false), [Doubtful, Sure]);
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
