//! Range image of a view: which places its camera would have seen.

use crate::ViewOrigin;
use nalgebra::{Point3, UnitVector3, Vector3};

/// Side of the cells at the centroid of the view, metres. Chosen: larger than the distance of
/// neighbouring points, so that a seen surface has no holes.
const CELL_M: f64 = 0.004;

/// Maximum number of cells along a side: 2 m. What is beyond is not seen.
const N_CELLS_MAX: usize = 512;

/// Nearest surface in each direction from a viewpoint: orthographic for a direction, central for
/// a camera.
#[derive(Debug)]
pub(crate) struct RangeImage {
    viewpoint: ViewOrigin,
    /// Axes of the image; the third one points to the viewer.
    axes: [Vector3<f64>; 3],
    /// Distance of the centroid from a camera, metres.
    distance_m: f64,
    first: [f64; 2],
    n_cells: [usize; 2],
    /// Heights towards the viewer, metres; negative infinity where nothing was seen.
    heights: Vec<f32>,
}

/// Place in the image, metres at the centroid, and height towards the viewer.
type ImagePlace = ([f64; 2], f64);

/// Unit vector across a direction.
pub(crate) fn vector_across(direction: &UnitVector3<f64>) -> Vector3<f64> {
    let aside = if direction.x.abs() < 0.6 {
        Vector3::x()
    } else {
        Vector3::y()
    };
    direction.cross(&aside).normalize()
}

impl RangeImage {
    /// Range image of the points of a view.
    pub(crate) fn new(points: &[[f32; 3]], centroid: &Point3<f64>, viewpoint: ViewOrigin) -> Self {
        let (towards, distance_m) = match viewpoint {
            ViewOrigin::Direction(direction) => (direction, 1.0),
            ViewOrigin::Camera(camera) => {
                let (towards, distance_m) = UnitVector3::new_and_get(camera - centroid);
                let is_apart = distance_m > f64::EPSILON;
                (
                    if is_apart { towards } else { Vector3::z_axis() },
                    distance_m.max(f64::EPSILON),
                )
            }
        };
        let across = vector_across(&towards);
        let mut image = Self {
            viewpoint,
            axes: [across, towards.cross(&across), towards.into_inner()],
            distance_m,
            first: [f64::INFINITY; 2],
            n_cells: [0; 2],
            heights: Vec::new(),
        };
        image.draw(points);
        image
    }

    /// Distance of the centroid of the view from its camera, metres; `None` for a direction.
    pub(crate) fn camera_distance_m(&self) -> Option<f64> {
        matches!(self.viewpoint, ViewOrigin::Camera(_)).then_some(self.distance_m)
    }

    fn draw(&mut self, points: &[[f32; 3]]) {
        let place = |point: &[f32; 3]| self.project(&Point3::from(*point).cast());
        let places: Vec<ImagePlace> = points.iter().filter_map(place).collect();
        let mut last = [f64::NEG_INFINITY; 2];
        for ([x, y], _) in &places {
            self.first = [self.first[0].min(*x), self.first[1].min(*y)];
            last = [last[0].max(*x), last[1].max(*y)];
        }
        self.n_cells = std::array::from_fn(|axis| {
            let n = ((last[axis] - self.first[axis]) / CELL_M).max(0.0) as usize + 1;
            n.min(N_CELLS_MAX)
        });
        self.heights = vec![f32::NEG_INFINITY; self.n_cells[0] * self.n_cells[1]];
        for (place, height) in places {
            let [x, y] = self.cell(place);
            if let Some(index) = self.index(x, y) {
                self.heights[index] = self.heights[index].max(height as f32);
            }
        }
    }

    /// Height of the seen surface above a point, towards the viewer: positive behind the surface,
    /// negative in front of it. The nearest of the nine cells around it counts; `None` where
    /// nothing was seen.
    pub(crate) fn height_above(&self, point: &Point3<f64>) -> Option<f64> {
        let (place, height) = self.project(point)?;
        // Without any point the cells begin at infinity.
        let [x, y] = self.first[0].is_finite().then(|| self.cell(place))?;
        let mut nearest: Option<f64> = None;
        for offset in 0..9 {
            let Some(index) = self.index(x + offset % 3 - 1, y + offset / 3 - 1) else {
                continue;
            };
            let above = f64::from(self.heights[index]) - height;
            if above.is_finite() && nearest.is_none_or(|nearest| above.abs() < nearest.abs()) {
                nearest = Some(above);
            }
        }
        nearest
    }

    /// Projection of a point; `None` behind the camera.
    fn project(&self, point: &Point3<f64>) -> Option<ImagePlace> {
        match self.viewpoint {
            ViewOrigin::Direction(_) => {
                let [x, y, height] = self.axes.map(|axis| axis.dot(&point.coords));
                Some(([x, y], height))
            }
            ViewOrigin::Camera(camera) => {
                let [x, y, height] = self.axes.map(|axis| axis.dot(&(point - camera)));
                let scale = self.distance_m / -height;
                (height < -1e-3).then_some(([x * scale, y * scale], height))
            }
        }
    }

    fn cell(&self, place: [f64; 2]) -> [i64; 2] {
        std::array::from_fn(|axis| ((place[axis] - self.first[axis]) / CELL_M).floor() as i64)
    }

    fn index(&self, x: i64, y: i64) -> Option<usize> {
        let [width, height] = self.n_cells;
        let (x, y) = (usize::try_from(x).ok()?, usize::try_from(y).ok()?);
        (x < width && y < height).then_some(y * width + x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Square sheet of 10 cm at a height.
    fn sheet(z: f32) -> Vec<[f32; 3]> {
        let place = |i: u16| [f32::from(i % 50) * 0.002, f32::from(i / 50) * 0.002, z];
        (0..2500).map(place).collect()
    }

    #[test]
    fn points_are_in_front_of_a_surface_behind_it_or_beside_it() {
        let middle = Point3::new(0.05, 0.05, 0.2);
        for viewpoint in [
            ViewOrigin::Direction(Vector3::z_axis()),
            ViewOrigin::Camera(Point3::new(0.05, 0.05, 1.2)),
        ] {
            let image = RangeImage::new(&sheet(0.2), &middle, viewpoint);
            let above = |x: f64, z: f64| image.height_above(&Point3::new(x, 0.05, z));
            assert!((above(0.05, 0.15).unwrap() - 0.05).abs() < 1e-4);
            assert!((above(0.05, 0.22).unwrap() + 0.02).abs() < 1e-4);
            assert_eq!(above(0.2, 0.2), None);
        }
    }

    #[test]
    fn a_camera_sees_less_behind_a_near_surface() {
        let camera = ViewOrigin::Camera(Point3::new(0.05, 0.05, 0.4));
        let image = RangeImage::new(&sheet(0.2), &Point3::new(0.05, 0.05, 0.2), camera);
        // The shadow of the sheet grows with the distance; nothing is seen behind the camera.
        let hidden = Point3::new(0.12, 0.05, 0.0);
        assert!(image.height_above(&hidden).is_some_and(|above| above > 0.1));
        assert_eq!(image.height_above(&Point3::new(0.05, 0.05, 0.5)), None);
    }
}
