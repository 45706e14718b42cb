//! What the main light sees.
//!
//! A shadow map (Williams 1978) of the faces that look away from the light, so
//! that lit faces need no more than a small bias, filtered by percentage closer
//! (Reeves, Salesin and Cook 1987) over four by four cells.

use crate::lights::{LightPlacement, Lights, ShadowRegion};
use crate::pixel_block::{LANES, Lanes, Vectors};
use crate::projection::{Lens, Placement, ScreenCorner};
use crate::scanline::Span;
use crate::shadow_bounds::ShadowBounds;
use geometry::RigidTransform;
use nalgebra::{Point3, Rotation3, Translation3, UnitQuaternion, Vector3};

/// Cells on each side.
pub(crate) const SIDE: usize = 384;
/// How much nearer to the light a face must be to cast a shadow, relative.
const BIAS: f32 = 5e-4;

/// Where the light looks from, and how.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LightView {
    pub(crate) map_from_world: RigidTransform,
    pub(crate) lens: Lens,
}

impl LightView {
    /// `None` when the lights cast no shadow or make no sense.
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
            map_from_world: looking(&eye, &towards),
            lens: lens(&lights.main.placement, &region, towards.norm()),
        })
    }
}

/// The frame at `eye` whose z points along `towards`.
fn looking(eye: &Point3<f64>, towards: &Vector3<f64>) -> RigidTransform {
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

fn lens(placement: &LightPlacement, region: &ShadowRegion, distance_m: f64) -> Lens {
    let center_px = SIDE as f32 / 2.0;
    match placement {
        LightPlacement::Directional(_) => Lens::Parallel {
            px_per_m: center_px / region.radius_m,
            center_px,
            closeness_per_m: 1.0 / (16.0 * region.radius_m),
        },
        LightPlacement::Point(_) => {
            let sine = (f64::from(region.radius_m) / distance_m).min(0.85);
            let focal = f64::from(center_px) * (1.0 - sine * sine).sqrt() / sine;
            Lens::Pinhole {
                focal: [focal as f32; 2],
                center: [center_px; 2],
            }
        }
    }
}

/// Closeness to the light of the nearest face that looks away from it.
#[derive(Debug)]
pub(crate) struct ShadowMap {
    /// How a point in the camera's frame gets into the map; `None` without shadows.
    pub(crate) view: Option<(Placement, Lens)>,
    pub(crate) closeness: Vec<f32>,
    bounds: ShadowBounds,
}

/// Places of a block of points in the map.
#[derive(Debug, Clone)]
pub(crate) struct Places {
    pub(crate) x: Lanes,
    pub(crate) y: Lanes,
    closeness: Lanes,
}

impl Places {
    pub(crate) fn new() -> Self {
        Self {
            x: [0.0; LANES],
            y: [0.0; LANES],
            closeness: [0.0; LANES],
        }
    }

    #[inline]
    pub(crate) fn at(&self, lane: usize) -> ScreenCorner {
        ScreenCorner {
            x: self.x[lane],
            y: self.y[lane],
            closeness: self.closeness[lane],
        }
    }
}

impl ShadowMap {
    pub(crate) fn new() -> Self {
        Self {
            view: None,
            closeness: vec![0.0; SIDE * SIDE],
            bounds: ShadowBounds::new(),
        }
    }

    /// Ends drawing; to be called before light is asked for.
    pub(crate) fn finish(&mut self) {
        if self.view.is_some() {
            self.bounds.update(&self.closeness);
        }
    }

    #[inline]
    pub(crate) fn draw(&mut self, span: &Span) {
        let first = span.row * SIDE;
        let cells = &mut self.closeness[first + span.start..first + span.end];
        for (i, cell) in cells.iter_mut().enumerate() {
            *cell = cell.max(span.closeness_at(i as i32));
        }
    }

    /// Where points in the camera's frame lie in the map; outside, without shadows.
    #[inline]
    pub(crate) fn locate_all(&self, points: &Vectors, places: &mut Places) {
        let Some((map_from_camera, lens)) = &self.view else {
            places.x.fill(f32::NAN);
            places.y.fill(f32::NAN);
            return;
        };
        let [px, py, pz] = points;
        for i in 0..LANES {
            let place = lens.project(map_from_camera.point([px[i], py[i], pz[i]]));
            places.x[i] = place.x;
            places.y[i] = place.y;
            places.closeness[i] = place.closeness;
        }
    }

    /// Share of the main light that reaches a place of the map, times 255.
    /// Outside the map everything is lit.
    #[inline]
    pub(crate) fn light_at(&self, place: &ScreenCorner) -> u8 {
        let limit = (SIDE - 3) as f32;
        if !(place.x >= 1.0 && place.y >= 1.0 && place.x < limit && place.y < limit)
            || place.closeness <= 0.0
        {
            return u8::MAX;
        }
        let (column, row) = (place.x as usize, place.y as usize);
        let threshold = place.closeness * (1.0 + BIAS);
        let (low, high) = self.bounds.around(column, row);
        if high <= threshold {
            u8::MAX
        } else if low > threshold {
            0
        } else {
            self.filtered(place, threshold)
        }
    }

    /// The same, by the cells around the place: those up to `threshold` let light pass.
    #[inline(never)]
    fn filtered(&self, place: &ScreenCorner, threshold: f32) -> u8 {
        let (column, row) = (place.x as usize, place.y as usize);
        let (u, v) = (place.x - column as f32, place.y - row as f32);
        let mut columns = [0.0_f32; 4];
        for (j, down) in [1.0 - v, 1.0, 1.0, v].into_iter().enumerate() {
            let first = (row + j - 1) * SIDE + column - 1;
            let cells = &self.closeness[first..first + 4];
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
            let place = view.lens.project(center.cast::<f32>().coords.into());
            assert!((place.x - 192.0).abs() < 0.1 && (place.y - 192.0).abs() < 0.1);
            let rim = view.map_from_world * Point3::new(0.0, 1.2, 0.0);
            let place = view.lens.project(rim.cast::<f32>().coords.into());
            let distance = (place.x - 192.0).hypot(place.y - 192.0);
            assert!((120.0..200.0).contains(&distance), "{distance}");
        }
    }

    #[test]
    fn lights_without_sense_cast_no_shadow() {
        let mut lights = Lights::ROOM;
        lights.main.placement = LightPlacement::Directional(Vector3::zeros());
        assert!(LightView::new(&lights).is_none());
        lights.main.placement = LightPlacement::Point(Point3::new(f32::NAN, 0.0, 0.0));
        assert!(LightView::new(&lights).is_none());
    }

    #[test]
    fn bounds_give_the_light_that_the_cells_give() {
        let mut map = ShadowMap::new();
        map.view = Some((
            Placement::new(&RigidTransform::identity()).unwrap(),
            Lens::Pinhole {
                focal: [1.0; 2],
                center: [0.0; 2],
            },
        ));
        for (i, cell) in map.closeness.iter_mut().enumerate() {
            let (column, row) = (i % SIDE, i / SIDE);
            *cell = f32::from(u8::from((column / 40 + row / 30) % 2 == 0));
        }
        map.finish();
        let mut n_of_share = [0; 256];
        for i in 0..20_000_u16 {
            let place = ScreenCorner {
                x: 1.0 + f32::from(i) * 0.618_034 % 378.0,
                y: 1.0 + f32::from(i) * 0.754_878 % 378.0,
                closeness: 0.5,
            };
            let share = map.light_at(&place);
            assert_eq!(share, map.filtered(&place, 0.5 * (1.0 + BIAS)));
            n_of_share[usize::from(share)] += 1;
        }
        assert!(n_of_share[0] > 1000 && n_of_share[255] > 1000);
        assert!(n_of_share[1..255].iter().sum::<u32>() > 1000);
    }
}
