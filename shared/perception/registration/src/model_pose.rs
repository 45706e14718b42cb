//! 6-D pose of a model in a measured segment: view templates, alignment and verification.
//!
//! 1. The part of the model that is seen from each of 100 directions is brought onto the segment in
//!    24 turns about the line of sight.
//! 2. The starts that contradict the camera least are aligned by generalised ICP, and the best of
//!    these again with all surfels.
//! 3. The pose is taken that contradicts least: the segment must lie on the model, and of the model
//!    nothing may stand where the camera saw through it (as hypothesis verification in Hinterstoisser
//!    et al., "Model Based Training, Detection and Pose Estimation of Texture-Less 3D Objects in
//!    Heavily Cluttered Scenes", 2012).

mod identification;
mod pose_score;
mod pose_search;
mod view_template;

pub use identification::{ModelCandidate, identify};
pub use pose_search::estimate_pose;

use crate::Error;
use crate::nearest_surfel_grid::NearestSurfelGrid;
use crate::range_image::RangeImage;
use crate::view_surface::{ViewOrigin, ViewSurface, check_points};
use nalgebra::{Isometry3, Point3, Vector3};
use pose_search::START_TOLERANCE_M;
use sensor_noise::DepthNoise;
use view_template::ViewTemplate;

/// Contradiction up to which a pose is good. Fitted to the regret of views that are chosen by the
/// models in 40 views of two bins: 0.25 bit with 0.15, 0.19 with 0.3 and 0.20 with 0.6, where the
/// rank correlation is greatest.
const GOOD_CONTRADICTION_MAX: f64 = 0.45;

/// Model of which poses can be estimated: surface points, and what is seen of them from around.
#[derive(Debug)]
pub struct PoseModel {
    surface: ViewSurface,
    nearest: NearestSurfelGrid,
    templates: Vec<ViewTemplate>,
    diameter_m: f64,
}

impl PoseModel {
    /// Model of evenly spread points on the surface of an object, with their spacing, metres.
    ///
    /// *Cost*: some hundred milliseconds.
    ///
    /// # Errors
    /// As [`ViewSurface::new`]; points that are too far apart make no surface.
    pub fn new(points: &[[f32; 3]], spacing_m: f64) -> Result<Self, Error> {
        // No direction is that of the model's camera: its range image is not used.
        let direction = ViewOrigin::Direction(Vector3::z_axis());
        let surface = ViewSurface::new(points, Some(direction))?;
        let places: Vec<Point3<f64>> = points.iter().map(|p| Point3::from(*p).cast()).collect();
        Ok(Self {
            templates: ViewTemplate::all_around(&places, spacing_m),
            diameter_m: diameter_m(&places),
            nearest: NearestSurfelGrid::new(&surface, *START_TOLERANCE_M.end()),
            surface,
        })
    }

    /// Diameter of the model: the greatest distance of two of its points, within some percent,
    /// metres.
    pub fn diameter_m(&self) -> f64 {
        self.diameter_m
    }
}

/// Segment of a camera's view, and all that the camera saw around it.
#[derive(Debug)]
pub struct SegmentView {
    surface: ViewSurface,
    scene: RangeImage,
}

impl SegmentView {
    /// Segment of an object, and the scene with it: finite points in the frame of the camera,
    /// metres, with the noise of its depth.
    ///
    /// # Errors
    /// As [`ViewSurface::new`]; the scene may have any number of points.
    pub fn new(
        segment: &[[f32; 3]],
        scene: &[[f32; 3]],
        depth_noise: DepthNoise,
    ) -> Result<Self, Error> {
        let camera = ViewOrigin::Camera(Point3::origin());
        let surface = ViewSurface::new(segment, Some(camera))?.with_depth_noise(depth_noise);
        check_points(scene)?;
        let scene = RangeImage::new(scene, &surface.centroid(), camera);
        Ok(Self { surface, scene })
    }
}

/// Estimated pose of a model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModelPose {
    /// Pose of the model in the frame of the camera.
    pub camera_from_model: Isometry3<f64>,
    /// Contradiction of the pose, 0 to 2: how much of the segment is not at the model, and how much
    /// of what the camera should have seen of the model is not there.
    pub contradiction: f64,
}

impl ModelPose {
    /// `true` if the model is probably there.
    pub fn is_good(&self) -> bool {
        self.contradiction <= GOOD_CONTRADICTION_MAX
    }
}

/// Greatest distance of two points, by the extents along directions all around: at most 2 % too
/// small.
fn diameter_m(places: &[Point3<f64>]) -> f64 {
    let mut greatest_m = 0.0_f64;
    for direction in view_template::directions() {
        let heights = places.iter().map(|place| direction.dot(&place.coords));
        let (least, most) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), height| {
            (a.min(height), b.max(height))
        });
        greatest_m = greatest_m.max(most - least);
    }
    greatest_m
}

#[cfg(test)]
mod tests;
