//! Lowering of objects onto what stands below them.

use super::World;
use crate::ObjectModel;
use geometry::RigidTransform;
use nalgebra::{Translation3, UnitQuaternion};
use std::sync::Arc;

/// Height above the table from which objects are lowered, metres; above every stack.
const FROM_ABOVE_M: f64 = 1.2;
/// Gap to the support at which an object is released, metres. Chosen.
const RELEASE_GAP_M: f64 = 0.001;
/// Time that a released object has before the next one is lowered, steps. Chosen.
const RELEASE_STEPS: u32 = 36;

impl World {
    /// Pose of a model lowered straight down until it nearly touches something.
    pub(super) fn lowered_pose(
        &mut self,
        model: &ObjectModel,
        position_m: [f64; 2],
        rotation: &UnitQuaternion<f64>,
    ) -> RigidTransform {
        // The engine finds only bodies that were there in a step.
        self.run_physics(1);
        let top_m = self.scene.table.height_m + FROM_ABOVE_M;
        let at = |z: f64| {
            let position = Translation3::new(position_m[0], position_m[1], z);
            RigidTransform::from_parts(position, *rotation)
        };
        let clearance_m = self
            .physics
            .clearance_below_m(&model.shape, &at(top_m), top_m);
        at(top_m - (clearance_m - RELEASE_GAP_M).max(0.0))
    }

    /// Lowers a new object onto what is there, and lets it go.
    pub(super) fn lower_object(
        &mut self,
        model: Arc<ObjectModel>,
        position_m: [f64; 2],
        rotation: &UnitQuaternion<f64>,
    ) {
        let pose = self.lowered_pose(&model, position_m, rotation);
        self.add_object(model, &pose);
        self.run_physics(RELEASE_STEPS);
    }
}
