//! Surface of a view: points, surfels of a voxel grid, and a range image.

use crate::Error;
use crate::kd_tree::KdTree;
use crate::range_image::RangeImage;
use crate::surfels::{Surfel, VOXEL_M, surfels_of};
use nalgebra::{Point3, UnitVector3, Vector3};
use sensor_noise::DepthNoise;
use std::sync::OnceLock;

/// Minimum number of surfels of a surface. Chosen: 3 cm² of it.
const N_SURFELS_MIN: usize = 20;

/// Number of points whose nearest neighbours give the spacing. Chosen.
const N_SPACING_SAMPLES: usize = 400;

/// Greatest coordinate of a point, metres. Chosen: voxels are counted in 32 bits.
const COORDINATE_MAX_M: f32 = 1000.0;

/// Place from which a view was taken, in the frame of its points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ViewOrigin {
    /// Optical centre of a camera, metres.
    Camera(Point3<f64>),
    /// Direction towards a camera that is far away.
    Direction(UnitVector3<f64>),
}

/// Surface of one view of an object.
#[derive(Debug)]
pub struct ViewSurface {
    points: Vec<[f32; 3]>,
    /// Index of the surfel of each point, `NO_SURFEL` without one.
    surfel_of_point: Vec<u32>,
    point_tree: OnceLock<KdTree>,
    spacing_m: OnceLock<f64>,
    surfels: Vec<Surfel>,
    surfel_tree: KdTree,
    range_image: RangeImage,
    centroid: Point3<f64>,
    noise_m: f64,
}

impl ViewSurface {
    /// Surface of the points of one view, metres; without a viewpoint its direction is estimated
    /// from the normals. Memory and time are linear in the points.
    ///
    /// # Errors
    /// When a coordinate is not finite or beyond 1 km, or the points are too few for a surface.
    pub fn new(points: &[[f32; 3]], viewpoint: Option<ViewOrigin>) -> Result<Self, Error> {
        Self::with_colors(points, &[], viewpoint)
    }

    /// Surface of the points of one view, as by [`new`](Self::new), with the sRGB colours of those
    /// points whose colour is that of the object.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn with_colors(
        points: &[[f32; 3]],
        colors: &[Option<[u8; 3]>],
        viewpoint: Option<ViewOrigin>,
    ) -> Result<Self, Error> {
        check_points(points)?;
        let (surfels, surfel_of_point) = surfels_of(points, colors);
        if surfels.len() < N_SURFELS_MIN {
            return Err(Error::TooFewSurfels {
                n_points: points.len(),
                n_surfels: surfels.len(),
            });
        }
        let sum: Vector3<f64> = surfels.iter().map(|surfel| surfel.place.coords).sum();
        let centroid = Point3::from(sum / surfels.len() as f64);
        let places: Vec<[f32; 3]> = surfels.iter().map(|s| place_of(&s.place)).collect();
        let viewpoint = viewpoint.unwrap_or_else(|| seen_from(&surfels, &centroid));
        Ok(Self {
            points: points.to_vec(),
            surfel_of_point,
            point_tree: OnceLock::new(),
            spacing_m: OnceLock::new(),
            surfel_tree: KdTree::new(&places),
            range_image: RangeImage::new(points, &centroid, viewpoint),
            noise_m: median_spread_m(&surfels),
            surfels,
            centroid,
        })
    }

    /// Surface whose noise is at least that of the depth of its camera; without a camera it stays
    /// as it is. Beyond 1.5 m the noise spreads the points of one surface over several voxels, so
    /// that the surfels alone do not tell it.
    #[must_use]
    pub fn with_depth_noise(mut self, law: DepthNoise) -> Self {
        if let Some(distance_m) = self.range_image.camera_distance_m() {
            self.noise_m = self.noise_m.max(law.bounded_sigma_m(distance_m));
        }
        self
    }

    /// `true` if a surface element has a colour.
    pub(crate) fn has_colors(&self) -> bool {
        self.surfels.iter().any(|surfel| surfel.color.is_some())
    }

    /// Number of surface elements.
    pub fn n_surfels(&self) -> usize {
        self.surfels.len()
    }

    /// Unit normal of the surface at a point of the view, of either sign; `None` where there are
    /// too few points around it.
    pub fn normal_at(&self, point_index: usize) -> Option<Vector3<f64>> {
        let surfel = *self.surfel_of_point.get(point_index)?;
        self.surfels
            .get(surfel as usize)
            .map(|surfel| surfel.normal)
    }

    pub(crate) fn points(&self) -> &[[f32; 3]] {
        &self.points
    }

    /// Search tree of the points, made when it is first needed.
    pub(crate) fn point_tree(&self) -> &KdTree {
        self.point_tree.get_or_init(|| KdTree::new(&self.points))
    }

    /// Median distance of the points to their nearest neighbours, metres.
    pub(crate) fn spacing_m(&self) -> f64 {
        *self.spacing_m.get_or_init(|| {
            let step = self.points.len().div_ceil(N_SPACING_SAMPLES).max(1);
            let mut distances: Vec<f32> = self
                .points
                .iter()
                .step_by(step)
                .filter_map(|point| self.point_tree().nearest_elsewhere(*point))
                .collect();
            distances.sort_unstable_by(f32::total_cmp);
            let median = distances.get(distances.len() / 2);
            median.map_or(VOXEL_M, |squared| f64::from(squared.sqrt()))
        })
    }

    pub(crate) fn surfels(&self) -> &[Surfel] {
        &self.surfels
    }

    /// Nearest surfel within a distance, with the squared distance.
    pub(crate) fn nearest_surfel(
        &self,
        place: &Point3<f64>,
        reach_m: f64,
    ) -> Option<(&Surfel, f64)> {
        let squared_reach = (reach_m * reach_m) as f32;
        let (index, squared) = self.surfel_tree.nearest(place_of(place), squared_reach)?;
        Some((&self.surfels[index], f64::from(squared)))
    }

    /// Index of the nearest surfel within a distance.
    pub(crate) fn nearest_index(&self, place: &Point3<f64>, reach_m: f64) -> Option<usize> {
        let squared_reach = (reach_m * reach_m) as f32;
        let nearest = self.surfel_tree.nearest(place_of(place), squared_reach);
        nearest.map(|(index, _)| index)
    }

    pub(crate) fn range_image(&self) -> &RangeImage {
        &self.range_image
    }

    /// Noise of the points across the surface, metres: the median over the surfels, or that of the
    /// camera's depth if it is more.
    pub fn noise_m(&self) -> f64 {
        self.noise_m
    }

    /// Mean of the surfels.
    pub fn centroid(&self) -> Point3<f64> {
        self.centroid
    }
}

/// Checks that all coordinates are finite and at most 1 km.
pub(crate) fn check_points(points: &[[f32; 3]]) -> Result<(), Error> {
    for (index, point) in points.iter().enumerate() {
        if point.iter().any(|c| !c.is_finite()) {
            return Err(Error::NotFinite(index));
        }
        if point.iter().any(|c| c.abs() > COORDINATE_MAX_M) {
            return Err(Error::TooFar(index));
        }
    }
    Ok(())
}

/// Place in single precision, for the search trees.
pub(crate) fn place_of(point: &Point3<f64>) -> [f32; 3] {
    point.coords.map(|value| value as f32).into()
}

fn median_spread_m(surfels: &[Surfel]) -> f64 {
    let mut spreads: Vec<f64> = surfels.iter().map(|surfel| surfel.spread_m).collect();
    spreads.sort_unstable_by(f64::total_cmp);
    spreads.get(spreads.len() / 2).copied().unwrap_or(0.0)
}

/// Direction from which most of the outward normals are seen.
fn seen_from(surfels: &[Surfel], centroid: &Point3<f64>) -> ViewOrigin {
    let outward = |surfel: &Surfel| {
        let side = surfel.normal.dot(&(surfel.place - centroid)).signum();
        surfel.flatness * side * surfel.normal
    };
    let sum: Vector3<f64> = surfels.iter().map(outward).sum();
    let direction = UnitVector3::try_new(sum, f64::EPSILON).unwrap_or_else(Vector3::z_axis);
    ViewOrigin::Direction(direction)
}
