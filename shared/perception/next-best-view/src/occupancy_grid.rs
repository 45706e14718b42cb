//! Occupancy of space in voxels: free, occupied or unknown, from observed depth.

use crate::error::Error;
use crate::planning_scene::is_pose_finite;
use crate::ray_casting::{VoxelRay, traverse};
use geometry::RigidTransform;
use nalgebra::{Point3, Vector3};
use point_cloud::Point;
use value_range::check_range;

/// Greatest number of voxels: 16 MB.
const N_VOXELS_MAX: f64 = 16_777_216.0;

/// State of a voxel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum VoxelState {
    /// Voxel that no ray has reached.
    #[default]
    Unknown,
    /// Voxel that a ray has passed.
    Free,
    /// Voxel in which a ray has ended.
    Occupied,
}

/// Voxels of a box in the world, axis-aligned.
#[derive(Debug, Clone, PartialEq)]
pub struct OccupancyGrid {
    first_corner_in_world: Point3<f64>,
    voxel_m: f64,
    n_voxels: [usize; 3],
    states: Vec<VoxelState>,
    n_unknown: usize,
}

impl OccupancyGrid {
    /// Unknown voxels with sides of `voxel_m` that fill a box, given by its least and greatest
    /// corner, world frame, metres.
    ///
    /// # Errors
    /// A corner that is not finite or not beyond the other one, or more than 16 million voxels.
    pub fn new(least: Point3<f64>, greatest: Point3<f64>, voxel_m: f64) -> Result<Self, Error> {
        check_range("voxel_m", voxel_m, 0.001, 1.0)?;
        let mut n_voxels = [0; 3];
        for axis in 0..3 {
            let side_m = greatest[axis] - least[axis];
            check_range("side of the occupancy grid", side_m, voxel_m, 1000.0)?;
            check_range("corner of the occupancy grid", least[axis], -1e4, 1e4)?;
            n_voxels[axis] = (side_m / voxel_m).ceil() as usize;
        }
        let n = n_voxels.iter().map(|&n| n as f64).product();
        check_range("number of voxels", n, 1.0, N_VOXELS_MAX)?;
        let n = n as usize;
        Ok(Self {
            first_corner_in_world: least,
            voxel_m,
            n_voxels,
            states: vec![VoxelState::Unknown; n],
            n_unknown: n,
        })
    }

    /// Marks the voxels that measured points show: free from the camera to a point, occupied at
    /// it. Points without depth say nothing. An occupied voxel stays so: surfaces seen at a
    /// grazing angle would otherwise be freed by their neighbours' rays.
    ///
    /// # Errors
    /// A camera pose that is not finite.
    pub fn observe(
        &mut self,
        points_in_camera: &[Point],
        world_from_camera: &RigidTransform,
    ) -> Result<(), Error> {
        if !is_pose_finite(world_from_camera) {
            let what = "camera";
            return Err(Error::NotFinite { what, index: 0 });
        }
        let camera = self.in_voxels(&world_from_camera.translation.vector.into());
        for point in points_in_camera.iter().filter(|point| point.is_finite()) {
            let end = self.in_voxels(&(world_from_camera * point.position()));
            let last = self.index(&end);
            if let Some(index) = last {
                self.set(index, VoxelState::Occupied);
            }
            let ray = VoxelRay::between(&camera, &end);
            traverse(&ray, self.n_voxels, |index| {
                if Some(index) != last && self.states[index] == VoxelState::Unknown {
                    self.states[index] = VoxelState::Free;
                    self.n_unknown -= 1;
                }
                true
            });
        }
        Ok(())
    }

    fn set(&mut self, index: usize, state: VoxelState) {
        self.n_unknown -= usize::from(self.states[index] == VoxelState::Unknown);
        self.states[index] = state;
    }

    /// Number of unknown voxels.
    pub fn n_unknown(&self) -> usize {
        self.n_unknown
    }

    /// Number of voxels along x, y and z.
    pub fn n_voxels(&self) -> [usize; 3] {
        self.n_voxels
    }

    /// State of the voxel around a place in the world; `None` outside of the grid.
    pub fn state_at(&self, in_world: &Point3<f64>) -> Option<VoxelState> {
        let index = self.index(&self.in_voxels(in_world))?;
        self.states.get(index).copied()
    }

    /// States of all voxels, x fastest.
    pub(crate) fn states(&self) -> &[VoxelState] {
        &self.states
    }

    /// Place in voxels from the first corner.
    pub(crate) fn in_voxels(&self, in_world: &Point3<f64>) -> Vector3<f64> {
        (in_world - self.first_corner_in_world) / self.voxel_m
    }

    /// Index of the voxel around a place in voxels; `None` outside of the grid.
    fn index(&self, place: &Vector3<f64>) -> Option<usize> {
        let mut index = 0;
        for axis in [2, 1, 0] {
            // A coordinate that is not a number is in no range.
            if !(0.0..self.n_voxels[axis] as f64).contains(&place[axis]) {
                return None;
            }
            index = index * self.n_voxels[axis] + place[axis] as usize;
        }
        Some(index)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;

    fn grid() -> OccupancyGrid {
        OccupancyGrid::new(Point3::origin(), Point3::new(0.5, 0.3, 0.2), 0.01).unwrap()
    }

    /// Camera above the grid that looks down.
    fn above() -> RigidTransform {
        RigidTransform::from_parts(
            nalgebra::Translation3::new(0.25, 0.15, 1.0),
            UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI),
        )
    }

    /// Horizontal sheet at a height, in the camera's frame.
    fn sheet(height: f64) -> Vec<Point> {
        let cells = (0..2000).map(|i| {
            (
                f64::from(i % 50) * 0.01 + 0.005,
                f64::from(i / 50) * 0.01 + 0.005,
            )
        });
        cells
            .map(|(x, y)| {
                let p = above().inverse() * Point3::new(x, y, height);
                let [x, y, z] = [p.x as f32, p.y as f32, p.z as f32];
                Point {
                    x,
                    y,
                    z,
                    ..Point::default()
                }
            })
            .collect()
    }

    #[test]
    fn space_above_a_sheet_is_free_and_below_it_unknown() {
        let mut grid = grid();
        assert_eq!(grid.n_unknown(), 50 * 30 * 20);
        let mut points = sheet(0.105);
        points.push(Point::without_depth(point_cloud::Rgba(0)));
        grid.observe(&points, &above()).unwrap();
        for (z, expected) in [
            (0.195, VoxelState::Free),
            (0.115, VoxelState::Free),
            (0.105, VoxelState::Occupied),
            (0.095, VoxelState::Unknown),
            (0.005, VoxelState::Unknown),
        ] {
            let place = Point3::new(0.255, 0.155, z);
            assert_eq!(grid.state_at(&place), Some(expected), "{z}");
        }
        let count = |state| grid.states().iter().filter(|&&s| s == state).count();
        assert_eq!(grid.n_unknown(), count(VoxelState::Unknown));
        assert_eq!(count(VoxelState::Occupied), 50 * 30);
        assert_eq!(grid.state_at(&Point3::new(0.6, 0.1, 0.1)), None);
        assert_eq!(grid.state_at(&Point3::new(f64::NAN, 0.1, 0.1)), None);
    }

    #[test]
    fn impossible_boxes_are_refused() {
        let refused = |greatest: [f64; 3], voxel_m| {
            OccupancyGrid::new(Point3::origin(), greatest.into(), voxel_m).is_err()
        };
        assert!(refused([1.0, 1.0, -1.0], 0.01) && refused([1.0, f64::NAN, 1.0], 0.01));
        assert!(refused([1.0; 3], 0.0) && refused([1.0; 3], 0.001));
        assert!(!refused([1.0; 3], 0.01));
        let pose = RigidTransform::translation(f64::NAN, 0.0, 0.0);
        assert!(grid().observe(&[], &pose).is_err());
    }
}
