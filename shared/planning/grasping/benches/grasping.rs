//! Benchmarks of the planning of grasps: one object, and a scene of twelve.

#[path = "../tests/solid_scene/mod.rs"]
mod solid_scene;

use arm_kinematics::{Arm, GripperModel, HOME, JointVector};
use divan::Bencher;
use geometry::RigidTransform;
use grasping::{GraspPlanner, GraspScene, GraspSettings, Obstacles, PlacedArm, contact_surface};
use nalgebra::{Point3, Vector3};
use solid_scene::{Solid, SolidScene};

fn main() {
    divan::main();
}

fn arm() -> PlacedArm {
    PlacedArm {
        arm: Arm::jaco_like(),
        plan_from_base: RigidTransform::translation(-0.5, -0.1, 0.0),
        joints_rad: JointVector::from(HOME),
    }
}

fn planner<'a>(
    scene: &'a GraspScene<'a>,
    obstacles: &'a Obstacles,
    arm: &'a PlacedArm,
    settings: &'a GraspSettings,
) -> GraspPlanner<'a> {
    GraspPlanner {
        scene,
        obstacles,
        gripper: &GripperModel::JACO_LIKE,
        arm: Some(arm),
        settings,
    }
}

/// Twelve boxes, balls and tubes.
fn scene() -> SolidScene {
    let solids: Vec<Solid> = (0..12)
        .map(|k| {
            let place = Vector3::new(
                f64::from(k % 4) * 0.12 - 0.18,
                f64::from(k / 4) * 0.13 - 0.1,
                0.0,
            );
            match k % 3 {
                0 => Solid::Box(
                    (place + Vector3::z() * 0.04).into(),
                    Vector3::new(0.02, 0.035, 0.04),
                    0.3,
                ),
                1 => Solid::Ball((place + Vector3::z() * 0.035).into(), 0.035),
                _ => Solid::Tube(Point3::from(place), 0.04, 0.004, 0.09),
            }
        })
        .collect();
    SolidScene::new(&solids)
}

#[divan::bench(args = [0, 1, 2])]
fn contacts_of_an_object(bencher: Bencher<'_, '_>, object: usize) {
    let scene = scene();
    let scene = scene.grasp_scene();
    bencher.bench_local(|| contact_surface(&scene, object));
}

#[divan::bench(args = [0, 1, 2])]
fn one_object(bencher: Bencher<'_, '_>, object: usize) {
    let (scene, arm, settings) = (scene(), arm(), GraspSettings::default());
    let scene = scene.grasp_scene();
    let obstacles = Obstacles::of(&scene);
    let planner = planner(&scene, &obstacles, &arm, &settings);
    bencher.bench_local(|| planner.plan(object));
}

#[divan::bench]
fn scene_of_twelve(bencher: Bencher<'_, '_>) {
    let (rendered, arm, settings) = (scene(), arm(), GraspSettings::default());
    bencher.bench_local(|| {
        let scene = rendered.grasp_scene();
        let obstacles = Obstacles::of(&scene);
        let planner = planner(&scene, &obstacles, &arm, &settings);
        (0..12)
            .map(|object| planner.plan(object))
            .collect::<Vec<_>>()
    });
}
