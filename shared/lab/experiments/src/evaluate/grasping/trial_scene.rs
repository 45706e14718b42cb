//! Scene of a trial: one object at rest on the table in a random pose.

use geometry::RigidTransform;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use random::Random;
use service::Failure;
use simulated_world::{
    ArmMount, ModelChoice, ModelLibrary, ObjectPlacement, ObjectPlan, Scene, World,
};

/// Half side of the square in the middle of the table above which objects are dropped, metres:
/// everything in it is in reach of the arm and in view.
const DROP_HALF_M: f64 = 0.08;
/// Height of the lowest point of a dropped object over the table, metres.
const DROP_HEIGHT_M: f64 = 0.02;

/// World with one object at rest.
pub(super) fn world(
    model: &ModelChoice,
    seed: u64,
    mut library: ModelLibrary,
) -> Result<World, Failure> {
    let loaded = library.load(model).map_err(Failure::general)?;
    let mut random = Random::from_seed(seed);
    let rotation = random_rotation(&mut random);
    let mut scene = Scene {
        seed,
        arm: Some(ArmMount::default()),
        ..Scene::default()
    };
    let radius_m = loaded.half_sides_m.norm();
    let place = Vector3::new(
        random.between(-DROP_HALF_M, DROP_HALF_M),
        random.between(-DROP_HALF_M, DROP_HALF_M),
        scene.table.height_m + radius_m + DROP_HEIGHT_M,
    );
    scene.objects = vec![ObjectPlan {
        model: model.clone(),
        placement: ObjectPlacement::Dropped {
            world_from_object: RigidTransform::from_parts(place.into(), rotation),
        },
    }];
    World::new(scene, library).map_err(Failure::general)
}

/// Uniform random rotation (Shoemake 1992).
fn random_rotation(random: &mut Random) -> UnitQuaternion<f64> {
    let [a, b, c] = [(); 3].map(|()| random.unit());
    let (turn, other) = (std::f64::consts::TAU * b, std::f64::consts::TAU * c);
    let (near, far) = ((1.0 - a).sqrt(), a.sqrt());
    UnitQuaternion::new_normalize(Quaternion::new(
        far * other.cos(),
        near * turn.sin(),
        near * turn.cos(),
        far * other.sin(),
    ))
}
