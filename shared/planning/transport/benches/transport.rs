//! Benchmarks of transport: obstacles of a scene of twelve, a transit, and a whole transport.

#[path = "../../grasping/tests/solid_scene/mod.rs"]
mod solid_scene;

use arm_kinematics::{Arm, HOME, JointVector};
use divan::Bencher;
use geometry::{ConvexPolygon, RigidTransform};
use grasping::{GraspPlanner, GraspSettings, Obstacles, PlacedArm, contact_surface};
use nalgebra::{Point2, Point3, Vector3};
use solid_scene::{Solid, SolidScene};
use transport::{PlaceArea, TransportPlanner};

const REGION: [Point3<f64>; 2] = [Point3::new(-1.5, -1.5, -0.2), Point3::new(1.0, 1.0, 1.2)];

fn main() {
    divan::main();
}

/// Twelve boxes, balls and tubes, the arm beside them, and an area behind them.
fn scene() -> SolidScene {
    let solids: Vec<Solid> = (0..12)
        .map(|k| {
            let (x, y) = (
                f64::from(k % 4) * 0.12 - 0.18,
                f64::from(k / 4) * 0.13 - 0.2,
            );
            match k % 3 {
                0 => Solid::Ball(Point3::new(x, y, 0.035), 0.035),
                1 => Solid::Box(Point3::new(x, y, 0.05), Vector3::new(0.02, 0.03, 0.05), 0.3),
                _ => Solid::Tube(Point3::new(x, y, 0.0), 0.04, 0.004, 0.09),
            }
        })
        .collect();
    SolidScene::new(&solids)
}

fn arm() -> PlacedArm {
    PlacedArm {
        arm: Arm::jaco_like(),
        plan_from_base: RigidTransform::translation(-0.55, -0.1, 0.0),
        joints_rad: JointVector::from(HOME),
    }
}

#[divan::bench]
fn obstacles_within_reach(bencher: Bencher<'_, '_>) {
    let image = scene();
    let scene = image.grasp_scene();
    bencher.bench_local(|| Obstacles::within(&scene, &REGION));
}

#[divan::bench]
fn transport_of_an_object(bencher: Bencher<'_, '_>) {
    let (image, placed) = (scene(), arm());
    let scene = image.grasp_scene();
    let near = Obstacles::of(&scene);
    let grasp_planner = GraspPlanner {
        scene: &scene,
        obstacles: &near,
        gripper: placed.arm.gripper(),
        arm: Some(&placed),
        settings: &GraspSettings::default(),
    };
    let (grasps, contacts) = (grasp_planner.plan(4).grasps, contact_surface(&scene, 4));
    let mut corners = [[-0.25, 0.2], [0.05, 0.2], [0.05, 0.38], [-0.25, 0.38]].map(Point2::from);
    let area = PlaceArea {
        name: "box".to_owned(),
        outline: ConvexPolygon::convex_hull_of(&mut corners),
        height_m: None,
    };
    let obstacles = Obstacles::within(&scene, &REGION);
    let planner = TransportPlanner {
        scene: &scene,
        obstacles: &obstacles,
        placed: &placed,
        seed: 1,
    };
    bencher.bench_local(|| planner.plan((4, &contacts), &grasps, &area));
}
