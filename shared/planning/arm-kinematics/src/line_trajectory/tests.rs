use super::*;
use crate::{HOME, PoseResidual, inverse_kinematics};
use nalgebra::{Point3, Vector3};
use proptest::prelude::*;
use std::f64::consts::PI;

/// Tool pose with the hand straight down.
fn downward(position: [f64; 3], turn_rad: f64) -> RigidTransform {
    RigidTransform::from_parts(
        position.into(),
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn_rad)
            * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI),
    )
}

fn joints_at(arm: &Arm, pose: &RigidTransform) -> JointVector {
    let home = JointVector::from(HOME);
    inverse_kinematics(arm, pose, &home, &IkConfig::default())
        .unwrap()
        .joints_rad
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn the_tool_keeps_to_the_line_and_the_joints_to_their_limits(
        x in 0.30..0.50_f64,
        y in -0.25..0.25_f64,
        turn in -0.5..0.5_f64,
        shift in proptest::array::uniform3(-0.08..0.08_f64),
        speed in 0.1..1.0_f64,
    ) {
        let arm = Arm::jaco_like();
        let from = downward([x, y, 0.15], turn);
        let to = downward([x + shift[0], y + shift[1], 0.15 + shift[2]], turn);
        let start = joints_at(&arm, &from);
        let line = LineTrajectory::plan(&arm, &start, &to, speed).unwrap();
        let dt = line.duration_s() / 400.0;
        let mut before = line.sample(0.0);
        prop_assert_eq!(before, JointState::at_rest(start));
        let way = geometry::Capsule {
            from: from.translation.vector.into(),
            to: to.translation.vector.into(),
            radius_m: 0.0,
        };
        for k in 1..=400 {
            let now = line.sample(dt * f64::from(k));
            let tool = arm.tool_pose(&now.angles_rad);
            prop_assert!(way.distance_m(&Point3::from(tool.translation.vector)) < 5e-4);
            prop_assert!(PoseResidual::between(&tool, &from).angle_rad < 5e-3);
            for (i, joint) in arm.chain().joints.iter().enumerate() {
                let (v0, v1) = (before.velocities_rad_s[i], now.velocities_rad_s[i]);
                prop_assert!(v1.abs() <= speed * joint.max_velocity_rad_s + 1e-9);
                prop_assert!((v1 - v0).abs() <= joint.max_acceleration_rad_s2 * dt + 1e-9);
                let moved = now.angles_rad[i] - before.angles_rad[i];
                let bound = joint.max_acceleration_rad_s2 * dt * dt + 1e-9;
                prop_assert!((moved - 0.5 * (v0 + v1) * dt).abs() <= bound);
            }
            before = now;
        }
        let end = line.sample(line.duration_s());
        prop_assert!(end.is_at_rest());
        let missed = PoseResidual::between(&to, &arm.tool_pose(&end.angles_rad));
        prop_assert!(missed.distance_m < 1e-5 && missed.angle_rad < 1e-4);
    }
}

#[test]
fn line_out_of_reach_reports_the_reachable_length() {
    let arm = Arm::jaco_like();
    let start = joints_at(&arm, &downward([0.45, 0.0, 0.15], 0.0));
    let outcome = LineTrajectory::plan(&arm, &start, &downward([1.45, 0.0, 0.15], 0.0), 1.0);
    let Err(Error::LineLeavesWorkspace {
        reached_m,
        length_m,
    }) = outcome
    else {
        panic!("{outcome:?}");
    };
    assert!((length_m - 1.0).abs() < 1e-6);
    // Stretched downwards: wrist 0.393 over the line, 0.69 from the shoulder.
    assert!(reached_m > 0.1 && reached_m < 0.35, "{reached_m}");
}

#[test]
fn line_through_the_shoulder_singularity_keeps_velocity_limits() {
    let arm = Arm::jaco_like();
    let start = joints_at(&arm, &downward([0.25, 0.03, 0.45], 0.0));
    match LineTrajectory::plan(&arm, &start, &downward([-0.25, 0.03, 0.45], 0.0), 1.0) {
        Ok(line) => {
            for k in 0..=2000 {
                let state = line.sample(f64::from(k) / 2000.0 * line.duration_s());
                for (i, joint) in arm.chain().joints.iter().enumerate() {
                    assert!(state.velocities_rad_s[i].abs() <= joint.max_velocity_rad_s + 1e-9);
                }
            }
        }
        Err(error) => assert!(matches!(
            error,
            Error::LineJumps { .. } | Error::LineLeavesWorkspace { .. }
        )),
    }
}

#[test]
fn bend_of_the_joint_path_keeps_acceleration_limits() {
    let arm = Arm::jaco_like();
    // Joint 1 stands still, then turns; joint 2 turns back.
    let knots: Vec<_> = (0..40)
        .map(|k| 0.02 * f64::from(k))
        .map(|u| JointVector::from([(u - 0.4).max(0.0), -(u - 0.4).abs(), 0.0, 0.0, 0.0, 0.0]))
        .collect();
    let (velocity, acceleration) = path_limits(&arm, &knots, 1.0);
    let end = (knots.len() - 1) as f64;
    let profile = TrapezoidalProfile::fastest(0.0, 0.0, end, velocity, acceleration);
    let line = LineTrajectory { knots, profile };
    let dt = line.duration_s() / 4000.0;
    let mut before = line.sample(0.0).velocities_rad_s;
    for k in 1..=4000 {
        let now = line.sample(dt * f64::from(k)).velocities_rad_s;
        for (i, joint) in arm.chain().joints.iter().enumerate() {
            let change = (now[i] - before[i]).abs();
            assert!(
                change <= joint.max_acceleration_rad_s2 * dt + 1e-9,
                "joint {i}: {change}"
            );
        }
        before = now;
    }
}

#[test]
fn a_line_of_no_length_ends_where_it_begins() {
    let arm = Arm::jaco_like();
    let start = JointVector::from(HOME);
    let line = LineTrajectory::plan(&arm, &start, &arm.tool_pose(&start), 1.0).unwrap();
    let end = line.sample(line.duration_s());
    assert!((end.angles_rad - start).amax() < 1e-6 && end.is_at_rest());
}

#[test]
fn invalid_lines_are_rejected() {
    let arm = Arm::jaco_like();
    let start = JointVector::from(HOME);
    for x in [1e3, 1e200, f64::MAX] {
        let outcome = LineTrajectory::plan(&arm, &start, &downward([x, 0.0, 0.2], 0.0), 1.0);
        assert!(matches!(outcome, Err(Error::LineLeavesWorkspace { .. })));
    }
    let outcome = LineTrajectory::plan(&arm, &start, &downward([f64::NAN, 0.0, 0.2], 0.0), 1.0);
    assert!(matches!(outcome, Err(Error::BadNumber { .. })));
}
