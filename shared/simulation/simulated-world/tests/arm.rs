//! Tests of the simulated arm among objects: motion, stops, grasps and failures.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a failing set-up must fail the test"
)]

use geometry::RigidTransform;
use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use simulated_world::{
    ArmCommand, ArmMount, ModelChoice, ModelLibrary, MotionState, ObjectPlacement, ObjectPlan,
    ObjectState, Scene, World,
};
use std::f64::consts::PI;

/// Step limit for an arm command.
const MOST_STEPS: usize = 3000;
/// Distance of the fingertips ahead of the tool's origin, metres.
const TIP_M: f64 = 0.025;

fn world(objects: Vec<ObjectPlan>) -> World {
    world_with(objects, ArmMount::default(), 0)
}

fn world_with(objects: Vec<ObjectPlan>, arm: ArmMount, seed: u64) -> World {
    let scene = Scene {
        seed,
        objects,
        arm: Some(arm),
        ..Scene::default()
    };
    World::new(scene, ModelLibrary::generated()).unwrap()
}

/// Arm whose fingers press with a force, newtons.
fn arm_with_force(closing_force_n: f64) -> ArmMount {
    let mut arm = ArmMount::default();
    arm.gripper.closing_force_n = closing_force_n;
    arm
}

/// World in which the fingers hold a cube, turned against them, and the pose over it.
fn grasp_cube(arm: ArmMount, offset_rad: f64, seed: u64) -> (World, RigidTransform) {
    let (spot, yaw_rad) = reachable(0.05);
    let cube = upright("puzzle-cube", spot, yaw_rad + offset_rad);
    let mut world = world_with(vec![cube], arm, seed);
    let low = 0.6 * world.find(1).unwrap().model.half_sides_m.z;
    reach_down(&mut world, spot, yaw_rad, low).unwrap();
    let above = downward(Point3::new(spot[0], spot[1], height(&world, 0.15)), yaw_rad);
    carry_out(&mut world, &ArmCommand::Close).unwrap();
    assert_eq!(world.arm_status().unwrap().holds, Some(1));
    (world, above)
}

fn upright(category: &str, position_m: [f64; 2], yaw_rad: f64) -> ObjectPlan {
    ObjectPlan {
        model: ModelChoice::Generated {
            category: category.to_owned(),
            instance: 1,
        },
        placement: ObjectPlacement::Upright {
            position_m,
            yaw_rad,
            raised_m: 0.0,
        },
    }
}

/// Gripper pose with the fingers down, closing along a direction at `yaw_rad` from world x.
fn downward(at: Point3<f64>, yaw_rad: f64) -> RigidTransform {
    let turned = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw_rad);
    let down = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI);
    RigidTransform::from_parts(Translation3::from(at.coords), turned * down)
}

fn move_to(world_from_gripper: RigidTransform) -> ArmCommand {
    ArmCommand::MoveTo {
        world_from_gripper,
        is_straight: false,
    }
}

fn straight_to(world_from_gripper: RigidTransform) -> ArmCommand {
    ArmCommand::MoveTo {
        world_from_gripper,
        is_straight: true,
    }
}

/// Gives a command and steps until the arm is still; returns its failure.
fn carry_out(world: &mut World, command: &ArmCommand) -> Result<(), String> {
    world.command_arm(command)?;
    for _ in 0..MOST_STEPS {
        world.step();
        let status = world.arm_status().unwrap();
        let is_busy = matches!(
            status.motion,
            MotionState::Moving | MotionState::Closing | MotionState::Opening
        );
        let is_still = !is_busy && status.joint_velocities_rad_s == [0.0; 6];
        if is_still {
            return status.failure.map_or(Ok(()), Err);
        }
    }
    panic!("the arm does not come to rest: {:?}", world.arm_status());
}

fn angles(world: &World) -> [f64; 6] {
    world.arm_status().unwrap().joint_angles_rad
}

/// World z of a gripper whose fingertips are `tips_m` above the table.
fn height(world: &World, tips_m: f64) -> f64 {
    world.scene().table.height_m + tips_m + TIP_M
}

/// Position and yaw at which the arm reaches down to the table and up again, with the same space
/// `aside_m` further along y.
fn reachable(aside_m: f64) -> ([f64; 2], f64) {
    let empty = world(Vec::new());
    let lines = |x: f64, y: f64, yaw_rad: f64| {
        let mut trial = empty.clone();
        let at = |tips_m, y| downward(Point3::new(x, y, height(&empty, tips_m)), yaw_rad);
        carry_out(&mut trial, &move_to(at(0.15, y)))?;
        carry_out(&mut trial, &straight_to(at(0.01, y)))?;
        carry_out(&mut trial, &straight_to(at(0.15, y)))?;
        carry_out(&mut trial, &straight_to(at(0.15, y + aside_m)))?;
        carry_out(&mut trial, &straight_to(at(0.01, y + aside_m)))
    };
    let grid = (0..5).flat_map(|i| (0..4).map(move |k| (i, k)));
    grid.flat_map(|(i, k)| [0.0, 0.8, 1.6, 2.4].map(|yaw_rad| (i, k, yaw_rad)))
        .map(|(i, k, yaw_rad)| {
            let (x, y) = (-0.1 - 0.08 * f64::from(i), -0.1 - 0.06 * f64::from(k));
            (x, y, yaw_rad)
        })
        .find(|&(x, y, yaw_rad)| lines(x, y, yaw_rad).is_ok())
        .map(|(x, y, yaw_rad)| ([x, y], yaw_rad))
        .expect("the arm reaches the table somewhere")
}

/// Depth of the arm below the table top, metres.
fn depth_m(world: &World) -> f64 {
    let table = world.scene().table;
    let [half_x, half_y] = table.size_m.map(|side| side / 2.0);
    let below = |p: Point3<f64>, radius_m: f64| {
        let is_over = p.x.abs() < half_x && p.y.abs() < half_y;
        let bottom = p.z - radius_m;
        if is_over {
            table.height_m - bottom
        } else {
            -1.0
        }
    };
    let capsules = world.arm_capsules();
    // The base and the shoulder stand next to the table.
    let ends = capsules.iter().skip(2);
    ends.flat_map(|c| [below(c.from, c.radius_m), below(c.to, c.radius_m)])
        .fold(-1.0, f64::max)
}

#[test]
fn arm_command_without_an_arm_is_rejected() {
    let mut world = World::new(Scene::default(), ModelLibrary::generated()).unwrap();
    let refused = world.command_arm(&ArmCommand::Home).unwrap_err();
    assert!(refused.contains("no arm"), "{refused}");
    assert_eq!(world.arm_status(), None);
    assert!(world.arm_capsules().is_empty());
}

#[test]
fn arm_moves_to_joint_angles_and_back_home() {
    let mut world = world(Vec::new());
    let home = angles(&world);
    let mut goal = home;
    goal[0] += 0.6;
    goal[5] -= 0.9;
    carry_out(&mut world, &ArmCommand::MoveJoints(goal)).unwrap();
    for (angle, goal) in angles(&world).iter().zip(goal) {
        assert!((angle - goal).abs() < 1e-6);
    }
    carry_out(&mut world, &ArmCommand::Home).unwrap();
    for (angle, home) in angles(&world).iter().zip(home) {
        assert!((angle - home).abs() < 1e-6);
    }
}

#[test]
fn arm_moves_the_gripper_to_the_commanded_pose() {
    let ([x, y], yaw_rad) = reachable(0.05);
    let mut world = world(Vec::new());
    let goal = downward(Point3::new(x, y, height(&world, 0.15)), yaw_rad);
    carry_out(&mut world, &move_to(goal)).unwrap();
    let reached = world.arm_status().unwrap().world_from_gripper;
    let miss = goal.inv_mul(&reached);
    assert!(miss.translation.vector.norm() < 0.001, "{miss}");
    assert!(miss.rotation.angle() < 0.01, "{miss}");
}

#[test]
fn arm_stop_brakes_the_joints_from_the_next_step_on() {
    let mut world = world(Vec::new());
    let mut goal = angles(&world);
    goal[0] += 1.5;
    world.command_arm(&ArmCommand::MoveJoints(goal)).unwrap();
    for _ in 0..40 {
        world.step();
    }
    let moving = world.arm_status().unwrap();
    assert_eq!(moving.motion, MotionState::Moving);
    assert!(moving.joint_velocities_rad_s[0].abs() > 0.05);
    world.command_arm(&ArmCommand::Stop).unwrap();
    let mut speed_rad_s = moving.joint_velocities_rad_s[0].abs();
    for _ in 0..60 {
        world.step();
        let status = world.arm_status().unwrap();
        assert_eq!(status.motion, MotionState::Stopped);
        let now_rad_s = status.joint_velocities_rad_s[0].abs();
        assert!(now_rad_s < speed_rad_s || now_rad_s == 0.0);
        speed_rad_s = now_rad_s;
    }
    let status = world.arm_status().unwrap();
    assert_eq!(status.joint_velocities_rad_s, [0.0; 6]);
    assert_ne!(status.motion, MotionState::Moving);
}

#[test]
fn arm_rejects_an_unreachable_pose_with_its_distance() {
    let mut world = world(Vec::new());
    let before = angles(&world);
    let far = downward(Point3::new(1.5, 1.0, 0.9), 0.0);
    let message = carry_out(&mut world, &move_to(far)).unwrap_err();
    assert!(
        message.contains(" m") && message.contains(|c: char| c.is_ascii_digit()),
        "{message}"
    );
    assert_eq!(angles(&world), before);
    let mut bad = far;
    bad.translation.x = f64::NAN;
    assert!(carry_out(&mut world, &move_to(bad)).is_err());
    assert!(carry_out(&mut world, &ArmCommand::MoveJoints([f64::NAN; 6])).is_err());
    assert!(carry_out(&mut world, &ArmCommand::MoveJoints([1e3; 6])).is_err());
    assert_eq!(angles(&world), before);
}

#[test]
fn arm_stops_before_the_table() {
    let ([x, y], yaw_rad) = reachable(0.05);
    let mut world = world(Vec::new());
    let at = |world: &World, tips_m| downward(Point3::new(x, y, height(world, tips_m)), yaw_rad);
    let above = at(&world, 0.15);
    carry_out(&mut world, &move_to(above)).unwrap();
    let below = at(&world, -0.06);
    for command in [straight_to(below), move_to(below)] {
        let message = carry_out(&mut world, &command).unwrap_err();
        assert!(message.contains("table"), "{message}");
        let tips_m = world.arm_status().unwrap().world_from_gripper.translation.z
            - TIP_M
            - world.scene().table.height_m;
        assert!(
            tips_m > -0.001,
            "the fingertips are {tips_m} m over the table"
        );
        assert!(depth_m(&world) < 0.02, "{}", depth_m(&world));
    }
    // It is not stuck.
    carry_out(&mut world, &straight_to(above)).unwrap();
}

/// Position of the middle of an object, world frame.
fn position(world: &World, id: u16) -> Point3<f64> {
    let object = world.find(id).unwrap();
    object.world_from_object.translation.vector.into()
}

#[test]
fn grasp_lifts_carries_and_puts_down_a_box() {
    let aside_m = 0.10;
    let ([x, y], yaw_rad) = reachable(aside_m);
    let mut world = world(vec![upright("puzzle-cube", [x, y], yaw_rad)]);
    let start = position(&world, 1);
    let side_m = 2.0 * world.find(1).unwrap().model.half_sides_m.z;
    let low = 0.3 * side_m;
    let at = |world: &World, tips_m, y| {
        downward(Point3::new(start.x, y, height(world, tips_m)), yaw_rad)
    };
    let (above, down) = (at(&world, 0.15, start.y), at(&world, low, start.y));
    carry_out(&mut world, &ArmCommand::Open).unwrap();
    carry_out(&mut world, &move_to(above)).unwrap();
    carry_out(&mut world, &straight_to(down)).unwrap();
    carry_out(&mut world, &ArmCommand::Close).unwrap();
    let status = world.arm_status().unwrap();
    assert_eq!(status.holds, Some(1));
    assert_eq!(world.find(1).unwrap().state, ObjectState::HeldByArm);
    let held_at = position(&world, 1);
    carry_out(&mut world, &straight_to(above)).unwrap();
    world.step();
    let risen = above.translation.z - down.translation.z;
    assert!((position(&world, 1).z - held_at.z - risen).abs() < 0.005);
    let (aside, lowered) = (
        at(&world, 0.15, start.y + aside_m),
        at(&world, low + 0.002, start.y + aside_m),
    );
    carry_out(&mut world, &straight_to(aside)).unwrap();
    carry_out(&mut world, &straight_to(lowered)).unwrap();
    carry_out(&mut world, &ArmCommand::Open).unwrap();
    assert_eq!(world.arm_status().unwrap().holds, None);
    for _ in 0..120 {
        world.step();
    }
    let end = position(&world, 1);
    assert_eq!(world.find(1).unwrap().state, ObjectState::Settled);
    assert!((end.y - held_at.y - aside_m).abs() < 0.01, "{end}");
    assert!((end.x - held_at.x).abs() < 0.01, "{end}");
    assert!((end.z - start.z).abs() < 0.004, "{end}");
}

/// Lowers the open fingers at a position, tips `tips_m` above the table.
fn reach_down(
    world: &mut World,
    [x, y]: [f64; 2],
    yaw_rad: f64,
    tips_m: f64,
) -> Result<(), String> {
    let at = |world: &World, tips_m| downward(Point3::new(x, y, height(world, tips_m)), yaw_rad);
    let (above, down) = (at(world, 0.15), at(world, tips_m));
    carry_out(world, &ArmCommand::Open)?;
    carry_out(world, &move_to(above))?;
    carry_out(world, &straight_to(down))
}

#[test]
fn object_that_is_too_heavy_for_the_friction_slides_out() {
    let weight_n = 9.81
        * world(vec![upright("puzzle-cube", [0.0, 0.0], 0.0)]).objects()[0]
            .model
            .mass_kg;
    let mut outcomes = Vec::new();
    for share in [0.8, 1.5] {
        // Two pads hold twice the friction of one.
        let friction = world(Vec::new()).pad_friction().unwrap();
        let force_n = share * weight_n / (2.0 * friction);
        let (mut world, above) = grasp_cube(arm_with_force(force_n), 0.0, 0);
        let lifted = carry_out(&mut world, &straight_to(above));
        outcomes.push((lifted, world.arm_status().unwrap().holds));
    }
    let (lifted, holds) = &outcomes[0];
    let message = lifted.as_ref().unwrap_err();
    assert!(message.contains("slipped out"), "{message}");
    assert_eq!(*holds, None);
    assert_eq!(outcomes[1], (Ok(()), Some(1)));
}

#[test]
fn object_turns_between_the_fingers_as_they_close() {
    let (world, _) = grasp_cube(ArmMount::default(), 0.35, 0);
    let closing = world.arm_status().unwrap().world_from_gripper.rotation * Vector3::x();
    let side = world.find(1).unwrap().world_from_object.rotation.inverse() * closing;
    // One side of the cube lies along the closing direction now, within the friction cone.
    let aligned = side.abs().max();
    assert!(0.35_f64.cos() < 0.95 && aligned > 0.98, "{side}");
}

#[test]
fn object_held_beside_its_middle_hangs_down_when_the_pads_press_little() {
    let tilt_rad = |force_n: f64| {
        let (spot, _) = reachable(0.05);
        let mut world = world_with(
            vec![upright("hammer", spot, 0.0)],
            arm_with_force(force_n),
            0,
        );
        let hammer = world.find(1).unwrap();
        let long = hammer.model.half_sides_m.imax();
        let along = hammer.world_from_object.rotation * Vector3::ith(long, 1.0);
        let side = hammer.model.half_sides_m[long];
        let start = hammer.world_from_object;
        let handle = start * Point3::from(Vector3::ith(long, -0.5 * side));
        let across_rad = along.y.atan2(along.x) + PI / 2.0;
        reach_down(&mut world, [handle.x, handle.y], across_rad, 0.008).unwrap();
        carry_out(&mut world, &ArmCommand::Close).unwrap();
        let up = downward(
            Point3::new(handle.x, handle.y, height(&world, 0.3)),
            across_rad,
        );
        carry_out(&mut world, &straight_to(up)).unwrap();
        for _ in 0..240 {
            world.step();
        }
        assert_eq!(world.arm_status().unwrap().holds, Some(1));
        let now = world.find(1).unwrap().world_from_object.rotation * Vector3::ith(long, 1.0);
        now.z.abs().asin()
    };
    assert!(tilt_rad(200.0) < 0.1, "{}", tilt_rad(200.0));
    assert!(tilt_rad(8.0) > 0.6, "{}", tilt_rad(8.0));
}

#[test]
fn friction_of_the_pads_is_drawn_by_the_seed() {
    let drawn: Vec<f64> = (0..40)
        .map(|seed| {
            world_with(Vec::new(), ArmMount::default(), seed)
                .pad_friction()
                .unwrap()
        })
        .collect();
    assert!(drawn.iter().all(|friction| (0.4..=0.8).contains(friction)));
    let (low, high) = drawn.iter().fold((1.0_f64, 0.0_f64), |(low, high), f| {
        (low.min(*f), high.max(*f))
    });
    assert!(low < 0.45 && high > 0.75, "{low} {high}");
}

#[test]
fn grasp_of_nothing_is_reported() {
    let (spot, yaw_rad) = reachable(0.05);
    let mut world = world(Vec::new());
    reach_down(&mut world, spot, yaw_rad, 0.02).unwrap();
    let message = carry_out(&mut world, &ArmCommand::Close).unwrap_err();
    assert!(message.contains("closed on nothing"), "{message}");
    assert_eq!(world.arm_status().unwrap().holds, None);
}

#[test]
fn grasp_beside_the_pads_does_not_hold() {
    let (spot, yaw_rad) = reachable(0.05);
    let mut world = world(vec![upright("puzzle-cube", spot, yaw_rad)]);
    let top_m = 2.0 * world.find(1).unwrap().model.half_sides_m.z;
    reach_down(&mut world, spot, yaw_rad, top_m - 0.006).unwrap();
    let message = carry_out(&mut world, &ArmCommand::Close).unwrap_err();
    assert!(message.contains("beside their pads"), "{message}");
    assert_eq!(world.arm_status().unwrap().holds, None);
    assert_eq!(world.find(1).unwrap().state, ObjectState::Settled);
}

#[test]
fn collision_stop_before_an_object_wider_than_the_stroke() {
    let (spot, yaw_rad) = reachable(0.05);
    // 0.17 m and more across, along the closing direction of the fingers.
    let mut world = world(vec![upright("cereal-box", spot, yaw_rad)]);
    let top_m = 2.0 * world.find(1).unwrap().model.half_sides_m.z;
    let [x, y] = spot;
    let at = |world: &World, tips_m| downward(Point3::new(x, y, height(world, tips_m)), yaw_rad);
    let (above, down) = (at(&world, top_m + 0.05), at(&world, top_m - 0.08));
    carry_out(&mut world, &ArmCommand::Open).unwrap();
    carry_out(&mut world, &move_to(above)).unwrap();
    let message = carry_out(&mut world, &straight_to(down)).unwrap_err();
    assert!(message.contains("presses on an object"), "{message}");
    assert_eq!(world.arm_status().unwrap().holds, None);
}

#[test]
fn collision_stop_keeps_a_held_object_above_the_table() {
    let (spot, yaw_rad) = reachable(0.05);
    let mut world = world(vec![upright("puzzle-cube", spot, yaw_rad)]);
    let side_m = 2.0 * world.find(1).unwrap().model.half_sides_m.z;
    reach_down(&mut world, spot, yaw_rad, 0.6 * side_m).unwrap();
    carry_out(&mut world, &ArmCommand::Close).unwrap();
    let [x, y] = spot;
    let at = |world: &World, tips_m| downward(Point3::new(x, y, height(world, tips_m)), yaw_rad);
    let (above, low) = (at(&world, 0.15), at(&world, 0.2 * side_m));
    carry_out(&mut world, &straight_to(above)).unwrap();
    let message = carry_out(&mut world, &straight_to(low)).unwrap_err();
    assert!(message.contains("would have come against"), "{message}");
    let table_m = world.scene().table.height_m;
    assert!(position(&world, 1).z > table_m + 0.5 * side_m - 0.005);
}
