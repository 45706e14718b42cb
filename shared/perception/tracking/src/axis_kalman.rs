//! Per-axis Kalman filters of an oriented bounding box.
//!
//! The noise along one axis is independent of the other axes. The box is therefore
//! estimated by six small filters instead of one with fifteen states: per axis one for
//! centre, speed and half side, and one for rotation and angular speed. The covariances
//! are expressed in the box frame and turn with it.

use nalgebra::{Matrix2, Matrix3, RowVector2, RowVector3, Vector2, Vector3};

/// Covariance of centre (m), speed (m/s) and half side (m) along one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TranslationCovariance(Matrix3<f64>);

/// Covariance of rotation angle (rad) and angular speed (rad/s) about one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RotationCovariance(Matrix2<f64>);

/// Side of an axis on which a face of the box lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum FaceSide {
    /// Face on the negative side of the axis.
    Negative,
    /// Face on the positive side of the axis.
    Positive,
}

impl FaceSide {
    /// Sign of the side: -1 or 1.
    pub(crate) fn sign(self) -> f64 {
        match self {
            Self::Negative => -1.0,
            Self::Positive => 1.0,
        }
    }
}

/// Kalman gain: change of (centre, speed, half side) per unit of innovation.
type TranslationGain = Vector3<f64>;

impl TranslationCovariance {
    /// Diagonal covariance from the variances of centre, speed and half side.
    pub(crate) fn from_variances(centre_m2: f64, speed_m2_s2: f64, half_side_m2: f64) -> Self {
        Self(Matrix3::from_diagonal(&Vector3::new(
            centre_m2,
            speed_m2_s2,
            half_side_m2,
        )))
    }

    /// Covariance predicted by `dt_s` with a constant-velocity model and white
    /// acceleration (Bar-Shalom, Li and Kirubarajan 2001, eq. 6.3.2-4). The half side is
    /// a random walk of variance `size_walk_m2_s` per second.
    pub(crate) fn predicted(&self, dt_s: f64, acceleration_m_s2: f64, size_walk_m2_s: f64) -> Self {
        let transition = Matrix3::new(1.0, dt_s, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
        let noise_input = Vector3::new(0.5 * dt_s * dt_s, dt_s, 0.0) * acceleration_m_s2;
        let mut predicted =
            transition * self.0 * transition.transpose() + noise_input * noise_input.transpose();
        predicted[(2, 2)] += size_walk_m2_s * dt_s;
        Self(predicted)
    }

    /// Covariance and Kalman gain after one face was measured with a variance. The
    /// innovation is the measured minus the expected position of the face.
    ///
    /// A face lies at centre ± half side, which correlates the two: with the other face
    /// unseen, a shifted face is attributed to motion or to size, by which is less
    /// certain. Joseph's form keeps the covariance positive definite.
    pub(crate) fn updated_by_face(
        &self,
        side: FaceSide,
        variance_m2: f64,
    ) -> (Self, TranslationGain) {
        let observation = RowVector3::new(1.0, 0.0, side.sign());
        let innovation_variance = (observation * self.0 * observation.transpose()).x + variance_m2;
        let gain = self.0 * observation.transpose() / innovation_variance;
        let keep = Matrix3::identity() - gain * observation;
        let measured = keep * self.0 * keep.transpose() + gain * gain.transpose() * variance_m2;
        (Self(measured), gain)
    }

    /// Covariance after a jump: the centre variance grows by `by_m2`, the speed is
    /// unknown.
    pub(crate) fn after_jump(&self, by_m2: f64, speed_m2_s2: f64) -> Self {
        let (centre_m2, half_side_m2) = (self.0[(0, 0)], self.0[(2, 2)]);
        Self::from_variances(centre_m2 + by_m2, speed_m2_s2, half_side_m2)
    }

    /// Variance of the box centre, square metres.
    pub(crate) fn centre_variance_m2(&self) -> f64 {
        self.0[(0, 0)]
    }

    /// Symmetrised covariance with a bounded variance of the speed.
    pub(crate) fn bounded(&self, speed_max_m_s: f64) -> Self {
        let mut bounded = (self.0 + self.0.transpose()) * 0.5;
        let limit = speed_max_m_s * speed_max_m_s;
        if bounded[(1, 1)] > limit {
            // Scaling a row and its column keeps the matrix positive.
            let scale = (limit / bounded[(1, 1)]).sqrt();
            bounded.row_mut(1).scale_mut(scale);
            bounded.column_mut(1).scale_mut(scale);
        }
        Self(bounded)
    }
}

impl RotationCovariance {
    /// Diagonal covariance from the variances of rotation angle and angular speed.
    pub(crate) fn from_variances(turn_rad2: f64, speed_rad2_s2: f64) -> Self {
        Self(Matrix2::from_diagonal(&Vector2::new(
            turn_rad2,
            speed_rad2_s2,
        )))
    }

    /// Covariance predicted by `dt_s` with white angular acceleration. The angular speed
    /// decays with time constant `damping_s`, since an object on a table stops turning.
    pub(crate) fn predicted(&self, dt_s: f64, acceleration_rad_s2: f64, damping_s: f64) -> Self {
        let transition = Matrix2::new(1.0, dt_s, 0.0, (-dt_s / damping_s).exp());
        let noise_input = Vector2::new(0.5 * dt_s * dt_s, dt_s) * acceleration_rad_s2;
        Self(transition * self.0 * transition.transpose() + noise_input * noise_input.transpose())
    }

    /// Covariance and Kalman gain after the rotation angle was measured with a variance.
    pub(crate) fn updated(&self, variance_rad2: f64) -> (Self, Vector2<f64>) {
        let observation = RowVector2::new(1.0, 0.0);
        let gain = self.0 * observation.transpose() / (self.0[(0, 0)] + variance_rad2);
        let keep = Matrix2::identity() - gain * observation;
        let measured = keep * self.0 * keep.transpose() + gain * gain.transpose() * variance_rad2;
        (Self(measured), gain)
    }

    /// Variance of the rotation angle, square radians.
    pub(crate) fn rotation_variance_rad2(&self) -> f64 {
        self.0[(0, 0)]
    }

    /// Symmetrised covariance with bounded variances: beyond half a turn the angle is
    /// unknown.
    pub(crate) fn bounded(&self, turn_max_rad: f64, speed_max_rad_s: f64) -> Self {
        let mut bounded = (self.0 + self.0.transpose()) * 0.5;
        for (i, limit) in [turn_max_rad, speed_max_rad_s].into_iter().enumerate() {
            if bounded[(i, i)] > limit * limit {
                let scale = limit / bounded[(i, i)].sqrt();
                bounded.row_mut(i).scale_mut(scale);
                bounded.column_mut(i).scale_mut(scale);
            }
        }
        Self(bounded)
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
    fn two_measured_faces_separate_centre_and_size() {
        let wide = TranslationCovariance::from_variances(1.0, 1.0, 1.0);
        let (one, _) = wide.updated_by_face(FaceSide::Positive, 1e-6);
        // The sum of centre and half side is known, neither summand is.
        assert!(one.centre_variance_m2() > 0.4 && one.0[(2, 2)] > 0.4);
        let (both, _) = one.updated_by_face(FaceSide::Negative, 1e-6);
        assert!(both.centre_variance_m2() < 1e-6 && both.0[(2, 2)] < 1e-6);
    }

    #[test]
    fn a_shifted_face_of_a_known_size_is_motion() {
        let sized = TranslationCovariance::from_variances(1e-3, 1e-2, 1e-8);
        let (_, gain) = sized.updated_by_face(FaceSide::Negative, 1e-6);
        assert!(gain[0] > 0.99 && gain[2].abs() < 1e-3, "{gain}");
    }

    proptest! {
        #[test]
        fn covariances_stay_positive_semidefinite_and_bounded(
            steps in prop::collection::vec((0.0..3.0_f64, 0.01..100.0_f64, any::<bool>(), 1e-8..10.0_f64), 1..100),
        ) {
            let mut slide = TranslationCovariance::from_variances(1e-5, 0.5, 1e-4);
            let mut turn = RotationCovariance::from_variances(0.01, 1.0);
            for (dt_s, noise_input, high, variance) in steps {
                let end = if high { FaceSide::Positive } else { FaceSide::Negative };
                slide = slide.predicted(dt_s, noise_input, 1e-5).bounded(5.0).updated_by_face(end, variance).0.bounded(5.0);
                turn = turn.predicted(dt_s, noise_input, 0.3).bounded(3.2, 20.0).updated(variance).0.bounded(3.2, 20.0);
                prop_assert!(is_covariance(&slide.0), "{}", slide.0);
                prop_assert!(slide.0[(1, 1)] <= 25.0001 && slide.centre_variance_m2() > 0.0);
                prop_assert!(turn.rotation_variance_rad2() > 0.0 && turn.rotation_variance_rad2() <= variance.max(3.2 * 3.2));
                prop_assert!(turn.0.determinant() > -1e-9);
            }
        }
    }
}
