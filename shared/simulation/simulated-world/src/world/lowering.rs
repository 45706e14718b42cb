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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glam_conversion::point_to_glam;
    use crate::model_library::ModelLibrary;
    use crate::scene::{Scene, SceneKind};
    use crate::scene_object::{ObjectState, SimulatedObject};

    /// Greatest depth of a vertex of the mesh inside another object's convex parts, metres: twice
    /// the gap of 7.5 mm that the parts of household objects may leave to the surface.
    const SUNK_MAX_M: f64 = 0.015;
    /// Greatest depth to which an object at rest may sink into the table, metres.
    const SUNK_IN_TABLE_MAX_M: f64 = 0.005;

    /// Depth of the deepest vertex of an object inside another object, metres.
    fn depth_m(object: &SimulatedObject, other: &SimulatedObject) -> f64 {
        let other_from_object = other.world_from_object.inverse() * object.world_from_object;
        let vertices = object.model.mesh.vertices.iter();
        let depths = vertices.map(|vertex| {
            let point = other_from_object.cast::<f32>() * vertex.position;
            let found = other
                .model
                .shape
                .project_local_point(point_to_glam(&point), false);
            let away = found.point - point_to_glam(&point);
            if found.is_inside { away.length() } else { 0.0 }
        });
        f64::from(depths.fold(0.0, f32::max))
    }

    /// True if an object extends over the rim, where it may hang below the table top.
    fn is_tilted_over_rim(object: &SimulatedObject, world: &World) -> bool {
        let at = object.world_from_object.translation;
        let reach_m = object.model.half_sides_m.norm();
        let [x, y] = world.scene.table.size_m.map(|side| side / 2.0 - reach_m);
        at.x.abs() > x || at.y.abs() > y
    }

    #[test]
    fn clutter_objects_do_not_intersect_at_rest() {
        for seed in 0..6 {
            let mut library = ModelLibrary::generated();
            let scene = Scene::generate(SceneKind::Clutter, 18, seed, &mut library).unwrap();
            let world = World::new(scene, library).unwrap();
            let settled = |o: &&SimulatedObject| o.state == ObjectState::Settled;
            for object in world.objects.iter().filter(settled) {
                let name = &object.model.name;
                let below_m = world.scene.table.height_m - object.height_range_m().0;
                assert!(
                    below_m < SUNK_IN_TABLE_MAX_M || is_tilted_over_rim(object, &world),
                    "{seed}: {name} {below_m} m"
                );
                for other in world.objects.iter().filter(|o| o.id != object.id) {
                    let depth_m = depth_m(object, other);
                    let other = &other.model.name;
                    assert!(
                        depth_m < SUNK_MAX_M,
                        "{seed}: {name} in {other}: {depth_m} m"
                    );
                }
            }
        }
    }

    #[test]
    fn lowered_object_is_released_just_above_its_support() {
        let mut world = World::new(Scene::default(), ModelLibrary::generated()).unwrap();
        let model = Arc::new(ObjectModel::generated("carton", 3).unwrap());
        let height_m = 2.0 * model.half_sides_m.z;
        let table_m = world.scene.table.height_m;
        for n_below in 0..3 {
            let upright = UnitQuaternion::identity();
            let pose = world.lowered_pose(&model, [0.1, 0.0], &upright);
            let expected_m = table_m + height_m * (f64::from(n_below) + 0.5) + RELEASE_GAP_M;
            assert!((pose.translation.z - expected_m).abs() < 0.002, "{n_below}");
            world.lower_object(Arc::clone(&model), [0.1, 0.0], &upright);
        }
    }
}
