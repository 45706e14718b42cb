//! Colours of surfels: values and gradients along the surface (Park, Zhou and Koltun, "Colored
//! point cloud registration revisited", 2017).

use nalgebra::{Matrix3, Matrix3x6, Vector3};

/// Standard deviation of the colour of a surfel, levels of 255. Chosen: the noise of a camera.
const COLOR_SIGMA: f64 = 8.0;

/// Weight of the brightness against the two other channels. Chosen: highlights, which move with
/// the camera, change it most.
const BRIGHTNESS_WEIGHT: f64 = 0.2;

/// Difference of colours beyond which a correspondence loses weight, in standard deviations.
const OUTLIER_SIGMAS: f64 = 3.0;

/// Variance of places along the surface below which there is no gradient, metres².
const VARIANCE_MIN_M2: f64 = 1e-7;

/// Sums over the coloured points of a voxel.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct ColorMoments {
    pub(crate) n: f64,
    sum: Vector3<f64>,
    /// Products of colours and places: a row for each channel.
    products: Matrix3<f64>,
}

/// Colour of a surfel in opponent channels, levels of 255.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SurfelColor {
    value: Vector3<f64>,
    /// Change along the surface, levels a metre: a row for each channel.
    gradient: Matrix3<f64>,
}

/// Brightness, red against green, and yellow against blue; orthonormal but for the weight of the
/// brightness.
fn opponent(color: [u8; 3]) -> Vector3<f64> {
    let [red, green, blue] = color.map(f64::from);
    Vector3::new(
        BRIGHTNESS_WEIGHT * (red + green + blue) / 3_f64.sqrt(),
        (red - green) / 2_f64.sqrt(),
        (red + green - 2.0 * blue) / 6_f64.sqrt(),
    )
}

impl ColorMoments {
    /// Moments of one point, which may have no colour.
    pub(crate) fn of(color: Option<[u8; 3]>, place: &Vector3<f64>) -> Self {
        color.map_or_else(Self::default, |color| {
            let color = opponent(color);
            Self {
                n: 1.0,
                sum: color,
                products: color * place.transpose(),
            }
        })
    }

    pub(crate) fn add(&mut self, other: &Self) {
        self.n += other.n;
        self.sum += other.sum;
        self.products += other.products;
    }

    pub(crate) fn mean(&self) -> Vector3<f64> {
        self.sum / self.n.max(1.0)
    }

    /// Covariance of colours and places whose mean is given.
    pub(crate) fn covariance(&self, mean_place: &Vector3<f64>) -> Matrix3<f64> {
        self.products / self.n.max(1.0) - self.mean() * mean_place.transpose()
    }
}

impl SurfelColor {
    /// Colour of a value, with the gradient of a linear fit: from the covariance of colours and
    /// places, and that of the places.
    pub(crate) fn new(
        value: Vector3<f64>,
        covariance: &Matrix3<f64>,
        of_places: &Matrix3<f64>,
        normal: &Vector3<f64>,
    ) -> Self {
        // Along the normal the places hardly vary, and the gradient is zero.
        let widened = of_places
            + Matrix3::identity() * VARIANCE_MIN_M2
            + normal * normal.transpose() * (1e3 * of_places.trace() + VARIANCE_MIN_M2);
        let inverse = widened.try_inverse().unwrap_or_else(Matrix3::zeros);
        Self {
            value,
            gradient: covariance * inverse,
        }
    }

    /// Difference of the colour of a source surfel from that of this surface at a place, whose
    /// offset from this surfel is given.
    pub(crate) fn difference(&self, source: &Self, offset: &Vector3<f64>) -> Vector3<f64> {
        source.value - self.value - self.gradient * offset
    }

    /// Difference to the colour of a source surfel at an offset as a share of the one from which
    /// colours count as different, 0 to 1.
    pub(crate) fn disagreement(&self, source: &Self, offset: &Vector3<f64>) -> f64 {
        let difference = self.difference(source, offset).norm();
        (difference / (OUTLIER_SIGMAS * COLOR_SIGMA)).min(1.0)
    }

    /// Weighted Jacobian of the difference by the motion of the place, and the weighted
    /// difference, both in units of a distance with a standard deviation.
    pub(crate) fn equations(
        &self,
        difference: &Vector3<f64>,
        motion: &Matrix3x6<f64>,
        residual_sigma_m: f64,
    ) -> (Matrix3x6<f64>, Vector3<f64>) {
        let scaled = difference.norm() / (OUTLIER_SIGMAS * COLOR_SIGMA);
        // Square root of the weight of Cauchy.
        let weight = residual_sigma_m / COLOR_SIGMA / (1.0 + scaled * scaled).sqrt();
        (weight * self.gradient * motion, weight * difference)
    }
}
