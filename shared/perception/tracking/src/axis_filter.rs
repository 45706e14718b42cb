//! The Kalman filters of one axis of an object's box.
//!
//! Noise is the same whatever the other axes do, so a box is six small filters
//! instead of one with fifteen states: along each of its axes one for place, speed
//! and half side, and around each one for turn and speed of turning. The
//! covariances live in the box's own frame and turn with it.

use nalgebra::{Matrix2, Matrix3, RowVector2, RowVector3, Vector2, Vector3};

/// Along an axis: covariance of the centre (m), its speed (m/s) and the half side
/// (m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SlideCovariance(Matrix3<f64>);

/// Around an axis: covariance of the turn (rad) and its speed (rad/s).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TurnCovariance(Matrix2<f64>);

/// Which end of an axis a face of the box is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum End {
    /// Against the axis.
    Low,
    /// Along the axis.
    High,
}

impl End {
    /// -1 or 1.
    pub(crate) fn sign(self) -> f64 {
        match self {
            Self::Low => -1.0,
            Self::High => 1.0,
        }
    }
}

/// What changes a state: by how much for a surprise of one.
type SlideGain = Vector3<f64>;

impl SlideCovariance {
    /// Independent uncertainties.
    pub(crate) fn of(centre_m2: f64, speed_m2_s2: f64, half_side_m2: f64) -> Self {
        Self(Matrix3::from_diagonal(&Vector3::new(
            centre_m2,
            speed_m2_s2,
            half_side_m2,
        )))
    }

    /// After `dt_s` of constant velocity with white acceleration (Bar-Shalom, Li
    /// and Kirubarajan 2001, eq. 6.3.2-4), while the half side walks at random by
    /// `resizing_m2_s` a second.
    pub(crate) fn grown(&self, dt_s: f64, acceleration_m_s2: f64, resizing_m2_s: f64) -> Self {
        let step = Matrix3::new(1.0, dt_s, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
        let push = Vector3::new(0.5 * dt_s * dt_s, dt_s, 0.0) * acceleration_m_s2;
        let mut grown = step * self.0 * step.transpose() + push * push.transpose();
        grown[(2, 2)] += resizing_m2_s * dt_s;
        Self(grown)
    }

    /// After the face at an end was measured with a variance, and the gain by which
    /// the surprise of that face, measured minus expected, changes the state.
    ///
    /// A face lies at centre ± half side, which ties the two together: with the
    /// other face unseen a shifted face is read as motion or as size by what is
    /// less certain. Joseph's form keeps the covariance positive.
    pub(crate) fn face_measured(&self, end: End, variance_m2: f64) -> (Self, SlideGain) {
        let observe = RowVector3::new(1.0, 0.0, end.sign());
        let spread = (observe * self.0 * observe.transpose()).x + variance_m2;
        let gain = self.0 * observe.transpose() / spread;
        let keep = Matrix3::identity() - gain * observe;
        let measured = keep * self.0 * keep.transpose() + gain * gain.transpose() * variance_m2;
        (Self(measured), gain)
    }

    /// With a centre that has gone elsewhere and may have any speed.
    pub(crate) fn displaced(&self, by_m2: f64, speed_m2_s2: f64) -> Self {
        let (centre_m2, half_side_m2) = (self.0[(0, 0)], self.0[(2, 2)]);
        Self::of(centre_m2 + by_m2, speed_m2_s2, half_side_m2)
    }

    /// Variance of the centre, square metres.
    pub(crate) fn centre_m2(&self) -> f64 {
        self.0[(0, 0)]
    }

    /// Kept symmetric against rounding, and the speed's variance below a limit.
    pub(crate) fn settled(&self, speed_max_m_s: f64) -> Self {
        let mut settled = (self.0 + self.0.transpose()) * 0.5;
        let limit = speed_max_m_s * speed_max_m_s;
        if settled[(1, 1)] > limit {
            // Scaling a row and its column keeps the matrix positive.
            let scale = (limit / settled[(1, 1)]).sqrt();
            settled.row_mut(1).scale_mut(scale);
            settled.column_mut(1).scale_mut(scale);
        }
        Self(settled)
    }
}

impl TurnCovariance {
    /// Independent uncertainties.
    pub(crate) fn of(turn_rad2: f64, speed_rad2_s2: f64) -> Self {
        Self(Matrix2::from_diagonal(&Vector2::new(
            turn_rad2,
            speed_rad2_s2,
        )))
    }

    /// After `dt_s` with white angular acceleration; the speed dies away within
    /// `damping_s`, because what turns on a table does not go on turning.
    pub(crate) fn grown(&self, dt_s: f64, acceleration_rad_s2: f64, damping_s: f64) -> Self {
        let step = Matrix2::new(1.0, dt_s, 0.0, (-dt_s / damping_s).exp());
        let push = Vector2::new(0.5 * dt_s * dt_s, dt_s) * acceleration_rad_s2;
        Self(step * self.0 * step.transpose() + push * push.transpose())
    }

    /// After the turn was measured with a variance, and the gain of its surprise.
    pub(crate) fn measured(&self, variance_rad2: f64) -> (Self, Vector2<f64>) {
        let observe = RowVector2::new(1.0, 0.0);
        let gain = self.0 * observe.transpose() / (self.0[(0, 0)] + variance_rad2);
        let keep = Matrix2::identity() - gain * observe;
        let measured = keep * self.0 * keep.transpose() + gain * gain.transpose() * variance_rad2;
        (Self(measured), gain)
    }

    /// Variance of the turn, square radians.
    pub(crate) fn turn_rad2(&self) -> f64 {
        self.0[(0, 0)]
    }

    /// Kept symmetric, and within limits: beyond a half turn nothing is known.
    pub(crate) fn settled(&self, turn_max_rad: f64, speed_max_rad_s: f64) -> Self {
        let mut settled = (self.0 + self.0.transpose()) * 0.5;
        for (i, limit) in [turn_max_rad, speed_max_rad_s].into_iter().enumerate() {
            if settled[(i, i)] > limit * limit {
                let scale = limit / settled[(i, i)].sqrt();
                settled.row_mut(i).scale_mut(scale);
                settled.column_mut(i).scale_mut(scale);
            }
        }
        Self(settled)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn is_covariance(matrix: &Matrix3<f64>) -> bool {
        let values = matrix.symmetric_eigenvalues();
        matrix.iter().all(|value| value.is_finite())
            && values.min() > -1e-9 * values.max().max(1e-9)
    }

    #[test]
    fn both_faces_measured_tell_place_and_size_apart() {
        let wide = SlideCovariance::of(1.0, 1.0, 1.0);
        let (one, _) = wide.face_measured(End::High, 1e-6);
        // The sum is known, neither part is.
        assert!(one.centre_m2() > 0.4 && one.0[(2, 2)] > 0.4);
        let (both, _) = one.face_measured(End::Low, 1e-6);
        assert!(both.centre_m2() < 1e-6 && both.0[(2, 2)] < 1e-6);
    }

    #[test]
    fn a_shift_of_a_known_size_is_motion() {
        let sized = SlideCovariance::of(1e-3, 1e-2, 1e-8);
        let (_, gain) = sized.face_measured(End::Low, 1e-6);
        assert!(gain[0] > 0.99 && gain[2].abs() < 1e-3, "{gain}");
    }

    proptest! {
        #[test]
        fn covariances_stay_covariances(
            steps in prop::collection::vec((0.0..3.0_f64, 0.01..100.0_f64, any::<bool>(), 1e-8..10.0_f64), 1..100),
        ) {
            let mut slide = SlideCovariance::of(1e-5, 0.5, 1e-4);
            let mut turn = TurnCovariance::of(0.01, 1.0);
            for (dt_s, push, high, variance) in steps {
                let end = if high { End::High } else { End::Low };
                slide = slide.grown(dt_s, push, 1e-5).settled(5.0).face_measured(end, variance).0.settled(5.0);
                turn = turn.grown(dt_s, push, 0.3).settled(3.2, 20.0).measured(variance).0.settled(3.2, 20.0);
                prop_assert!(is_covariance(&slide.0), "{}", slide.0);
                prop_assert!(slide.0[(1, 1)] <= 25.0001 && slide.centre_m2() > 0.0);
                prop_assert!(turn.turn_rad2() > 0.0 && turn.turn_rad2() <= variance.max(3.2 * 3.2));
                prop_assert!(turn.0.determinant() > -1e-9);
            }
        }
    }
}
