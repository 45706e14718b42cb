//! Tests of resting stability: every household object rests where it was put down.

#![expect(clippy::unwrap_used, reason = "a failing set-up must fail the test")]

use simulated_world::{
    ModelChoice, ModelLibrary, ObjectPlacement, ObjectPlan, ObjectState, Scene, World,
    category_names,
};

/// Greatest distance that an object may slide or roll before it rests, metres.
const SLID_MAX_M: f64 = 0.04;
/// Greatest depth that an object may sink into the table, and its convex parts may protrude,
/// metres.
const SUNK_MAX_M: f64 = 0.005;
/// Settling time for objects that rock from facet to facet, steps.
const N_STEPS: usize = 300;

fn world_with(category: &str, instance: u64) -> World {
    let plan = ObjectPlan {
        model: ModelChoice::Generated {
            category: category.to_owned(),
            instance,
        },
        placement: ObjectPlacement::Upright {
            position_m: [0.0, 0.0],
            yaw_rad: 0.3,
            raised_m: 0.0,
        },
    };
    let scene = Scene {
        objects: vec![plan],
        ..Scene::default()
    };
    World::new(scene, ModelLibrary::generated()).unwrap()
}

/// Fault of a resting object, if any.
fn fault(world: &World) -> Option<String> {
    let object = &world.objects()[0];
    let pose = object.world_from_object.cast::<f32>();
    let heights = object
        .model
        .mesh
        .vertices
        .iter()
        .map(|v| (pose * v.position).z);
    let lowest_m = f64::from(heights.fold(f32::MAX, f32::min)) - world.scene().table.height_m;
    let slid_m = pose.translation.x.hypot(pose.translation.y);
    let is_wrong = object.state != ObjectState::Settled
        || f64::from(slid_m) > SLID_MAX_M
        || lowest_m.abs() > SUNK_MAX_M;
    is_wrong.then(|| {
        format!(
            "{} is {}, slid {:.0} mm, lowest point {:.1} mm over the table",
            object.model.name,
            object.state.word(),
            slid_m * 1e3,
            lowest_m * 1e3
        )
    })
}

#[test]
fn objects_rest_where_they_were_put_down() {
    let mut faults = Vec::new();
    for category in category_names() {
        for instance in 0..3 {
            let mut world = world_with(category, instance);
            for _ in 0..N_STEPS {
                world.step();
            }
            faults.extend(fault(&world));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
