//! Visible share of each object in a virtual view: its area beside the others over its area alone.

use geometry::RigidTransform;
use next_best_view::{Hypothesis, PlanningScene, RenderConfig, VirtualView};
use scene_client::ObjectHypothesis;
use service::Failure;

/// Visible share from which on an object counts as seen. Chosen.
const SEEN_SHARE: f64 = 0.1;

/// Scenes of the single objects, and the shares of the last view.
pub(crate) struct VisibleShares {
    alone: Vec<PlanningScene>,
    view: VirtualView,
    areas_m2: Vec<f64>,
    shares: Vec<f64>,
}

impl VisibleShares {
    /// Shares of objects in the order of the hypotheses.
    ///
    /// # Errors
    /// When a pose is not finite.
    pub(crate) fn new(hypotheses: &[ObjectHypothesis]) -> Result<Self, Failure> {
        let alone = |hypothesis: &ObjectHypothesis| {
            let hypothesis = Hypothesis {
                id: 0,
                model: &hypothesis.surface,
                world_from_object: hypothesis.plan_from_object,
            };
            PlanningScene::new(&[hypothesis], &[]).map_err(Failure::general)
        };
        Ok(Self {
            alone: hypotheses.iter().map(alone).collect::<Result<_, _>>()?,
            view: VirtualView::default(),
            areas_m2: Vec::new(),
            shares: Vec::new(),
        })
    }

    /// Measures the shares from a camera; returns the number of objects that are seen.
    ///
    /// # Errors
    /// When the pose or a setting is impossible.
    pub(crate) fn seen_from(
        &mut self,
        scene: &PlanningScene,
        world_from_camera: &RigidTransform,
        render: &RenderConfig,
    ) -> Result<usize, Failure> {
        let view = &mut self.view;
        view.render(scene, world_from_camera, render)
            .map_err(Failure::general)?;
        self.areas_m2.clear();
        self.areas_m2.extend_from_slice(view.object_areas_m2());
        self.shares.clear();
        for (area_m2, alone) in self.areas_m2.iter().zip(&self.alone) {
            view.render(alone, world_from_camera, render)
                .map_err(Failure::general)?;
            let whole_m2: f64 = view.object_areas_m2().iter().sum();
            let share = if whole_m2 > 0.0 {
                area_m2 / whole_m2
            } else {
                0.0
            };
            self.shares.push(share.min(1.0));
        }
        Ok(self
            .shares
            .iter()
            .filter(|share| **share >= SEEN_SHARE)
            .count())
    }

    /// Shares of the last view, 0 to 1.
    pub(crate) fn shares(&self) -> &[f64] {
        &self.shares
    }
}
