//! Explained space: the neighbourhood of the surfaces of hypotheses, whose measured points are no
//! background.

use crate::surface_model::SurfaceModel;
use geometry::RigidTransform;
use nalgebra::Point3;
use std::collections::HashSet;

/// Side of the voxels, metres: a measured point is explained in the voxel of a surface and in its
/// neighbours. Chosen: above the noise of depth and poses.
const VOXEL_M: f64 = 0.008;

/// Voxels at the surfaces of hypotheses, and their neighbours.
#[derive(Debug, Clone)]
pub struct ExplainedSpace {
    corner: Point3<f64>,
    explained: HashSet<[i32; 3]>,
}

impl ExplainedSpace {
    /// Space without hypotheses; the corner of a voxel is at a place, metres.
    pub fn new(corner: Point3<f64>) -> Self {
        Self {
            corner,
            explained: HashSet::new(),
        }
    }

    /// Adds a model at a pose.
    pub fn add(&mut self, model: &SurfaceModel, world_from_model: &RigidTransform) {
        let points = model.points().iter();
        let places = points.map(|point| world_from_model * Point3::from(*point).cast::<f64>());
        let occupied: HashSet<[i32; 3]> = places.map(|place| self.voxel_of(&place)).collect();
        for voxel in occupied {
            for neighbour in 0..27 {
                let offset = [neighbour % 3 - 1, neighbour / 3 % 3 - 1, neighbour / 9 - 1];
                let place = [0, 1, 2].map(|axis| voxel[axis].saturating_add(offset[axis]));
                self.explained.insert(place);
            }
        }
    }

    /// `true` for a place near a surface of the hypotheses.
    pub fn contains(&self, place: &Point3<f64>) -> bool {
        self.explained.contains(&self.voxel_of(place))
    }

    fn voxel_of(&self, place: &Point3<f64>) -> [i32; 3] {
        [0, 1, 2].map(|axis| ((place[axis] - self.corner[axis]) / VOXEL_M).floor() as i32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_near_a_surface_are_explained_and_others_are_not() {
        let spot = SurfaceModel::of_points(&[[0.0; 3]], 0.003).unwrap();
        let mut space = ExplainedSpace::new(Point3::new(-0.5, -0.5, -0.5));
        assert!(!space.contains(&Point3::new(0.1, 0.2, 0.3)));
        space.add(&spot, &RigidTransform::translation(0.1, 0.2, 0.3));
        for (off_m, is_explained) in [(0.0, true), (0.008, true), (-0.008, true), (0.017, false)] {
            for axis in 0..3 {
                let mut place = Point3::new(0.1, 0.2, 0.3);
                place[axis] += off_m;
                assert_eq!(space.contains(&place), is_explained, "{place}");
            }
        }
    }
}
