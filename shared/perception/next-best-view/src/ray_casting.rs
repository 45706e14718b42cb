//! Ray casting through voxels (Amanatides and Woo 1987), and the unknown voxels that a view sees.

use crate::occupancy_grid::{OccupancyGrid, VoxelState};
use geometry::{PinholeCamera, RigidTransform};
use nalgebra::Vector3;

/// Camera of the information gain: the field of view of a Kinect, one ray for each 16 pixels,
/// which are 2 cm apart at 1 m. Chosen.
const RAY_CAMERA: PinholeCamera = PinholeCamera {
    fx_px: 585.0 / 8.0,
    fy_px: 585.0 / 8.0,
    cx_px: 39.5,
    cy_px: 29.5,
    width: 80,
    height: 60,
};

/// Ray in units of voxels: from its start, `length` directions long.
#[derive(Debug, Clone, Copy)]
pub(crate) struct VoxelRay {
    start: Vector3<f64>,
    direction: Vector3<f64>,
    length: f64,
}

impl VoxelRay {
    /// Ray from a place to another one.
    pub(crate) fn between(start: &Vector3<f64>, end: &Vector3<f64>) -> Self {
        Self {
            start: *start,
            direction: end - start,
            length: 1.0,
        }
    }

    /// Range of the ray within a box from the origin, in directions; `None` outside.
    fn clipped(&self, n_voxels: [usize; 3]) -> Option<[f64; 2]> {
        let (mut enter, mut leave) = (0.0_f64, self.length);
        for (axis, &n) in n_voxels.iter().enumerate() {
            let (start, step) = (self.start[axis], self.direction[axis]);
            let far = n as f64;
            if !(start + step).is_finite() {
                return None;
            }
            if step == 0.0 {
                if !(0.0..far).contains(&start) {
                    return None;
                }
                continue;
            }
            let ends = [-start / step, (far - start) / step];
            enter = enter.max(ends[0].min(ends[1]));
            leave = leave.min(ends[0].max(ends[1]));
        }
        (enter < leave).then_some([enter, leave])
    }
}

/// Visits the indices of the voxels along a ray, x fastest, until `visit` answers `false`.
pub(crate) fn traverse(ray: &VoxelRay, n_voxels: [usize; 3], mut visit: impl FnMut(usize) -> bool) {
    let Some([enter, leave]) = ray.clipped(n_voxels) else {
        return;
    };
    let strides = [1, n_voxels[0], n_voxels[0] * n_voxels[1]];
    let at = ray.start + ray.direction * enter;
    let (mut voxel, mut index) = ([0_usize; 3], 0);
    let (mut next, mut delta) = ([f64::INFINITY; 3], [f64::INFINITY; 3]);
    for axis in 0..3 {
        let step = ray.direction[axis];
        voxel[axis] = (at[axis].floor().max(0.0) as usize).min(n_voxels[axis] - 1);
        index += voxel[axis] * strides[axis];
        if step != 0.0 {
            let border = voxel[axis] as f64 + f64::from(u8::from(step > 0.0));
            next[axis] = (border - ray.start[axis]) / step;
            delta[axis] = 1.0 / step.abs();
        }
    }
    loop {
        if !visit(index) {
            return;
        }
        let axis = nearest_axis(&next);
        if next[axis] >= leave {
            return;
        }
        let is_forward = ray.direction[axis] > 0.0;
        let end = if is_forward { n_voxels[axis] - 1 } else { 0 };
        if voxel[axis] == end {
            return;
        }
        if is_forward {
            voxel[axis] += 1;
            index += strides[axis];
        } else {
            voxel[axis] -= 1;
            index -= strides[axis];
        }
        next[axis] += delta[axis];
    }
}

fn nearest_axis(next: &[f64; 3]) -> usize {
    if next[0] <= next[1] && next[0] <= next[2] {
        0
    } else if next[1] <= next[2] {
        1
    } else {
        2
    }
}

/// Voxels that the rays of a view have counted, reused from view to view.
#[derive(Debug, Clone, Default)]
pub(crate) struct SeenVoxels {
    /// Number of the view that counted each voxel last.
    stamps: Vec<u32>,
    n_views: u32,
}

impl SeenVoxels {
    /// Number of unknown voxels that a camera would see, up to the first occupied voxel of each
    /// ray. Unknown voxels hide nothing, as if they were free.
    pub(crate) fn count_unknown(
        &mut self,
        grid: &OccupancyGrid,
        world_from_camera: &RigidTransform,
    ) -> usize {
        let states = grid.states();
        if self.stamps.len() != states.len() || self.n_views == u32::MAX {
            self.stamps.clear();
            self.stamps.resize(states.len(), 0);
            self.n_views = 0;
        }
        self.n_views += 1;
        let (stamp, mut n_seen) = (self.n_views, 0);
        let start = grid.in_voxels(&world_from_camera.translation.vector.into());
        for row in 0..RAY_CAMERA.height {
            for column in 0..RAY_CAMERA.width {
                let in_camera = RAY_CAMERA.ray(column.into(), row.into());
                let ray = VoxelRay {
                    start,
                    direction: world_from_camera.rotation * in_camera,
                    length: f64::INFINITY,
                };
                traverse(&ray, grid.n_voxels(), |index| {
                    if states[index] == VoxelState::Unknown && self.stamps[index] != stamp {
                        self.stamps[index] = stamp;
                        n_seen += 1;
                    }
                    states[index] != VoxelState::Occupied
                });
            }
        }
        n_seen
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;
    use point_cloud::Point;
    use random::Random;

    /// Voxels along a ray by small steps.
    fn sampled(ray: &VoxelRay, n_voxels: [usize; 3]) -> Vec<usize> {
        let mut found = Vec::new();
        for step in 0..40_000 {
            let at = ray.start + ray.direction * (f64::from(step) / 40_000.0);
            let inside = |axis: usize| (0.0..n_voxels[axis] as f64).contains(&at[axis]);
            if (0..3).all(inside) {
                let [x, y, z] = [0, 1, 2].map(|axis| at[axis] as usize);
                let index = (z * n_voxels[1] + y) * n_voxels[0] + x;
                if found.last() != Some(&index) {
                    found.push(index);
                }
            }
        }
        found
    }

    #[test]
    fn traversal_visits_what_small_steps_visit() {
        let n_voxels = [7, 9, 5];
        let mut random = Random::from_seed(5);
        for _ in 0..200 {
            let mut place = || Vector3::from_fn(|_, _| random.between(-6.0, 14.0));
            let ray = VoxelRay::between(&place(), &place());
            let mut visited = Vec::new();
            traverse(&ray, n_voxels, |index| {
                visited.push(index);
                true
            });
            let sampled = sampled(&ray, n_voxels);
            // Steps may miss a voxel of which the ray only cuts a corner.
            assert!(
                sampled.iter().all(|index| visited.contains(index)),
                "{ray:?}"
            );
            assert!(
                visited.len() <= sampled.len() + 2,
                "{visited:?} {sampled:?}"
            );
        }
    }

    #[test]
    fn rays_along_an_axis_and_without_length_end() {
        let visits = |start: [f64; 3], end: [f64; 3]| {
            let mut n = 0;
            let ray = VoxelRay::between(&start.into(), &end.into());
            traverse(&ray, [4, 4, 4], |_| {
                n += 1;
                true
            });
            n
        };
        assert_eq!(visits([-2.0, 1.5, 1.5], [9.0, 1.5, 1.5]), 4);
        assert_eq!(visits([9.0, 1.5, 1.5], [1.5, 1.5, 1.5]), 3);
        assert_eq!(visits([-2.0, 4.5, 1.5], [9.0, 4.5, 1.5]), 0);
        assert_eq!(visits([1.5; 3], [1.5; 3]), 1);
        assert_eq!(visits([f64::NAN; 3], [1.5; 3]), 0);
    }

    #[test]
    fn unknown_space_behind_a_wall_is_seen_from_behind_only() {
        let (least, greatest) = (Point3::new(-0.2, -0.2, -0.2), Point3::new(0.2, 0.2, 0.2));
        let mut grid = OccupancyGrid::new(least, greatest, 0.02).unwrap();
        let from = |x: f64| {
            let (eye, middle) = (Point3::new(x, 0.0, 0.0), Point3::origin());
            RigidTransform::face_towards(&eye, &middle, &-Vector3::z())
        };
        // A wall in the plane x = 0, seen from +x.
        let camera = from(1.0);
        let points: Vec<Point> = (0..4225)
            .map(|i| {
                let [y, z] = [i % 65, i / 65].map(|k| f64::from(k) * 0.01 - 0.32);
                let p = camera.inverse() * Point3::new(0.001, y, z);
                let [x, y, z] = [p.x as f32, p.y as f32, p.z as f32];
                Point {
                    x,
                    y,
                    z,
                    ..Point::default()
                }
            })
            .collect();
        grid.observe(&points, &camera).unwrap();
        let n_half = 10 * 20 * 20;
        assert_eq!(grid.n_unknown(), n_half);
        let mut seen = SeenVoxels::default();
        let of = |x: f64, seen: &mut SeenVoxels| seen.count_unknown(&grid, &from(x));
        assert_eq!(of(1.0, &mut seen), 0);
        assert_eq!(of(-1.0, &mut seen), n_half);
        assert_eq!(of(1.0, &mut seen), 0);
        assert_eq!(seen.count_unknown(&grid, &from(-1.0).inverse()), 0);
    }
}
