//! Content of a plan: hypotheses, background and unknown space of a snapshot.

use crate::planning_space::PlanningSpace;
use crate::virtual_camera;
use geometry::PinholeCamera;
use next_best_view::{Hypothesis, OccupancyGrid, PlanningScene};
use scene_client::{ModelShelf, ObjectHypothesis, PlanningFrame, Snapshot, hypotheses};
use service::Failure;

/// Side of the cells of virtual views, metres, at least, and in distances of measured points.
const CELL_MIN_M: f64 = 0.003;
const CELL_STEPS: f64 = 1.2;
/// Number of cells along the diagonal of the space at most.
const N_CELLS_MAX: f64 = 1500.0;

/// Content of a plan: hypotheses and background in the frame of planning.
#[derive(Debug)]
pub struct PlanContent {
    /// Frame of planning with the present pose of the camera.
    pub frame: PlanningFrame,
    /// Camera of the frame.
    pub camera: PinholeCamera,
    /// Hypotheses of the objects.
    pub hypotheses: Vec<ObjectHypothesis>,
    /// Points of the background, metres.
    pub background: Vec<[f32; 3]>,
    /// Free, occupied and unknown voxels; `None` where unknown space does not count.
    pub occupancy: Option<OccupancyGrid>,
    /// Side of the cells of virtual views, metres.
    pub cell_m: f64,
}

impl PlanContent {
    /// Content of a snapshot, with the models of a shelf in the poses of its objects.
    ///
    /// # Errors
    /// When the points of an object make no surface, or the space is too large.
    pub fn of(
        snapshot: &Snapshot,
        frame: PlanningFrame,
        shelf: &ModelShelf,
        wants_occupancy: bool,
    ) -> Result<Self, Failure> {
        let cell_m = cell_m(snapshot, &frame);
        let hypotheses = hypotheses(shelf, snapshot, &frame.plan_from_camera, cell_m)?;
        Self::with_hypotheses(snapshot, frame, hypotheses, wants_occupancy)
    }

    /// Content of a snapshot with given hypotheses.
    ///
    /// # Errors
    /// When the space is too large.
    pub fn with_hypotheses(
        snapshot: &Snapshot,
        frame: PlanningFrame,
        hypotheses: Vec<ObjectHypothesis>,
        wants_occupancy: bool,
    ) -> Result<Self, Failure> {
        let space = PlanningSpace::around(&hypotheses);
        let cell_m = cell_m(snapshot, &frame).max(space.diagonal_m() / N_CELLS_MAX);
        let background = space.background(snapshot, &frame, (&hypotheses, cell_m))?;
        let occupancy = wants_occupancy.then(|| space.occupancy(snapshot, &frame));
        Ok(Self {
            occupancy: occupancy.transpose()?,
            camera: snapshot.camera,
            frame,
            hypotheses,
            background,
            cell_m,
        })
    }

    /// Scene of the hypotheses, numbered by their order, and the background.
    ///
    /// # Errors
    /// When a pose is not finite.
    pub fn scene(&self) -> Result<PlanningScene, Failure> {
        let numbered = self.hypotheses.iter().zip(0_u32..);
        let hypotheses: Vec<Hypothesis<'_>> = numbered
            .map(|(hypothesis, id)| Hypothesis {
                id,
                model: &hypothesis.surface,
                world_from_object: hypothesis.plan_from_object,
            })
            .collect();
        PlanningScene::new(&hypotheses, &self.background).map_err(Failure::general)
    }

    /// Camera of virtual views: that of the frame, as coarse as the measured points.
    pub fn virtual_camera(&self) -> PinholeCamera {
        let distance_m = self.frame.plan_from_camera.translation.vector.norm();
        virtual_camera::coarse(&self.camera, distance_m, self.cell_m)
    }
}

/// Side of the cells: no less than the distance of measured points.
fn cell_m(snapshot: &Snapshot, frame: &PlanningFrame) -> f64 {
    let distance_m = frame.plan_from_camera.translation.vector.norm();
    let focal_px = snapshot.camera.fx_px.min(snapshot.camera.fy_px);
    (CELL_STEPS * distance_m / focal_px).clamp(CELL_MIN_M, 0.05)
}
