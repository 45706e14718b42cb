//! What a frame shows at a place: the object, something before it, or nothing.

use crate::track_life::Place;
use geometry::{OrientedBox, PinholeCamera, RigidTransform};
use nalgebra::{Point3, Translation3, Vector3};
use point_cloud::Point;
use sensor_noise::kinect_depth_sigma_m;

/// What lies this many sigma of the depth noise, and at least this far, metres,
/// before or behind a place is not at it.
const APART_SIGMAS: f64 = 4.0;
const APART_MIN_M: f64 = 0.012;

/// Where a box is looked at, along each of its sides, as shares of the half sides.
const STEPS: [f64; 4] = [-0.8, -0.3, 0.3, 0.8];

/// Of a box on a table only this share, from the top, is looked for: its foot is
/// too near to the table behind it. Its sides are drawn in a little, too, since
/// their corners are not filled by what is round.
const TOP_SHARE: f64 = 0.6;
const SIDE_SHARE: f64 = 0.9;

/// More of the places than this outside the image: it is out of view.
const OUT_OF_VIEW_SHARE: f64 = 0.5;

/// Share of what is seen that is behind an empty place: as there is always some
/// surface of an object in its box, an object leaves less.
const FREE_SHARE: f64 = 0.92;

/// What is seen must be this share of the box before it is called empty.
const SEEN_SHARE_MIN: f64 = 0.25;

/// With this share behind something nearer the place is hidden.
const HIDDEN_SHARE: f64 = 0.3;

/// A frame into which can be looked: an organised cloud, its camera, and from
/// where it was taken.
#[derive(Debug, Clone, Copy)]
pub struct DepthView<'a> {
    cloud: &'a [Point],
    camera: PinholeCamera,
    camera_from_world: RigidTransform,
}

/// What is seen in the direction of a place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Seen {
    /// Outside the image or behind the camera.
    Outside,
    /// No depth.
    Nothing,
    /// Something before the place.
    Nearer,
    /// Something at the place.
    At,
    /// Something behind the place, so that it is empty.
    Farther,
}

/// How often each was seen.
#[derive(Debug, Clone, Copy, Default)]
struct Counts {
    outside: u32,
    nothing: u32,
    nearer: u32,
    at: u32,
    farther: u32,
}

impl Counts {
    fn add(&mut self, seen: Seen) {
        *match seen {
            Seen::Outside => &mut self.outside,
            Seen::Nothing => &mut self.nothing,
            Seen::Nearer => &mut self.nearer,
            Seen::At => &mut self.at,
            Seen::Farther => &mut self.farther,
        } += 1;
    }

    fn total(&self) -> f64 {
        f64::from(self.outside + self.nothing + self.nearer + self.at + self.farther)
    }
}

impl<'a> DepthView<'a> {
    /// A view; `None` when the cloud is no image of the camera.
    ///
    /// Frame: points in the camera's.
    pub fn new(
        cloud: &'a [Point],
        camera: PinholeCamera,
        world_from_camera: &RigidTransform,
    ) -> Option<Self> {
        (cloud.len() == camera.n_pixels()).then(|| Self {
            cloud,
            camera,
            camera_from_world: world_from_camera.inverse(),
        })
    }

    /// What the frame shows where a box is expected that is not seen as such. The
    /// box stands upright: its z axis points up.
    pub fn place_of(&self, box_in_world: &OrientedBox) -> Place {
        let counts = self.look_through(
            &top_of(box_in_world),
            |depth_m, [entry_m, exit_m], apart_m| {
                if depth_m < entry_m - apart_m {
                    Seen::Nearer
                } else if depth_m > exit_m + apart_m {
                    Seen::Farther
                } else {
                    Seen::At
                }
            },
        );
        let share = |n: u32| f64::from(n) / counts.total();
        let n_seen = counts.at + counts.farther;
        if share(counts.outside) > OUT_OF_VIEW_SHARE {
            Place::OutOfView
        } else if share(n_seen) >= SEEN_SHARE_MIN
            && f64::from(counts.farther) >= FREE_SHARE * f64::from(n_seen)
        {
            Place::Free
        } else if share(counts.nearer) >= HIDDEN_SHARE {
            Place::Hidden
        } else {
            Place::Unknown
        }
    }

    /// Share of a box in which a surface could be and not be seen, 0 to 1: something
    /// stands before the box's far side, or the box lies outside the image. What lies
    /// at the far side itself, as a table does, is no obstacle.
    pub fn obstructed_share(&self, box_in_world: &OrientedBox) -> f64 {
        let counts = self.look_through(box_in_world, |depth_m, [_, exit_m], apart_m| {
            if depth_m < exit_m - apart_m {
                Seen::Nearer
            } else {
                Seen::Farther
            }
        });
        f64::from(counts.outside + counts.nearer) / counts.total()
    }

    /// What the rays through the places of a box show. `judge` is given the seen
    /// depth, those at which the ray enters and leaves the box, and how far apart
    /// depths must be to differ.
    fn look_through(
        &self,
        box_in_world: &OrientedBox,
        judge: impl Fn(f64, [f64; 2], f64) -> Seen,
    ) -> Counts {
        let camera_from_box = self.camera_from_world * box_in_world.frame_from_box;
        let rays = BoxRays::new(&camera_from_box, &box_in_world.half_sides_m);
        let apart_m =
            (APART_SIGMAS * kinect_depth_sigma_m(camera_from_box.translation.z)).max(APART_MIN_M);
        let half = box_in_world.half_sides_m;
        let mut counts = Counts::default();
        for z in STEPS {
            for y in STEPS {
                for x in STEPS {
                    let place = camera_from_box * Point3::new(x * half.x, y * half.y, z * half.z);
                    counts.add(match self.depth_at(&place) {
                        Err(seen) => seen,
                        Ok((depth_m, ray)) => {
                            let range_m = rays.depths_m(&ray).unwrap_or([place.z; 2]);
                            judge(depth_m, range_m, apart_m)
                        }
                    });
                }
            }
        }
        counts
    }

    /// The depth seen in the direction of a place, and the ray of its pixel, or
    /// why there is none.
    fn depth_at(&self, place_in_camera: &Point3<f64>) -> Result<(f64, Vector3<f64>), Seen> {
        let Some(pixel) = self.camera.project(place_in_camera) else {
            return Err(Seen::Outside);
        };
        let (column, row) = (pixel.x.round(), pixel.y.round());
        let is_inside = (0.0..f64::from(self.camera.width)).contains(&column)
            && (0.0..f64::from(self.camera.height)).contains(&row);
        if !is_inside {
            return Err(Seen::Outside);
        }
        let index = row as usize * self.camera.width as usize + column as usize;
        let depth_m = f64::from(self.cloud[index].z);
        if depth_m.is_finite() && depth_m > 0.0 {
            Ok((depth_m, self.camera.ray(column, row)))
        } else {
            Err(Seen::Nothing)
        }
    }
}

/// The part of an upright box that is looked for.
fn top_of(whole: &OrientedBox) -> OrientedBox {
    let half = whole.half_sides_m;
    let up = Translation3::new(0.0, 0.0, (1.0 - TOP_SHARE) * half.z);
    OrientedBox {
        frame_from_box: whole.frame_from_box * up,
        half_sides_m: half.component_mul(&Vector3::new(SIDE_SHARE, SIDE_SHARE, TOP_SHARE)),
    }
}

/// A box, ready to be cut with rays from the camera.
struct BoxRays {
    box_from_camera: RigidTransform,
    half_sides_m: Vector3<f64>,
}

impl BoxRays {
    fn new(camera_from_box: &RigidTransform, half_sides_m: &Vector3<f64>) -> Self {
        Self {
            box_from_camera: camera_from_box.inverse(),
            half_sides_m: *half_sides_m,
        }
    }

    /// Depths at which a ray (z = 1) enters and leaves the box; `None` when it
    /// passes by (slab method, Kay and Kajiya 1986).
    fn depths_m(&self, ray: &Vector3<f64>) -> Option<[f64; 2]> {
        let origin = self.box_from_camera.translation.vector;
        let direction = self.box_from_camera.rotation * ray;
        let (mut entry, mut exit) = (0.0_f64, f64::INFINITY);
        for i in 0..3 {
            if direction[i].abs() < 1e-9 {
                if origin[i].abs() > self.half_sides_m[i] {
                    return None;
                }
                continue;
            }
            let a = (-self.half_sides_m[i] - origin[i]) / direction[i];
            let b = (self.half_sides_m[i] - origin[i]) / direction[i];
            (entry, exit) = (entry.max(a.min(b)), exit.min(a.max(b)));
        }
        (entry <= exit).then_some([entry, exit])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;

    /// A camera that looks straight along z at walls: the depth of each column.
    fn wall(depth_of: impl Fn(u32) -> f32) -> (Vec<Point>, PinholeCamera) {
        let camera = PinholeCamera::KINECT_V1;
        let point = |column: u32| Point {
            z: depth_of(column),
            ..Point::default()
        };
        let row: Vec<Point> = (0..camera.width).map(point).collect();
        let rows = std::iter::repeat_n(row, camera.height as usize);
        (rows.flatten().collect(), camera)
    }

    /// A box of 16 cm at a depth, upright for a camera whose y points down.
    fn box_at(x: f64, z: f64) -> OrientedBox {
        let upright =
            UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_2);
        OrientedBox {
            frame_from_box: RigidTransform::from_parts(Vector3::new(x, 0.0, z).into(), upright),
            half_sides_m: Vector3::repeat(0.08),
        }
    }

    fn place(depth_of: impl Fn(u32) -> f32, shape: &OrientedBox) -> Place {
        let (cloud, camera) = wall(depth_of);
        let view = DepthView::new(&cloud, camera, &RigidTransform::identity()).unwrap();
        view.place_of(shape)
    }

    #[test]
    fn what_is_seen_decides_what_a_place_is() {
        let shape = box_at(0.0, 1.0);
        assert_eq!(place(|_| 1.5, &shape), Place::Free);
        assert_eq!(place(|_| 0.6, &shape), Place::Hidden);
        assert_eq!(
            place(|_| 0.93, &shape),
            Place::Unknown,
            "its own front is seen"
        );
        assert_eq!(place(|_| f32::NAN, &shape), Place::Unknown);
        assert_eq!(place(|_| 1.5, &box_at(2.0, 1.0)), Place::OutOfView);
        assert_eq!(place(|_| 1.5, &box_at(0.0, -1.0)), Place::OutOfView);
    }

    #[test]
    fn half_hidden_and_the_other_half_empty_is_empty() {
        let shape = box_at(0.0, 1.0);
        assert_eq!(
            place(|column| if column < 320 { 0.6 } else { 1.5 }, &shape),
            Place::Free
        );
        assert_eq!(
            place(|column| if column < 320 { 0.6 } else { 1.0 }, &shape),
            Place::Hidden
        );
        assert_eq!(
            place(|column| if column < 320 { 1.0 } else { 1.5 }, &shape),
            Place::Unknown
        );
    }

    #[test]
    fn a_box_is_obstructed_by_what_is_before_it_or_in_it_but_not_behind() {
        let slab = box_at(0.0, 1.0);
        for (depth_m, is_obstructed) in [(0.7, true), (1.0, true), (1.09, false), (1.4, false)] {
            let (cloud, camera) = wall(|_| depth_m);
            let view = DepthView::new(&cloud, camera, &RigidTransform::identity()).unwrap();
            assert_eq!(
                view.obstructed_share(&slab) > 0.5,
                is_obstructed,
                "{depth_m}"
            );
        }
    }

    #[test]
    fn a_cloud_that_is_no_image_of_the_camera_is_not_looked_into() {
        let camera = PinholeCamera::KINECT_V1;
        assert!(DepthView::new(&[Point::default()], camera, &RigidTransform::identity()).is_none());
    }
}
