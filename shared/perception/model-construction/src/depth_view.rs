//! Depth image of one object: the segmented points of a view, in the pixels of its camera.

use crate::Error;
use crate::depth_window::{BORDER_DISTANCE_MAX_PX, DepthWindow, PlacedPoint};
use geometry::PinholeCamera;
use nalgebra::{Point3, Vector3};
use point_cloud::Point;
use registration::{ViewOrigin, ViewSurface};
use sensor_noise::DepthNoise;

/// Weight of a pixel at the border of the object or of a depth step. Chosen: its depth is mixed
/// with that of what is behind.
const BORDER_WEIGHT: f32 = 0.15;

/// Weight of the colour of a pixel near a border. Chosen: the images of a Kinect are registered
/// to about two pixels, so that it is often that of what is behind.
const BORDER_COLOR_WEIGHT: f32 = 0.01;

/// Depth at which a pixel that faces the camera weighs 1, metres. Chosen.
const WEIGHT_DEPTH_M: f32 = 0.8;

/// Segmented points of an object in one frame, as an image.
#[derive(Debug)]
pub(crate) struct DepthView {
    pub(crate) camera: PinholeCamera,
    window: DepthWindow,
    /// Pixel of each point; `None` without a normal.
    pixels: Vec<Option<DepthPixel>>,
    pub(crate) surface: ViewSurface,
}

/// Measured surface in one pixel.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DepthPixel {
    /// Place in the frame of the camera, metres.
    pub(crate) place: Point3<f32>,
    /// Unit normal towards the camera.
    pub(crate) normal: Vector3<f32>,
    /// Certainty: the cosine of the angle of incidence over the squared depth, little at borders.
    pub(crate) weight: f32,
    /// Colour, 0 to 255 a channel.
    pub(crate) color: [f32; 3],
    /// Certainty of the colour.
    pub(crate) color_weight: f32,
}

impl DepthView {
    /// Image of points in the frame of their camera. Points outside of the image or without depth
    /// are left out; of two in one pixel the nearer one counts.
    pub(crate) fn new(
        points: &[Point],
        camera: PinholeCamera,
        depth_noise: DepthNoise,
    ) -> Result<Self, Error> {
        let pixel = |point: &Point| camera.pixel_of(&point.position());
        let placed: Vec<PlacedPoint<'_>> = points
            .iter()
            .filter(|point| point.is_finite())
            .filter_map(|point| Some((pixel(point)?.map(|place| place as i32), point)))
            .collect();
        let window = DepthWindow::new(&placed).ok_or(Error::NoPoints {
            n_points: points.len(),
        })?;
        let distances = window.border_distances_px(&placed);
        let places: Vec<[f32; 3]> = placed.iter().map(|(_, p)| [p.x, p.y, p.z]).collect();
        let color = |((_, point), &distance): (&PlacedPoint<'_>, &u8)| {
            (distance >= BORDER_DISTANCE_MAX_PX).then(|| point.color.rgb())
        };
        let colors: Vec<Option<[u8; 3]>> = placed.iter().zip(&distances).map(color).collect();
        let origin = Some(ViewOrigin::Camera(Point3::origin()));
        let surface = ViewSurface::with_colors(&places, &colors, origin).map_err(Error::Surface)?;
        let surface = surface.with_depth_noise(depth_noise);
        let pixels = placed.iter().zip(&distances).enumerate();
        let pixels = pixels.map(|(index, ((_, point), &distance))| {
            let normal = surface.normal_at(index)?;
            Some(DepthPixel::new(point, &normal.cast(), distance))
        });
        Ok(Self {
            camera,
            window,
            pixels: pixels.collect(),
            surface,
        })
    }

    /// Measured pixels.
    pub(crate) fn pixels(&self) -> impl Iterator<Item = &DepthPixel> {
        self.pixels.iter().flatten()
    }

    /// Pixel at a column and row of the image.
    #[inline]
    pub(crate) fn pixel(&self, column: i32, row: i32) -> Option<&DepthPixel> {
        self.pixels[self.window.point_at(column, row)?].as_ref()
    }
}

impl DepthPixel {
    /// Pixel of a point, whose surface has a normal of either sign, at a distance from a border.
    fn new(point: &Point, normal: &Vector3<f32>, border_distance_px: u8) -> Self {
        let place = Point3::new(point.x, point.y, point.z);
        let cosine = -normal.dot(&place.coords.normalize());
        let facing = cosine.abs() * (WEIGHT_DEPTH_M / place.z).powi(2);
        let is_border = border_distance_px == 0;
        let is_sure = border_distance_px >= BORDER_DISTANCE_MAX_PX;
        Self {
            place,
            normal: normal * cosine.signum(),
            weight: facing * if is_border { BORDER_WEIGHT } else { 1.0 },
            color: point.color.rgb().map(f32::from),
            color_weight: facing * if is_sure { 1.0 } else { BORDER_COLOR_WEIGHT },
        }
    }
}
