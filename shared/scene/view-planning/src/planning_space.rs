//! Space around the objects: its background points, and its unknown voxels.

use nalgebra::{Point3, Vector3};
use next_best_view::{ExplainedSpace, OccupancyGrid, SurfaceModel};
use point_cloud::Point;
use scene_client::{ObjectHypothesis, PlanningFrame, Snapshot};
use service::Failure;

/// Margins around the objects: to the sides and above, and below the lowest, metres. Chosen: the
/// table around them counts, the walls behind do not.
const MARGIN_M: f64 = 0.15;
const MARGIN_BELOW_M: f64 = 0.05;
/// Half side of the space when there are no objects, metres. Chosen.
const EMPTY_HALF_M: f64 = 0.3;
/// Side of the voxels of unknown space, metres, and their greatest number, for which they become
/// larger. Chosen.
const VOXEL_M: f64 = 0.01;
const N_VOXELS_MAX: f64 = 2e6;
/// Width of a frame, points, above which every second point of each second row is enough to tell
/// free space.
const WIDTH_FINE: usize = 320;

/// Box around the objects in the frame of planning, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanningSpace {
    least: Point3<f64>,
    greatest: Point3<f64>,
}

impl PlanningSpace {
    /// Space around hypotheses, or around the origin without any.
    pub fn around(hypotheses: &[ObjectHypothesis]) -> Self {
        let (mut least, mut greatest) = (
            Vector3::repeat(f64::INFINITY),
            Vector3::repeat(-f64::INFINITY),
        );
        for place in hypotheses.iter().flat_map(surface_in_plan) {
            least = least.inf(&place.coords);
            greatest = greatest.sup(&place.coords);
        }
        if hypotheses.is_empty() {
            (least, greatest) = (
                Vector3::repeat(-EMPTY_HALF_M),
                Vector3::repeat(EMPTY_HALF_M),
            );
        }
        let margin = Vector3::repeat(MARGIN_M);
        Self {
            least: (least - Vector3::new(MARGIN_M, MARGIN_M, MARGIN_BELOW_M)).into(),
            greatest: (greatest + margin).into(),
        }
    }

    /// Longest diagonal, metres.
    pub fn diagonal_m(&self) -> f64 {
        (self.greatest - self.least).norm()
    }

    /// Corners with the least and the greatest coordinates.
    pub fn corners(&self) -> [Point3<f64>; 2] {
        [self.least, self.greatest]
    }

    /// True for a place in the space.
    pub fn contains(&self, place: &Point3<f64>) -> bool {
        (0..3).all(|axis| (self.least[axis]..=self.greatest[axis]).contains(&place[axis]))
    }

    /// Measured points that no hypothesis explains, at most one in each cell, frame of planning.
    ///
    /// # Errors
    /// When the cells are impossible.
    pub fn background(
        &self,
        snapshot: &Snapshot,
        frame: &PlanningFrame,
        (hypotheses, cell_m): (&[ObjectHypothesis], f64),
    ) -> Result<Vec<[f32; 3]>, Failure> {
        let mut explained = ExplainedSpace::new(Point3::origin());
        for hypothesis in hypotheses {
            explained.add(&hypothesis.surface, &hypothesis.plan_from_object);
        }
        let places = snapshot.measured().map(|point| frame.place(point));
        let unexplained = places
            .filter(|place| self.contains(place) && !explained.contains(place))
            .map(|place| place.cast::<f32>().into());
        let unexplained: Vec<[f32; 3]> = unexplained.collect();
        if unexplained.is_empty() {
            return Ok(Vec::new());
        }
        let thinned = SurfaceModel::of_points(&unexplained, cell_m).map_err(Failure::general)?;
        Ok(thinned.points().to_vec())
    }

    /// Voxels of the space as the frame shows them: free, occupied or unknown.
    ///
    /// # Errors
    /// When there are too many voxels.
    pub fn occupancy(
        &self,
        snapshot: &Snapshot,
        frame: &PlanningFrame,
    ) -> Result<OccupancyGrid, Failure> {
        let volume_m3 = (self.greatest - self.least).iter().product::<f64>();
        let voxel_m = (volume_m3 / N_VOXELS_MAX).cbrt().max(VOXEL_M);
        let grid = OccupancyGrid::new(self.least, self.greatest, voxel_m);
        let mut grid = grid.map_err(Failure::general)?;
        let width = (snapshot.camera.width as usize).max(1);
        let step = if width > WIDTH_FINE { 2 } else { 1 };
        let rows = snapshot.points.chunks(width).step_by(step);
        let points: Vec<Point> = rows
            .flat_map(|row| row.iter().step_by(step))
            .copied()
            .collect();
        grid.observe(&points, &frame.plan_from_camera)
            .map_err(Failure::general)?;
        Ok(grid)
    }
}

/// Surface points of a hypothesis in the frame of planning.
fn surface_in_plan(hypothesis: &ObjectHypothesis) -> impl Iterator<Item = Point3<f64>> {
    let points = hypothesis.surface.points().iter();
    points.map(|point| hypothesis.plan_from_object * Point3::from(*point).cast::<f64>())
}

#[cfg(test)]
mod tests;
