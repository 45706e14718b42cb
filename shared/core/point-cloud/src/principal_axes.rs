//! Mean, covariance and principal axes (PCA) of points.

use nalgebra::{Matrix3, Point3, SymmetricEigen, Vector3};

/// Accumulator of first and second moments of points, for mean and covariance.
///
/// Sums are taken relative to the first point, which keeps the covariance
/// exact far from the origin.
#[derive(Debug, Clone, Copy, Default)]
pub struct Moments {
    n: usize,
    origin: Vector3<f64>,
    sum: Vector3<f64>,
    products: Matrix3<f64>,
}

/// Principal axes (PCA) of a set of points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PrincipalAxes {
    /// Centroid: mean of the points.
    pub centroid: Point3<f64>,
    /// Variances along the axes, largest first, square metres.
    pub variances_m2: Vector3<f64>,
    /// Unit axes as columns, in the order of the variances, right-handed. Their signs are
    /// arbitrary, as given by the eigenvalue solver.
    pub axes: Matrix3<f64>,
}

impl Moments {
    /// Adds a finite point to the moments.
    #[inline]
    pub fn add(&mut self, point: &Point3<f64>) {
        if self.n == 0 {
            self.origin = point.coords;
        }
        let d = point.coords - self.origin;
        self.n += 1;
        self.sum += d;
        self.products += d * d.transpose();
    }

    /// Number of points added to the moments.
    pub fn n_points(&self) -> usize {
        self.n
    }

    /// Mean of the points, metres; `None` without points.
    pub fn centroid(&self) -> Option<Point3<f64>> {
        (self.n > 0).then(|| Point3::from(self.origin + self.sum / self.n as f64))
    }

    /// Population covariance, square metres; `None` without points.
    pub fn covariance_m2(&self) -> Option<Matrix3<f64>> {
        (self.n > 0).then(|| {
            let mean = self.sum / self.n as f64;
            self.products / self.n as f64 - mean * mean.transpose()
        })
    }

    /// Principal axes; `None` for fewer than three points.
    pub fn principal_axes(&self) -> Option<PrincipalAxes> {
        if self.n < 3 {
            return None;
        }
        let eigen = SymmetricEigen::new(self.covariance_m2()?);
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        let x = eigen.eigenvectors.column(order[0]).normalize();
        let y = eigen.eigenvectors.column(order[1]).normalize();
        Some(PrincipalAxes {
            centroid: self.centroid()?,
            variances_m2: Vector3::from_fn(|i, _| eigen.eigenvalues[order[i]].max(0.0)),
            axes: Matrix3::from_columns(&[x, y, x.cross(&y)]),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;

    #[test]
    fn axes_follow_the_rotation_of_the_points() {
        let rotation = Rotation3::from_euler_angles(0.4, -1.0, 2.2);
        let shift = Vector3::new(5.0, -3.0, 900.0);
        let mut moments = Moments::default();
        for i in 0..1000 {
            let t = f64::from(i);
            let p = Vector3::new(
                0.30 * (t * 0.7).sin(),
                0.1 * (t * 1.3).sin(),
                0.02 * (t * 2.9).cos(),
            );
            moments.add(&Point3::from(rotation * p + shift));
        }
        let axes = moments.principal_axes().unwrap();
        assert!(axes.axes.column(0).dot(&rotation.matrix().column(0)).abs() > 0.999);
        assert!(axes.axes.column(2).dot(&rotation.matrix().column(2)).abs() > 0.999);
        assert!((axes.axes.determinant() - 1.0).abs() < 1e-9);
        assert!((axes.variances_m2[0].sqrt() - 0.30 / 2f64.sqrt()).abs() < 5e-3);
    }

    #[test]
    fn two_points_have_no_axes() {
        let mut moments = Moments::default();
        moments.add(&Point3::new(1.0, 2.0, 3.0));
        moments.add(&Point3::new(2.0, 2.0, 3.0));
        assert_eq!(moments.principal_axes(), None);
        assert_eq!(moments.centroid(), Some(Point3::new(1.5, 2.0, 3.0)));
    }
}
