//! Explained space: the neighbourhood of the surfaces of hypotheses, whose measured points are no
//! background.

use super::bin_scene::BinScene;
use geometry::RigidTransform;
use nalgebra::Point3;
use next_best_view::SurfaceModel;

/// Side of the voxels within which, and within the neighbours of which, a measured point is
/// explained by a hypothesis, metres. Chosen: above the noise of depth and poses.
const EXPLAINED_VOXEL_M: f64 = 0.008;
/// Space near the surfaces of hypotheses, in voxels of the workspace.
pub(super) struct ExplainedSpace {
    least: [f64; 3],
    n_voxels: [usize; 3],
    is_explained: Vec<bool>,
}

impl ExplainedSpace {
    pub(super) fn new(scene: &BinScene) -> Self {
        let (least, greatest) = (scene.workspace.least, scene.workspace.greatest);
        let n_voxels = std::array::from_fn(|axis| {
            ((greatest[axis] - least[axis]) / EXPLAINED_VOXEL_M).ceil() as usize
        });
        Self {
            least: least.coords.into(),
            n_voxels,
            is_explained: vec![false; n_voxels.iter().product()],
        }
    }

    pub(super) fn add(&mut self, model: &SurfaceModel, world_from_model: &RigidTransform) {
        for point in model.points() {
            let place = (world_from_model * Point3::from(*point).cast::<f64>()).coords;
            for neighbour in 0..27 {
                let offset = [neighbour % 3, neighbour / 3 % 3, neighbour / 9];
                let near = std::array::from_fn(|axis| {
                    place[axis] + (f64::from(offset[axis]) - 1.0) * EXPLAINED_VOXEL_M
                });
                if let Some(index) = self.index(near) {
                    self.is_explained[index] = true;
                }
            }
        }
    }

    pub(super) fn contains(&self, point: &[f32; 3]) -> bool {
        let index = self.index(point.map(f64::from));
        index.is_some_and(|index| self.is_explained[index])
    }

    fn index(&self, place: [f64; 3]) -> Option<usize> {
        let mut index = 0;
        for axis in [2, 1, 0] {
            let voxel = (place[axis] - self.least[axis]) / EXPLAINED_VOXEL_M;
            if !(0.0..self.n_voxels[axis] as f64).contains(&voxel) {
                return None;
            }
            index = index * self.n_voxels[axis] + voxel as usize;
        }
        Some(index)
    }
}
