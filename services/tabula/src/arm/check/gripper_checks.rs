//! Check of the gripper: it closes, opens, and goes to an opening.

use super::Outcome;
use super::arm_under_test::ArmUnderTest;
use control_protocol::ArmMotion;

/// Opening to which the fingers go, metres.
const HALF_OPEN_M: f64 = 0.05;
/// Tolerance of an opening, metres. Chosen.
const TOLERANCE_M: f64 = 0.005;

/// Closing, a given opening, full opening; then the fingers are as before.
pub(super) fn gripper(arm: &mut ArmUnderTest) -> Outcome {
    // The arm may move on after a check that has failed.
    arm.go_back()?;
    let closed = arm.carry_out(&ArmMotion::Close)?;
    if closed.activity == "failed" && closed.note.is_empty() {
        return Err("closing has failed without a reason in the note".to_owned());
    }
    if closed.opening_m > TOLERANCE_M && !closed.is_holding {
        return Err(format!(
            "closed fingers hold nothing, and are {:.0} mm apart",
            1e3 * closed.opening_m
        ));
    }
    let half = ArmMotion::OpenTo {
        opening_m: HALF_OPEN_M,
    };
    reach(arm, &half, HALF_OPEN_M)?;
    let opened = arm.carry_out(&ArmMotion::Open)?;
    if opened.activity == "failed" || opened.opening_m < HALF_OPEN_M + TOLERANCE_M {
        return Err(format!(
            "open fingers are {:.0} mm apart: {}",
            1e3 * opened.opening_m,
            opened.note
        ));
    }
    let opening_m = arm.home_opening_m;
    reach(arm, &ArmMotion::OpenTo { opening_m }, opening_m)?;
    Ok(format!(
        "it closes to {:.0} mm, goes to 50 mm, and opens to {:.0} mm",
        1e3 * closed.opening_m,
        1e3 * opened.opening_m
    ))
}

fn reach(arm: &mut ArmUnderTest, motion: &ArmMotion, opening_m: f64) -> Result<(), String> {
    let report = arm.carry_out(motion)?;
    let difference_m = (report.opening_m - opening_m).abs();
    if report.activity == "failed" || difference_m > TOLERANCE_M || report.is_holding {
        return Err(format!(
            "the fingers were to open to {:.0} mm, and are {:.0} mm apart: {}",
            1e3 * opening_m,
            1e3 * report.opening_m,
            report.note
        ));
    }
    Ok(())
}
