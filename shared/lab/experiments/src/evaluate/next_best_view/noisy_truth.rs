//! Hypotheses that are made from the truth, with noise.

use super::bin_scene::BinScene;
use super::prediction_source::PoseNoise;
use geometry::RigidTransform;
use nalgebra::{Translation3, UnitQuaternion, Vector3};
use random::{Random, mix64};
use scene_client::ObjectHypothesis;
use scene_client::PlanningFrame;

/// All objects of a scene with noisy poses, the same for one seed.
pub(super) fn noisy_truth(
    scene: &BinScene,
    noise: PoseNoise,
    seed: u64,
    frame: &PlanningFrame,
) -> Vec<ObjectHypothesis> {
    let plan_from_world = frame.world_from_plan.inverse();
    let objects = scene.objects.iter().zip(0_u64..);
    let hypotheses = objects.map(|(object, index)| {
        let mut random = Random::substream(seed, mix64(index));
        let pose = moved(&object.world_from_object, noise, &mut random);
        object.hypothesis(plan_from_world * pose)
    });
    hypotheses.collect()
}

/// Pose with noise, about the object's origin.
fn moved(pose: &RigidTransform, noise: PoseNoise, random: &mut Random) -> RigidTransform {
    let mut vector = |sigma: f64| Vector3::from_fn(|_, _| sigma * random.normal());
    let shift = vector(noise.translation_m);
    let turn = UnitQuaternion::from_scaled_axis(vector(noise.rotation_deg.to_radians()));
    RigidTransform::from_parts(
        Translation3::from(pose.translation.vector + shift),
        turn * pose.rotation,
    )
}
