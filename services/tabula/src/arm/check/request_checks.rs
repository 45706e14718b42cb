//! Checks of what an arm refuses: ended leases, a second commander, limits, numbers that are none.

use super::Outcome;
use super::arm_under_test::{ArmUnderTest, new_lease};
use control_protocol::{ArmLease, ArmMotion, RefusalKind, request};
use scene_document::ARM_JOINTS;

/// Angle beyond the limits of every joint, radians.
const BEYOND_RAD: f64 = 1000.0;
/// Opening beyond that of every gripper, metres.
const BEYOND_M: f64 = 10.0;

/// Refusal of a motion by a lease that has ended, and of commanders without a name.
pub(super) fn lease(arm: &mut ArmUnderTest) -> Outcome {
    let lease = new_lease()?;
    let held = arm.answer(&request::hold_arm(lease.clone()))?;
    if held.commander.as_deref() != Some(lease.holder.as_str()) {
        return Err(format!(
            "{:?} holds the lease, and the report names {:?}",
            lease.holder, held.commander
        ));
    }
    let released = arm.answer(&request::release_arm(lease.id))?;
    if released.commander.is_some() {
        return Err(format!(
            "a released lease goes on: {:?}",
            released.commander
        ));
    }
    let motion = arm.turn(0.0);
    let refusal = arm.refusal(
        "a motion by a lease that has ended",
        &request::move_arm(lease.clone(), motion),
        RefusalKind::Conflict,
    )?;
    for holder in [String::new(), "x".repeat(65), "\u{1b}[2J".to_owned()] {
        let what = format!("a commander with the name {holder:?}");
        let id = new_lease()?.id;
        let nameless = ArmLease { id, holder };
        arm.refusal(&what, &request::hold_arm(nameless), RefusalKind::Invalid)?;
    }
    Ok(format!(
        "without one a motion is refused: {}",
        refusal.sentence
    ))
}

/// Refusal of a second commander, by the name of the first one.
pub(super) fn one_commander(arm: &mut ArmUnderTest) -> Outcome {
    let (first, second) = (new_lease()?, new_lease()?);
    let second = ArmLease {
        holder: "second commander".to_owned(),
        ..second
    };
    arm.answer(&request::hold_arm(first.clone()))?;
    let motion = arm.turn(0.0);
    let refused = arm.refusal(
        "the motion of a second commander",
        &request::move_arm(second, motion),
        RefusalKind::Conflict,
    );
    arm.answer(&request::release_arm(first.id))?;
    let refusal = refused?;
    if !refusal.sentence.contains(&first.holder) {
        return Err(format!(
            "a second commander is refused without the name of the first, {:?}: {}",
            first.holder, refusal.sentence
        ));
    }
    Ok(format!("a second one is refused: {}", refusal.sentence))
}

/// Refusal of joint angles and openings beyond the limits.
pub(super) fn joint_limits(arm: &mut ArmUnderTest) -> Outcome {
    let mut sentence = String::new();
    for joint in 0..ARM_JOINTS {
        for beyond_rad in [BEYOND_RAD, -BEYOND_RAD] {
            let mut angles_rad = arm.home_rad;
            angles_rad[joint] = beyond_rad;
            let what = format!("joint {} at {beyond_rad} rad", joint + 1);
            sentence = refused(arm, &what, ArmMotion::MoveJoints { angles_rad })?;
        }
    }
    for opening_m in [BEYOND_M, -0.01] {
        let what = format!("an opening of {opening_m} m");
        refused(arm, &what, ArmMotion::OpenTo { opening_m })?;
    }
    Ok(format!("what is beyond them is refused: {sentence}"))
}

/// Refusal of poses and angles that are none.
pub(super) fn numbers(arm: &mut ArmUnderTest) -> Outcome {
    let report = arm.answer(&request::arm())?;
    let poses = [
        ([f64::NAN, 0.0, 1.0], report.orientation_xyzw),
        (report.position_m, [0.0; 4]),
        (report.position_m, [f64::INFINITY, 0.0, 0.0, 0.0]),
    ];
    for (position_m, orientation_xyzw) in poses {
        for straight in [false, true] {
            let motion = ArmMotion::MoveTo {
                position_m,
                orientation_xyzw,
                straight,
            };
            let what = format!("the pose {position_m:?} {orientation_xyzw:?}");
            refused(arm, &what, motion)?;
        }
    }
    let mut angles_rad = arm.home_rad;
    angles_rad[0] = f64::NAN;
    let sentence = refused(
        arm,
        "a joint angle that is no number",
        ArmMotion::MoveJoints { angles_rad },
    )?;
    Ok(format!("what is no number is refused: {sentence}"))
}

/// Sentence with which a motion is refused as invalid.
fn refused(arm: &ArmUnderTest, what: &str, motion: ArmMotion) -> Result<String, String> {
    let lease = new_lease()?;
    let asked = request::move_arm(lease.clone(), motion);
    let refusal = arm.refusal(what, &asked, RefusalKind::Invalid);
    arm.answer(&request::release_arm(lease.id))?;
    refusal.map(|refusal| refusal.sentence)
}
