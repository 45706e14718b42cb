//! Shadow map of the main light (Williams 1978).
//!
//! It contains the faces that look away from the light, so that lit faces need only a small bias,
//! and is filtered by percentage-closer filtering (Reeves, Salesin and Cook 1987) over four by
//! four cells.

use crate::lanes::{Lanes, N_LANES, VectorLanes};
use crate::lights::{LightPlacement, Lights, ShadowRegion};
use crate::projection::{Projection, RigidTransformF32, ScreenCorner};
use crate::scanline::ScanlineSpan;
use crate::shadow_bounds::ShadowBounds;
use crate::shadow_grid::MAP_SIDE;
use geometry::RigidTransform;
use nalgebra::{Point3, Rotation3, Translation3, UnitQuaternion, Vector3};

/// Shadow bias: relative reverse-Z difference by which an occluder must be nearer to the light.
/// Chosen.
const DEPTH_BIAS: f32 = 5e-4;

/// View of the main light: pose and projection.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LightView {
    pub(crate) map_from_world: RigidTransform,
    pub(crate) projection: Projection,
}

impl LightView {
    /// View of the lights' main light; `None` when they cast no shadow or are not valid.
    pub(crate) fn new(lights: &Lights) -> Option<Self> {
        let region = lights.shadow?;
        let center = region.center_in_world.cast::<f64>();
        let radius_m = f64::from(region.radius_m);
        let (eye, towards) = match lights.main.placement {
            LightPlacement::Directional(to_light) => (center, -to_light.cast::<f64>()),
            LightPlacement::Point(lamp) => (lamp.cast(), center - lamp.cast::<f64>()),
        };
        let usable = 1e-6..1e6;
        if !usable.contains(&radius_m)
            || !usable.contains(&towards.norm())
            || !eye.iter().all(|c| c.abs() < 1e6)
        {
            return None;
        }
        Some(Self {
            map_from_world: look_at(&eye, &towards),
            projection: projection(&lights.main.placement, &region, towards.norm()),
        })
    }
}

/// Look-at transform: the frame at `eye` whose z points along `towards`.
fn look_at(eye: &Point3<f64>, towards: &Vector3<f64>) -> RigidTransform {
    let side = if towards.x.abs() < 0.5 * towards.norm() {
        Vector3::x()
    } else {
        Vector3::y()
    };
    let world_from_map = Rotation3::face_towards(towards, &side);
    RigidTransform::from_parts(
        Translation3::from(eye.coords),
        UnitQuaternion::from_rotation_matrix(&world_from_map),
    )
    .inverse()
}

fn projection(placement: &LightPlacement, region: &ShadowRegion, distance_m: f64) -> Projection {
    let center_px = MAP_SIDE as f32 / 2.0;
    match placement {
        LightPlacement::Directional(_) => Projection::Orthographic {
            px_per_m: center_px / region.radius_m,
            center_px,
            reverse_z_per_m: 1.0 / (16.0 * region.radius_m),
        },
        LightPlacement::Point(_) => {
            let sine = (f64::from(region.radius_m) / distance_m).min(0.85);
            let focal = f64::from(center_px) * (1.0 - sine * sine).sqrt() / sine;
            Projection::Pinhole {
                focal: [focal as f32; 2],
                center: [center_px; 2],
            }
        }
    }
}

/// Shadow map: reverse-Z depth of the nearest face that looks away from the light.
#[derive(Debug)]
pub(crate) struct ShadowMap {
    /// Transform from the camera frame and projection into the map; `None` without shadows.
    pub(crate) view: Option<(RigidTransformF32, Projection)>,
    pub(crate) reverse_z: Vec<f32>,
    bounds: ShadowBounds,
}

/// Shadow map coordinates of a pixel block, lane by lane.
#[derive(Debug, Clone)]
pub(crate) struct ShadowCoordinates {
    pub(crate) x: Lanes,
    pub(crate) y: Lanes,
    reverse_z: Lanes,
}

impl ShadowCoordinates {
    pub(crate) fn new() -> Self {
        Self {
            x: [0.0; N_LANES],
            y: [0.0; N_LANES],
            reverse_z: [0.0; N_LANES],
        }
    }

    #[inline]
    pub(crate) fn at(&self, lane: usize) -> ScreenCorner {
        ScreenCorner {
            x: self.x[lane],
            y: self.y[lane],
            reverse_z: self.reverse_z[lane],
        }
    }
}

impl ShadowMap {
    pub(crate) fn new() -> Self {
        Self {
            view: None,
            reverse_z: vec![0.0; MAP_SIDE * MAP_SIDE],
            bounds: ShadowBounds::new(),
        }
    }

    /// Finishes drawing; must be called before [`Self::lit_share`].
    pub(crate) fn finish(&mut self) {
        if self.view.is_some() {
            self.bounds.update(&self.reverse_z);
        }
    }

    #[inline]
    pub(crate) fn draw(&mut self, span: &ScanlineSpan) {
        let first = span.row * MAP_SIDE;
        let cells = &mut self.reverse_z[first + span.start..first + span.end];
        for (i, cell) in cells.iter_mut().enumerate() {
            *cell = cell.max(span.reverse_z_at(i as i32));
        }
    }

    /// Projects points in the camera frame into the map; NaN without shadows.
    #[inline]
    pub(crate) fn project_all(&self, points: &VectorLanes, places: &mut ShadowCoordinates) {
        let Some((map_from_camera, projection)) = &self.view else {
            places.x.fill(f32::NAN);
            places.y.fill(f32::NAN);
            return;
        };
        let [px, py, pz] = points;
        for i in 0..N_LANES {
            let place = projection.project(map_from_camera.point([px[i], py[i], pz[i]]));
            places.x[i] = place.x;
            places.y[i] = place.y;
            places.reverse_z[i] = place.reverse_z;
        }
    }

    /// Share of the main light at a shadow map coordinate, times 255. Outside of the map
    /// everything is lit.
    #[inline]
    pub(crate) fn lit_share(&self, place: &ScreenCorner) -> u8 {
        let limit = (MAP_SIDE - 3) as f32;
        if !(place.x >= 1.0 && place.y >= 1.0 && place.x < limit && place.y < limit)
            || place.reverse_z <= 0.0
        {
            return u8::MAX;
        }
        let (column, row) = (place.x as usize, place.y as usize);
        let threshold = place.reverse_z * (1.0 + DEPTH_BIAS);
        let (low, high) = self.bounds.around(column, row);
        if high <= threshold {
            u8::MAX
        } else if low > threshold {
            0
        } else {
            self.percentage_closer(place, threshold)
        }
    }

    /// Percentage-closer filtering over four by four cells: cells up to `threshold` let light
    /// pass.
    #[inline(never)]
    fn percentage_closer(&self, place: &ScreenCorner, threshold: f32) -> u8 {
        let (column, row) = (place.x as usize, place.y as usize);
        let (u, v) = (place.x - column as f32, place.y - row as f32);
        let mut columns = [0.0_f32; 4];
        for (j, down) in [1.0 - v, 1.0, 1.0, v].into_iter().enumerate() {
            let first = (row + j - 1) * MAP_SIDE + column - 1;
            let cells = &self.reverse_z[first..first + 4];
            for (sum, &cell) in columns.iter_mut().zip(cells) {
                *sum += if cell <= threshold { down } else { 0.0 };
            }
        }
        let sum = columns[0] * (1.0 - u) + columns[1] + columns[2] + columns[3] * u;
        (sum * (255.0 / 9.0) + 0.5) as u8
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_region_fills_the_map_of_either_light() {
        for placement in [
            LightPlacement::Directional(Vector3::new(0.3, -0.2, 1.0)),
            LightPlacement::Point(Point3::new(0.5, 0.5, 2.5)),
        ] {
            let mut lights = Lights::ROOM;
            lights.main.placement = placement;
            let view = LightView::new(&lights).unwrap();
            let center = view.map_from_world * Point3::origin();
            let place = view.projection.project(center.cast::<f32>().coords.into());
            assert!((place.x - 192.0).abs() < 0.1 && (place.y - 192.0).abs() < 0.1);
            let rim = view.map_from_world * Point3::new(0.0, 1.2, 0.0);
            let place = view.projection.project(rim.cast::<f32>().coords.into());
            let distance = (place.x - 192.0).hypot(place.y - 192.0);
            assert!((120.0..200.0).contains(&distance), "{distance}");
        }
    }

    #[test]
    fn invalid_lights_cast_no_shadow() {
        let mut lights = Lights::ROOM;
        lights.main.placement = LightPlacement::Directional(Vector3::zeros());
        assert!(LightView::new(&lights).is_none());
        lights.main.placement = LightPlacement::Point(Point3::new(f32::NAN, 0.0, 0.0));
        assert!(LightView::new(&lights).is_none());
    }

    #[test]
    fn shadow_bounds_agree_with_filtering_all_cells() {
        let mut map = ShadowMap::new();
        map.view = Some((
            RigidTransformF32::new(&RigidTransform::identity()).unwrap(),
            Projection::Pinhole {
                focal: [1.0; 2],
                center: [0.0; 2],
            },
        ));
        for (i, cell) in map.reverse_z.iter_mut().enumerate() {
            let (column, row) = (i % MAP_SIDE, i / MAP_SIDE);
            *cell = f32::from(u8::from((column / 40 + row / 30) % 2 == 0));
        }
        map.finish();
        let mut n_of_share = [0; 256];
        for i in 0..20_000_u16 {
            let place = ScreenCorner {
                x: 1.0 + f32::from(i) * 0.618_034 % 378.0,
                y: 1.0 + f32::from(i) * 0.754_878 % 378.0,
                reverse_z: 0.5,
            };
            let share = map.lit_share(&place);
            assert_eq!(
                share,
                map.percentage_closer(&place, 0.5 * (1.0 + DEPTH_BIAS))
            );
            n_of_share[usize::from(share)] += 1;
        }
        assert!(n_of_share[0] > 1000 && n_of_share[255] > 1000);
        assert!(n_of_share[1..255].iter().sum::<u32>() > 1000);
    }
}
