use super::*;
use crate::{HOME, N_JOINTS, test_joint_angles};
use nalgebra::{Translation3, UnitQuaternion, Vector3};
use proptest::prelude::*;

fn pose(position: [f64; 3], axis_angle: [f64; 3]) -> RigidTransform {
    RigidTransform::new(position.into(), axis_angle.into())
}

fn solve(target: &RigidTransform, near: &JointVector) -> Result<IkSolution, Error> {
    inverse_kinematics(&Arm::jaco_like(), target, near, &IkConfig::default())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn inverse_kinematics_inverts_forward_kinematics(joints in test_joint_angles(), near in test_joint_angles()) {
        let arm = Arm::jaco_like();
        let target = arm.tool_pose(&joints);
        let solution = solve(&target, &near).unwrap();
        prop_assert!(arm.chain().check(&solution.joints_rad).is_ok());
        let again = PoseResidual::between(&target, &arm.tool_pose(&solution.joints_rad));
        prop_assert!(again.distance_m < 1e-6 && again.angle_rad < 1e-6, "{again:?}");
        prop_assert_eq!(again, solution.residual);
        // The original angles are a solution, too: the result must not be worse.
        let rank = |to| (arm.is_self_colliding(to), arm.chain().travel_time_norm_s(&near, to) - 1e-6);
        let (touches, way_s) = rank(&solution.joints_rad);
        let (known_touches, known_way_s) = rank(&joints);
        prop_assert!(touches <= known_touches);
        prop_assert!((known_touches && !touches) || way_s <= known_way_s + 2e-6);
    }

    #[test]
    fn from_a_solution_the_same_solution_is_found(joints in test_joint_angles()) {
        let arm = Arm::jaco_like();
        let solution = solve(&arm.tool_pose(&joints), &joints).unwrap();
        let is_same = (solution.joints_rad - joints).amax() < 1e-5;
        prop_assert!(is_same || arm.is_self_colliding(&joints));
    }

    #[test]
    fn least_squares_never_increases_the_residual(
        joints in test_joint_angles(),
        away in proptest::array::uniform6(-0.15..0.15_f64),
    ) {
        let arm = Arm::jaco_like();
        let target = arm.tool_pose(&joints);
        let start = joints + JointVector::from(away);
        let end = solve_least_squares(arm.chain(), &target, &start, 200);
        // Close to a limit or a singularity the search may end in a local minimum, but never
        // farther away than it started.
        let began = PoseResidual::between(&target, &arm.tool_pose(&arm.chain().clamped(&start)));
        prop_assert!(end.residual.weighted_norm_m() <= began.weighted_norm_m() + 1e-12);
        prop_assert!(arm.chain().check(&end.joints_rad).is_ok());
    }

    #[test]
    fn residual_beyond_reach_is_at_least_the_missing_distance(
        direction in proptest::array::uniform3(-1.0..1.0_f64),
        turn in proptest::array::uniform3(-3.0..3.0_f64),
        missing in 0.01..3.0_f64,
    ) {
        let arm = Arm::jaco_like();
        let direction = Vector3::from(direction);
        prop_assume!(direction.norm() > 0.1);
        let shoulder = Vector3::new(0.0, 0.0, arm.dimensions().base_m);
        let position =
            shoulder + direction.normalize() * (arm.dimensions().reach_m() + missing);
        let target = pose(position.into(), turn);
        prop_assert!(!arm.can_reach(&target));
        match solve(&target, &JointVector::from(HOME)) {
            Err(Error::Unreachable { distance_m, n_iterations, .. }) => {
                prop_assert!(distance_m >= missing - 1e-9);
                prop_assert!(n_iterations <= 9 * IkConfig::default().max_iterations);
            }
            other => prop_assert!(false, "{:?}", other),
        }
    }

    #[test]
    fn every_configuration_reaches_the_pose(joints in test_joint_angles()) {
        let arm = Arm::jaco_like();
        let target = arm.tool_pose(&joints);
        let found: Vec<_> = arm.configurations(&target, &joints).unwrap().collect();
        prop_assert!(!found.is_empty() && found.len() <= 8);
        prop_assert!(arm.can_reach(&target));
        for configuration in &found {
            prop_assert!(arm.chain().check(configuration).is_ok());
            let residual = PoseResidual::between(&target, &arm.tool_pose(configuration));
            prop_assert!(residual.distance_m < 1e-6 && residual.angle_rad < 1e-6);
        }
    }
}

#[test]
fn least_squares_reaches_nearly_all_nearby_poses() {
    let arm = Arm::jaco_like();
    let config = IkConfig::default();
    let mut n_reached = 0;
    for i in 0..200 {
        // Additive recurrence: evenly spread over the middle of the limits.
        let share = |k: usize| (f64::from(i) * (0.37 + 0.113 * k as f64)).fract();
        let joints = JointVector::from_fn(|k, _| {
            let joint = &arm.chain().joints[k];
            joint.min_rad + (0.1 + 0.8 * share(k)) * (joint.max_rad - joint.min_rad)
        });
        let start = joints + JointVector::repeat(0.1);
        let end = solve_least_squares(arm.chain(), &arm.tool_pose(&joints), &start, 60);
        n_reached += usize::from(end.residual.is_within(&config));
    }
    assert!(n_reached >= 190, "{n_reached} of 200");
}

#[test]
fn a_pose_just_beyond_reach_is_met_within_tolerance() {
    let arm = Arm::jaco_like();
    let stretched = arm.tool_pose(&JointVector::zeros());
    let mut target = stretched;
    target.translation.z += 0.0005;
    assert!(
        !arm.configurations(&target, &JointVector::zeros())
            .unwrap()
            .any(|joints| {
                PoseResidual::between(&target, &arm.tool_pose(&joints)).distance_m < 1e-9
            })
    );
    assert!(solve(&target, &JointVector::from(HOME)).is_ok());
}

#[test]
fn a_pose_behind_the_joint_limits_is_unreachable() {
    // Directly below the mounting plate, with the hand pointing up at it.
    let target = pose([0.0, 0.0, -0.25], [0.0, 0.0, 0.0]);
    assert!(!Arm::jaco_like().can_reach(&target));
    let outcome = solve(&target, &JointVector::from(HOME));
    assert!(
        matches!(outcome, Err(Error::Unreachable { .. })),
        "{outcome:?}"
    );
}

#[test]
fn invalid_poses_are_rejected() {
    let near = JointVector::from(HOME);
    let unit = UnitQuaternion::identity();
    let nowhere = RigidTransform::from_parts(Translation3::new(f64::NAN, 0.0, 0.5), unit);
    let far = RigidTransform::from_parts(Translation3::new(f64::INFINITY, 0.0, 0.5), unit);
    let zero = UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(0.0, 0.0, 0.0, 0.0));
    let nan = UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(f64::NAN, 0.0, 0.0, 0.0));
    let place = Translation3::new(0.4, 0.0, 0.3);
    for target in [
        nowhere,
        far,
        RigidTransform::from_parts(place, zero),
        RigidTransform::from_parts(place, nan),
    ] {
        assert!(matches!(
            solve(&target, &near),
            Err(Error::BadNumber { .. })
        ));
        assert!(!Arm::jaco_like().can_reach(&target));
    }
}

#[test]
fn extreme_numbers_do_not_panic() {
    let near = JointVector::from([f64::NAN; N_JOINTS]);
    for distance in [1e-300, 1e30, 1e200, f64::MAX] {
        let target = pose([distance, -distance, distance], [0.0, 1.0, 0.0]);
        if let Ok(solution) = solve(&target, &near) {
            assert!(Arm::jaco_like().chain().check(&solution.joints_rad).is_ok());
        }
    }
}
