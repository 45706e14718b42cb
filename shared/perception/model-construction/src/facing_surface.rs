//! Surface of the model that a camera should see: the target of a registration.

use crate::Error;
use crate::surface_points::SurfacePoint;
use nalgebra::Point3;
use registration::{ViewOrigin, ViewSurface};

/// Weight of a colour of the model that takes part in a registration. Chosen: a view from 1.2 m
/// that is not at a border.
const COLOR_WEIGHT_MIN: f32 = 0.1;

/// Cosine of the greatest angle at which the model's surface takes part in a registration, 80°.
const FACING_COSINE_MIN: f32 = 0.17;

/// Surface of those points of a model that face a camera at a place in the frame of the object.
pub(crate) fn facing_surface(
    points: &[SurfacePoint],
    camera: &Point3<f64>,
) -> Result<ViewSurface, Error> {
    let towards = camera.cast::<f32>();
    let is_facing = |point: &SurfacePoint| {
        let ray = (towards - point.place).normalize();
        point.normal.dot(&ray) > FACING_COSINE_MIN
    };
    let facing: Vec<&SurfacePoint> = points.iter().filter(|p| is_facing(p)).collect();
    let places: Vec<[f32; 3]> = facing.iter().map(|p| p.place.coords.into()).collect();
    let color = |p: &&SurfacePoint| (p.color_weight >= COLOR_WEIGHT_MIN).then_some(p.color);
    let colors: Vec<Option<[u8; 3]>> = facing.iter().map(color).collect();
    let origin = Some(ViewOrigin::Camera(*camera));
    ViewSurface::with_colors(&places, &colors, origin).map_err(Error::Surface)
}
