use super::*;
use crate::{HOME, PoseResidual, test_joint_angles};
use geometry::RigidTransform;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use proptest::prelude::*;
use std::f64::consts::PI;

const DT_S: f64 = 0.01;

/// Limit of steps within which every command must have ended.
const MAX_STEPS: usize = 10_000;

fn arm_at_home() -> ArmController {
    ArmController::new(Arm::jaco_like(), JointVector::from(HOME)).unwrap()
}

fn downward(x: f64, y: f64, z: f64) -> RigidTransform {
    RigidTransform::from_parts(
        [x, y, z].into(),
        UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI),
    )
}

fn move_to(base_from_tool: RigidTransform, path: PathKind) -> Command {
    Command::MoveTo {
        base_from_tool,
        path,
        speed: 1.0,
    }
}

/// Steps the controller until a command is final.
fn carry_out(motion: &mut ArmController, id: u64, contact: FingerContact) -> CommandState {
    for _ in 0..MAX_STEPS {
        let state = motion.command_state(id).unwrap();
        if state.is_final() {
            return state;
        }
        motion.step(DT_S, contact);
    }
    panic!("command {id} did not end: {:?}", motion.command_state(id));
}

/// Steps the controller once and checks the velocity and acceleration limits of all joints.
fn step_smoothly(motion: &mut ArmController) {
    let before = *motion.joints();
    motion.step(DT_S, FingerContact::Free);
    let after = motion.joints();
    for (i, joint) in motion.arm().chain().joints.iter().enumerate() {
        let (v0, v1) = (before.velocities_rad_s[i], after.velocities_rad_s[i]);
        let a = joint.max_acceleration_rad_s2;
        assert!(v1.abs() <= joint.max_velocity_rad_s + 1e-9);
        assert!(
            (v1 - v0).abs() <= a * DT_S + 1e-9,
            "joint {i}: {v0} to {v1}"
        );
        let moved = after.angles_rad[i] - before.angles_rad[i];
        assert!((moved - 0.5 * (v0 + v1) * DT_S).abs() <= a * DT_S * DT_S + 1e-9);
        assert!(joint.contains(after.angles_rad[i]));
    }
}

#[test]
fn pick_sequence_reaches_each_commanded_state() {
    let mut motion = arm_at_home();
    let (above, at) = (downward(0.4, 0.1, 0.2), downward(0.4, 0.1, 0.08));
    motion.submit(1, Command::Open { opening_m: 0.12 }).unwrap();
    motion.submit(2, move_to(above, PathKind::Joint)).unwrap();
    motion.submit(3, move_to(at, PathKind::Linear)).unwrap();
    assert_eq!(motion.command_state(3), Some(CommandState::Accepted));
    for (id, pose) in [(1, None), (2, Some(above)), (3, Some(at))] {
        assert_eq!(
            carry_out(&mut motion, id, FingerContact::Free),
            CommandState::Done
        );
        if let Some(pose) = pose {
            let missed = PoseResidual::between(&motion.body_poses().base_from_tool, &pose);
            assert!(missed.distance_m < 1e-3 && missed.angle_rad < 0.009);
        }
    }
    assert_eq!(motion.gripper().opening_m(), 0.12);
    assert_eq!(motion.state(), MotionState::Idle);
    motion.submit(4, Command::Close).unwrap();
    motion.step(DT_S, FingerContact::Free);
    assert_eq!(motion.state(), MotionState::Closing);
    assert!(matches!(
        motion.command_state(4),
        Some(CommandState::Running { .. })
    ));
    assert_eq!(
        carry_out(&mut motion, 4, FingerContact::Pressed),
        CommandState::Done
    );
    assert!(motion.gripper().is_holding());
}

#[test]
fn progress_rises_from_0_to_1() {
    let mut motion = arm_at_home();
    motion
        .submit(1, move_to(downward(0.4, 0.0, 0.2), PathKind::Joint))
        .unwrap();
    let mut last = 0.0;
    for _ in 0..MAX_STEPS {
        motion.step(DT_S, FingerContact::Free);
        match motion.command_state(1).unwrap() {
            CommandState::Running { progress } => {
                assert!(progress > last && progress < 1.0);
                assert_eq!(motion.state(), MotionState::Moving);
                last = progress;
            }
            state => {
                assert_eq!(state, CommandState::Done);
                break;
            }
        }
    }
    assert!(last > 0.9);
}

#[test]
fn stop_brakes_at_once_and_empties_the_queue() {
    let mut motion = arm_at_home();
    motion
        .submit(1, move_to(downward(0.4, 0.0, 0.2), PathKind::Joint))
        .unwrap();
    motion.submit(2, Command::Close).unwrap();
    for _ in 0..50 {
        motion.step(DT_S, FingerContact::Free);
    }
    assert!(!motion.joints().is_at_rest());
    let end = motion.stopped_body_poses();
    motion.submit(3, Command::Stop).unwrap();
    let mut before = *motion.joints();
    for _ in 0..50 {
        assert_eq!(motion.state(), MotionState::Stopped);
        motion.step(DT_S, FingerContact::Free);
        let now = *motion.joints();
        for (i, joint) in motion.arm().chain().joints.iter().enumerate() {
            let [v0, v1] = [before, now].map(|state| state.velocities_rad_s[i]);
            assert!(v1.abs() <= v0.abs() && v0 * v1 >= 0.0, "{v0} {v1}");
            assert!((v0 - v1).abs() <= joint.max_acceleration_rad_s2 * DT_S + 1e-9);
        }
        before = now;
    }
    assert!(before.is_at_rest());
    assert_eq!(motion.body_poses(), end);
    assert_eq!(motion.state(), MotionState::Stopped);
    assert_eq!(motion.command_state(1), Some(CommandState::Stopped));
    assert_eq!(motion.command_state(2), Some(CommandState::Stopped));
    assert_eq!(motion.command_state(3), Some(CommandState::Done));
    motion.submit(4, Command::Open { opening_m: 0.1 }).unwrap();
    assert_eq!(
        carry_out(&mut motion, 4, FingerContact::Free),
        CommandState::Done
    );
}

#[test]
fn stop_halts_the_fingers() {
    let mut motion = arm_at_home();
    motion.submit(1, Command::Close).unwrap();
    motion.step(DT_S, FingerContact::Free);
    motion.submit(2, Command::Stop).unwrap();
    let opening = motion.gripper().opening_m();
    motion.step(DT_S, FingerContact::Free);
    assert_eq!(motion.gripper().opening_m(), opening);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn retargeting_in_motion_is_smooth_and_ends_at_the_last_target(
        targets in proptest::collection::vec(test_joint_angles(), 1..4),
        pauses in proptest::collection::vec(1..150_usize, 4),
        speed in 0.1..1.0_f64,
    ) {
        let mut motion = arm_at_home();
        for (k, target) in targets.iter().enumerate() {
            let command = Command::MoveJoints { joints_rad: *target, speed };
            motion.retarget(k as u64, command).unwrap();
            (0..pauses[k]).for_each(|_| step_smoothly(&mut motion));
        }
        let last = targets.len() as u64 - 1;
        for _ in 0..MAX_STEPS {
            if motion.command_state(last).unwrap().is_final() {
                break;
            }
            step_smoothly(&mut motion);
        }
        prop_assert_eq!(motion.command_state(last), Some(CommandState::Done));
        prop_assert_eq!(*motion.joints(), JointState::at_rest(targets[last as usize]));
    }
}

#[test]
fn a_straight_line_in_motion_begins_after_braking() {
    let mut motion = arm_at_home();
    motion
        .submit(1, move_to(downward(0.4, 0.1, 0.25), PathKind::Joint))
        .unwrap();
    (0..120).for_each(|_| step_smoothly(&mut motion));
    assert!(!motion.joints().is_at_rest());
    let braked = JointTrajectory::braking(motion.arm().chain(), motion.joints());
    let rest = motion
        .arm()
        .tool_pose(&braked.sample(f64::INFINITY).angles_rad);
    let mut target = rest;
    target.translation.z += 0.03;
    motion
        .retarget(2, move_to(target, PathKind::Linear))
        .unwrap();
    assert_eq!(motion.command_state(1), Some(CommandState::Stopped));
    for _ in 0..MAX_STEPS {
        if motion.command_state(2).unwrap().is_final() {
            break;
        }
        step_smoothly(&mut motion);
    }
    assert_eq!(motion.command_state(2), Some(CommandState::Done));
    let reached = motion.body_poses().base_from_tool;
    assert!(PoseResidual::between(&reached, &target).distance_m < 1e-4);
}

#[test]
fn unreachable_retarget_brakes_smoothly_and_reports_the_distance() {
    let mut motion = arm_at_home();
    motion
        .submit(1, move_to(downward(0.4, 0.1, 0.25), PathKind::Joint))
        .unwrap();
    (0..100).for_each(|_| step_smoothly(&mut motion));
    motion
        .retarget(2, move_to(downward(2.0, 0.0, 0.25), PathKind::Joint))
        .unwrap();
    motion.submit(3, Command::Close).unwrap();
    (0..100).for_each(|_| step_smoothly(&mut motion));
    assert!(motion.joints().is_at_rest());
    let Some(CommandState::Failed(error)) = motion.command_state(2) else {
        panic!("{:?}", motion.command_state(2));
    };
    assert_eq!(motion.state(), MotionState::Failed(error));
    assert_eq!(motion.command_state(3), Some(CommandState::Stopped));
    assert!(
        error
            .to_string()
            .starts_with("the pose is out of the arm's reach: the tool stays 1")
    );
    motion
        .submit(4, move_to(downward(0.4, 0.0, 0.25), PathKind::Joint))
        .unwrap();
    assert_eq!(
        carry_out(&mut motion, 4, FingerContact::Free),
        CommandState::Done
    );
}

#[test]
fn invalid_commands_are_rejected_and_change_nothing() {
    let mut motion = arm_at_home();
    let mut bent = downward(0.4, 0.0, 0.2);
    bent.rotation = UnitQuaternion::new_unchecked(Quaternion::new(f64::NAN, 0.0, 0.0, 0.0));
    let home = JointVector::from(HOME);
    let commands = [
        move_to(bent, PathKind::Joint),
        move_to(bent, PathKind::Linear),
        move_to(downward(f64::INFINITY, 0.0, 0.2), PathKind::Joint),
        Command::MoveTo {
            base_from_tool: downward(0.4, 0.0, 0.2),
            path: PathKind::Joint,
            speed: 0.0,
        },
        Command::MoveJoints {
            joints_rad: home,
            speed: f64::NAN,
        },
        Command::MoveJoints {
            joints_rad: home * 10.0,
            speed: 1.0,
        },
        Command::Open { opening_m: 0.2 },
        Command::Open {
            opening_m: f64::NAN,
        },
    ];
    motion
        .submit(99, move_to(downward(0.4, 0.1, 0.25), PathKind::Joint))
        .unwrap();
    for (id, command) in commands.into_iter().enumerate() {
        let error = if id % 2 == 0 {
            motion.submit(id as u64, command).unwrap_err()
        } else {
            motion.retarget(id as u64, command).unwrap_err()
        };
        let Some(CommandState::Failed(noted)) = motion.command_state(id as u64) else {
            panic!("command {id} did not fail");
        };
        // NaN is not equal to itself, but its error message is.
        assert_eq!(noted.to_string(), error.to_string());
        assert!(error.to_string().len() > 30);
    }
    assert_eq!(
        carry_out(&mut motion, 99, FingerContact::Free),
        CommandState::Done
    );
}

#[test]
fn a_step_of_no_time_changes_nothing() {
    let mut motion = arm_at_home();
    motion
        .submit(1, move_to(downward(0.4, 0.1, 0.25), PathKind::Joint))
        .unwrap();
    motion.step(DT_S, FingerContact::Free);
    let before = motion.clone();
    for dt in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        motion.step(dt, FingerContact::Free);
        assert_eq!(motion, before);
    }
}

#[test]
fn ids_are_used_once_and_the_queue_is_bounded() {
    let mut motion = arm_at_home();
    motion.submit(7, Command::Close).unwrap();
    assert_eq!(
        motion.submit(7, Command::Close),
        Err(Error::RepeatedId { id: 7 })
    );
    for id in 100..115 {
        motion.submit(id, Command::Close).unwrap();
    }
    assert!(matches!(
        motion.submit(200, Command::Close),
        Err(Error::QueueFull { .. })
    ));
    assert!(matches!(
        motion.command_state(200),
        Some(CommandState::Failed(_))
    ));
    // A full queue does not prevent stopping.
    motion.submit(300, Command::Stop).unwrap();
    assert_eq!(motion.command_state(7), Some(CommandState::Stopped));
}

#[test]
fn stop_acts_even_with_an_id_used_before() {
    let mut motion = arm_at_home();
    motion.submit(1, Command::Close).unwrap();
    motion.step(DT_S, FingerContact::Free);
    motion.submit(1, Command::Stop).unwrap();
    assert_eq!(motion.state(), MotionState::Stopped);
    assert_eq!(motion.command_state(1), Some(CommandState::Stopped));
}

#[test]
fn the_latest_64_commands_are_remembered() {
    let mut motion = arm_at_home();
    for id in 0..100 {
        motion
            .submit(id, Command::Open { opening_m: 0.15 })
            .unwrap();
        assert_eq!(
            carry_out(&mut motion, id, FingerContact::Free),
            CommandState::Done
        );
    }
    assert_eq!(motion.command_state(35), None);
    assert_eq!(motion.command_state(36), Some(CommandState::Done));
}

#[test]
fn arm_beyond_its_limits_is_rejected() {
    let outcome = ArmController::new(Arm::jaco_like(), JointVector::repeat(9.0));
    assert!(matches!(outcome, Err(Error::JointLimit { joint: 1, .. })));
}
