//! Grasps of solids whose right answer is known.

mod solid_scene;

use arm_kinematics::{Arm, GripperModel, HOME, JointVector};
use geometry::{Capsule, RigidTransform};
use grasping::{
    ApproachKind, Grasp, GraspPlan, GraspPlanner, GraspScene, GraspSettings, Obstacle, Obstacles,
    PlacedArm, Rejection, hand_boxes,
};
use nalgebra::{Point3, Vector3};
use solid_scene::{Solid, SolidScene};

fn cuboid(x: f64, y: f64, sides_m: [f64; 3], turn_rad: f64) -> Solid {
    let middle = Point3::new(x, y, sides_m[2] / 2.0);
    Solid::Box(middle, Vector3::from(sides_m) / 2.0, turn_rad)
}

fn plan_with(scene: &GraspScene<'_>, object: usize, arm: Option<&PlacedArm>) -> GraspPlan {
    let obstacles = Obstacles::of(scene);
    let planner = GraspPlanner {
        scene,
        obstacles: &obstacles,
        gripper: &GripperModel::JACO_LIKE,
        arm,
        settings: &GraspSettings::default(),
    };
    planner.plan(object)
}

fn plan(solids: &[Solid]) -> GraspPlan {
    plan_with(&SolidScene::new(solids).grasp_scene(), 0, None)
}

fn closing(grasp: &Grasp) -> Vector3<f64> {
    grasp.plan_from_tool.rotation * Vector3::x()
}

fn place(grasp: &Grasp) -> Point3<f64> {
    grasp.plan_from_tool.translation.vector.into()
}

#[test]
fn a_box_is_grasped_on_parallel_faces_also_where_they_are_hidden() {
    for turn_rad in [0.0, 0.4, 0.8] {
        let plan = plan(&[cuboid(0.02, 0.03, [0.05, 0.11, 0.09], turn_rad)]);
        let best = &plan.grasps[0];
        let narrow = Vector3::new(turn_rad.cos(), turn_rad.sin(), 0.0);
        let is_narrow = closing(best).dot(&narrow).abs() > 0.7;
        let (across, side_m) = if is_narrow {
            (narrow, 0.05)
        } else {
            (Vector3::z().cross(&narrow), 0.11)
        };
        let aligned = closing(best).dot(&across).abs();
        assert!(aligned > 0.95, "{turn_rad}: {best:?}");
        assert!(
            (best.width_m - side_m).abs() < 0.008,
            "{turn_rad}: {best:?}"
        );
        assert!((best.opening_m - best.width_m) > 0.007, "{best:?}");
        let off = place(best) - Point3::new(0.02, 0.03, 0.0);
        assert!(
            off.dot(&across).abs() < 0.008,
            "centred: {turn_rad} {best:?}"
        );
    }
}

#[test]
fn a_ball_is_grasped_at_its_widest_place() {
    let plan = plan(&[Solid::Ball(Point3::new(0.0, 0.0, 0.036), 0.036)]);
    let best = &plan.grasps[0];
    assert!((best.width_m - 0.072).abs() < 0.006, "{best:?}");
    let off = place(best) - Point3::new(0.0, 0.0, 0.036);
    assert!(off.norm() < 0.012, "{best:?}");
}

#[test]
fn a_wide_tube_is_grasped_at_its_rim() {
    let plan = plan(&[Solid::Tube(Point3::new(0.0, 0.05, 0.0), 0.10, 0.005, 0.07)]);
    let best = &plan.grasps[0];
    assert!(best.width_m < 0.02, "{best:?}");
    let off = place(best).xy() - nalgebra::Point2::new(0.0, 0.05);
    assert!((off.norm() - 0.0975).abs() < 0.01, "{best:?}");
    assert_ne!(best.kind(), ApproachKind::Side);
}

#[test]
fn a_flat_thing_is_grasped_along_its_long_sides_with_the_fingers_over_the_table() {
    let plan = plan(&[cuboid(0.0, 0.0, [0.16, 0.02, 0.012], 0.3)]);
    let best = &plan.grasps[0];
    assert!((best.width_m - 0.02).abs() < 0.006, "{best:?}");
    let across = Vector3::new(-0.3_f64.sin(), 0.3_f64.cos(), 0.0);
    assert!(closing(best).dot(&across).abs() > 0.95, "{best:?}");
    for grasp in &plan.grasps {
        for body in hand_boxes(&GripperModel::JACO_LIKE, grasp.opening_m) {
            let body = body.transformed(&grasp.plan_from_tool);
            let down = body.frame_from_box.rotation.inverse() * Vector3::z();
            let lowest_m = body.centre().z - down.abs().dot(&body.half_sides_m);
            assert!(lowest_m > 0.0029, "{lowest_m} {grasp:?}");
        }
    }
}

#[test]
fn no_grasp_is_a_sentence_with_the_reasons() {
    let scene = SolidScene::new(&[cuboid(0.0, 0.0, [0.22, 0.20, 0.06], 0.2)]);
    let scene = scene.grasp_scene();
    let plan = plan_with(&scene, 0, None);
    assert!(plan.grasps.is_empty(), "{:?}", plan.grasps);
    let sentence = plan.why_none(&scene, 1).unwrap();
    assert!(sentence.contains("track 1"), "{sentence}");
    assert!(sentence.contains("too wide"), "{sentence}");
}

#[test]
fn neighbours_are_not_hit_and_one_on_top_forbids_the_lift() {
    let tall = [0.05, 0.05, 0.12];
    let walls = [
        cuboid(0.0, 0.0, tall, 0.0),
        cuboid(0.045, 0.0, [0.03, 0.20, 0.14], 0.0),
        cuboid(-0.045, 0.0, [0.03, 0.20, 0.14], 0.0),
    ];
    let scene = SolidScene::new(&walls);
    let scene = scene.grasp_scene();
    let plan = plan_with(&scene, 0, None);
    for grasp in &plan.grasps {
        assert!(closing(grasp).x.abs() < 0.5, "between the walls: {grasp:?}");
    }
    let is_hit = |object| {
        let rejected = plan.rejected.iter();
        let what = Obstacle::Object(object);
        rejected
            .filter_map(|one| match one.reason {
                Rejection::Hits { what, .. } => Some(what),
                _ => None,
            })
            .any(|hit| hit == what)
    };
    assert!(is_hit(1) && is_hit(2));
    // A lid on the box.
    let lid = Solid::Box(
        Point3::new(0.0, 0.0, 0.13),
        Vector3::new(0.02, 0.02, 0.01),
        0.0,
    );
    let scene = SolidScene::new(&[cuboid(0.0, 0.0, tall, 0.0), lid]);
    let scene = scene.grasp_scene();
    let plan = plan_with(&scene, 0, None);
    assert!(plan.grasps.is_empty());
    let sentence = plan.why_none(&scene, 1).unwrap();
    assert!(sentence.contains("track 2 lies on it"), "{sentence}");
}

#[test]
fn a_person_beside_the_object_is_not_hit() {
    let rendered = SolidScene::new(&[cuboid(0.0, 0.0, [0.05, 0.09, 0.08], 0.0)]);
    let mut scene = rendered.grasp_scene();
    let n_free = plan_with(&scene, 0, None).grasps.len();
    assert!(n_free > 0);
    // An arm that reaches over the object.
    scene.people.push(Capsule {
        from: Point3::new(-0.4, 0.0, 0.16),
        to: Point3::new(0.4, 0.0, 0.16),
        radius_m: 0.05,
    });
    let plan = plan_with(&scene, 0, None);
    let hits_person = plan.rejected.iter().filter(|one| {
        matches!(
            one.reason,
            Rejection::Hits {
                what: Obstacle::Person,
                ..
            }
        )
    });
    assert!(hits_person.count() > 0);
    for grasp in &plan.grasps {
        assert_ne!(grasp.kind(), ApproachKind::Above, "{grasp:?}");
    }
}

#[test]
fn joint_angles_lead_straight_to_the_grasp_and_far_objects_are_out_of_reach() {
    let arm = |x: f64| PlacedArm {
        arm: Arm::jaco_like(),
        plan_from_base: RigidTransform::translation(x, 0.1, 0.0),
        joints_rad: JointVector::from(HOME),
    };
    let scene = SolidScene::new(&[cuboid(0.0, 0.0, [0.05, 0.09, 0.08], 0.0)]);
    let scene = scene.grasp_scene();
    let near = arm(-0.6);
    let plan = plan_with(&scene, 0, Some(&near));
    for grasp in &plan.grasps {
        let joints = grasp.joints.unwrap();
        let reached = near.plan_from_base * near.arm.tool_pose(&joints.grasp_rad);
        let missed = reached.translation.vector - grasp.plan_from_tool.translation.vector;
        assert!(missed.norm() < 1e-3, "{grasp:?}");
        let lifted = near.plan_from_base * near.arm.tool_pose(&joints.lift_rad);
        let risen_m = lifted.translation.z - reached.translation.z;
        assert!((risen_m - grasp.lift_m).abs() < 1e-3);
    }
    assert!(!plan.grasps.is_empty());
    let plan = plan_with(&scene, 0, Some(&arm(-1.6)));
    assert!(plan.grasps.is_empty());
    let sentence = plan.why_none(&scene, 1).unwrap();
    assert!(sentence.contains("out of the arm's reach"), "{sentence}");
}

#[test]
fn the_same_scene_has_the_same_plan() {
    let solids = [
        cuboid(0.0, 0.0, [0.05, 0.09, 0.08], 0.5),
        cuboid(0.15, 0.05, [0.06; 3], 0.1),
    ];
    assert_eq!(plan(&solids), plan(&solids));
}
