//! Surfels of a view: a mean, a normal and a colour for each voxel of a grid over its points.

use crate::color_gradient::{ColorMoments, SurfelColor};
use nalgebra::{Matrix3, Point3, Vector3};
use point_cloud::least_eigenvector;
use std::collections::HashMap;

/// Side of the voxels of the surfels, metres. Fitted: of 612 registrations of simulated views of
/// scanned objects 289 succeed with 3 mm, 294 with 4 mm and 282 with 5 mm.
pub(crate) const VOXEL_M: f64 = 0.004;

/// Minimum number of points around a surfel, for its normal. Chosen.
const N_POINTS_MIN: f64 = 6.0;

/// Index in place of that of a surfel.
const NO_SURFEL: u32 = u32::MAX;

/// Surface element: the part of a surface in a voxel.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Surfel {
    pub(crate) place: Point3<f64>,
    /// Normal, of either sign.
    pub(crate) normal: Vector3<f64>,
    /// Flatness of the surface around it, 0 to 1.
    pub(crate) flatness: f64,
    /// Standard deviation of the points around it across the surface, metres: noise and curvature.
    pub(crate) spread_m: f64,
    /// Colour, if all points around it have one.
    pub(crate) color: Option<SurfelColor>,
}

/// Sums over the points of a voxel.
#[derive(Debug, Clone, Copy, Default)]
struct Moments {
    n: f64,
    sum: Vector3<f64>,
    squares: Matrix3<f64>,
    colors: ColorMoments,
}

type Voxel = [i32; 3];

/// Points sorted into voxels.
struct Voxels {
    /// Places of the voxels in `moments` by their coordinates.
    places: HashMap<Voxel, usize>,
    /// Moments of the voxels in the order of their first points.
    moments: Vec<(Voxel, Moments)>,
    /// Place of the voxel of each point.
    of_point: Vec<usize>,
}

/// Surfels of the points: a mean for each voxel, a normal from it and its neighbours. Then the
/// index of the surfel of each point.
pub(crate) fn surfels_of(
    points: &[[f32; 3]],
    colors: &[Option<[u8; 3]>],
) -> (Vec<Surfel>, Vec<u32>) {
    let voxels = Voxels::new(points, colors);
    let mut surfels = Vec::new();
    let mut surfel_of_voxel = vec![NO_SURFEL; voxels.moments.len()];
    for (place, (voxel, own)) in voxels.moments.iter().enumerate() {
        let around = voxels.around(voxel);
        if around.n < N_POINTS_MIN {
            continue;
        }
        let (normal, flatness, spread_m) = around.plane();
        surfel_of_voxel[place] = surfels.len() as u32;
        surfels.push(Surfel {
            place: Point3::from(own.sum / own.n),
            normal,
            flatness,
            spread_m,
            color: around.color(own, &normal),
        });
    }
    let of_point = voxels.of_point.iter().map(|&place| surfel_of_voxel[place]);
    (surfels, of_point.collect())
}

impl Voxels {
    fn new(points: &[[f32; 3]], colors: &[Option<[u8; 3]>]) -> Self {
        let mut voxels = Self {
            places: HashMap::new(),
            moments: Vec::new(),
            of_point: Vec::with_capacity(points.len()),
        };
        for (index, point) in points.iter().enumerate() {
            let point: Vector3<f64> = Vector3::from(*point).cast();
            let voxel: Voxel = point.map(|value| (value / VOXEL_M).floor() as i32).into();
            let moments = &mut voxels.moments;
            let place = *voxels.places.entry(voxel).or_insert_with(|| {
                moments.push((voxel, Moments::default()));
                moments.len() - 1
            });
            voxels.of_point.push(place);
            moments[place].1.add(&Moments {
                n: 1.0,
                sum: point,
                squares: point * point.transpose(),
                colors: ColorMoments::of(colors.get(index).copied().flatten(), &point),
            });
        }
        voxels
    }

    /// Moments of a voxel and its 26 neighbours.
    fn around(&self, voxel: &Voxel) -> Moments {
        let mut sum = Moments::default();
        for offset in 0..27 {
            let shifted: Voxel = [offset % 3 - 1, offset / 3 % 3 - 1, offset / 9 - 1];
            let neighbour = std::array::from_fn(|axis| voxel[axis] + shifted[axis]);
            if let Some(&place) = self.places.get(&neighbour) {
                sum.add(&self.moments[place].1);
            }
        }
        sum
    }
}

impl Moments {
    fn add(&mut self, other: &Self) {
        self.n += other.n;
        self.sum += other.sum;
        self.squares += other.squares;
        self.colors.add(&other.colors);
    }

    fn covariance(&self) -> Matrix3<f64> {
        let mean = self.sum / self.n;
        self.squares / self.n - mean * mean.transpose()
    }

    /// Normal of the plane through the points, how flat they are: one less the ratio of their
    /// standard deviations along the normal and across it, and the first of these, metres.
    fn plane(&self) -> (Vector3<f64>, f64, f64) {
        let ([least, second, _], normal) = least_eigenvector(&self.covariance());
        let ratio = least.max(0.0) / second.max(f64::MIN_POSITIVE);
        (normal, 1.0 - ratio.sqrt().min(1.0), least.max(0.0).sqrt())
    }

    /// Colour of a surfel with these points around it, and with its own points and their colours.
    fn color(&self, own: &Self, normal: &Vector3<f64>) -> Option<SurfelColor> {
        if self.colors.n < self.n || own.n < 1.0 {
            return None;
        }
        let mean = self.sum / self.n;
        let covariance = self.colors.covariance(&mean);
        Some(SurfelColor::new(
            own.colors.mean(),
            &covariance,
            &self.covariance(),
            normal,
        ))
    }
}
