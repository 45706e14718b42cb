//! Observed space of a depth image: free, surface, hidden or unmeasured.

use geometry::{PinholeCamera, RigidTransform};
use nalgebra::{Point3, Vector3};
use point_cloud::Point;

/// Distance from a measured surface within which a place belongs to it, metres: three standard
/// deviations of a Kinect at a metre, and a pixel of a slanted surface. Chosen.
const SURFACE_M: f64 = 0.010;

/// State of a place by a depth image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpaceState {
    /// In front of what the camera measured.
    Free,
    /// On the surface that the pixel of this index shows.
    Surface(usize),
    /// Behind the surface that the pixel of this index shows.
    Hidden(usize),
    /// Outside of the image, or in a pixel without depth.
    Unmeasured,
}

/// Depth image with its camera in the frame of planning, which has z against gravity.
#[derive(Debug, Clone, Copy)]
pub struct ObservedSpace<'a> {
    camera: PinholeCamera,
    plan_from_camera: RigidTransform,
    camera_from_plan: RigidTransform,
    points: &'a [Point],
}

impl<'a> ObservedSpace<'a> {
    /// Space of an image; `points` are row-major in the frame of the camera, one for each pixel,
    /// metres, and not finite where there is no depth.
    pub fn new(
        camera: PinholeCamera,
        plan_from_camera: RigidTransform,
        points: &'a [Point],
    ) -> Self {
        Self {
            camera,
            camera_from_plan: plan_from_camera.inverse(),
            plan_from_camera,
            points,
        }
    }

    /// Width and height of the image, pixels.
    pub(crate) fn size_px(&self) -> [usize; 2] {
        [self.camera.width as usize, self.camera.height as usize]
    }

    /// Focal length, pixels: the mean of rows and columns.
    pub(crate) fn focal_px(&self) -> f64 {
        0.5 * (self.camera.fx_px + self.camera.fy_px)
    }

    /// Index of the pixel that shows a place in the frame of the camera.
    pub(crate) fn pixel_of(&self, in_camera: &Point3<f64>) -> Option<usize> {
        let [column, row] = self.camera.pixel_of(in_camera)?;
        Some(row * self.camera.width as usize + column)
    }

    /// True if the image shows a place, or what is in front of it.
    pub fn is_in_image(&self, in_plan: &Point3<f64>) -> bool {
        self.pixel_of(&(self.camera_from_plan * in_plan)).is_some()
    }

    /// Measured place of a pixel in the frame of the camera; `None` without depth.
    pub(crate) fn in_camera(&self, pixel: usize) -> Option<Point3<f64>> {
        let point = self.points.get(pixel)?;
        point.is_finite().then(|| point.position())
    }

    /// Measured place of a pixel in the frame of planning; `None` without depth.
    pub(crate) fn in_plan(&self, pixel: usize) -> Option<Point3<f64>> {
        Some(self.plan_from_camera * self.in_camera(pixel)?)
    }

    /// Direction of the frame of the camera in the frame of planning.
    pub(crate) fn direction_in_plan(&self, in_camera: &Vector3<f64>) -> Vector3<f64> {
        self.plan_from_camera.rotation * in_camera
    }

    /// Place of the camera in the frame of planning.
    pub(crate) fn eye(&self) -> Point3<f64> {
        self.plan_from_camera.translation.vector.into()
    }

    /// Number of pixels.
    pub(crate) fn n_pixels(&self) -> usize {
        self.points.len()
    }

    /// State of a place in the frame of planning.
    pub fn state(&self, in_plan: &Point3<f64>) -> SpaceState {
        let place = self.camera_from_plan * in_plan;
        let Some(pixel) = self.pixel_of(&place) else {
            return SpaceState::Unmeasured;
        };
        let Some(measured) = self.points.get(pixel).filter(|point| point.is_finite()) else {
            return SpaceState::Unmeasured;
        };
        let behind_m = place.z - f64::from(measured.z);
        if behind_m < -SURFACE_M {
            SpaceState::Free
        } else if behind_m <= SURFACE_M {
            SpaceState::Surface(pixel)
        } else {
            SpaceState::Hidden(pixel)
        }
    }
}
