//! Checks of the published states: rate, stamps, content.

use super::Outcome;
use super::arm_record::{RecordedState, activity, is_at_rest, longest_gap_ns, mean_period_ns};
use super::arm_under_test::ArmUnderTest;
use control_protocol::{ArmReport, request};
use std::time::Duration;

/// Time for which states are recorded.
const RECORDING: Duration = Duration::from_millis(1500);
/// Longest mean period of the states, nanoseconds: 100 a second.
const PERIOD_MAX_NS: f64 = 1e7;
/// Longest time between two states, nanoseconds. Chosen: a frame's bodies are from so long ago at
/// most on any machine.
const GAP_MAX_NS: u64 = 250_000_000;
/// Largest median age of a state at its reception, nanoseconds. Chosen.
const AGE_MAX_NS: i64 = 100_000_000;
/// Largest difference of angles between a state and a report of an arm at rest, radians. Chosen.
const ANGLE_TOLERANCE_RAD: f64 = 0.01;
/// The same for a position, metres.
const POSITION_TOLERANCE_M: f64 = 0.005;
/// Tolerance of a quaternion's norm.
const UNIT_TOLERANCE: f64 = 1e-3;

/// Rate and stamps of the states.
pub(super) fn states(arm: &mut ArmUnderTest) -> Outcome {
    arm.begin_record()?;
    arm.record_for(RECORDING)?;
    let Some(period_ns) = mean_period_ns(&arm.record) else {
        return Err("no states of the arm come on arm/state".to_owned());
    };
    let rate_hz = 1e9 / period_ns;
    if period_ns > PERIOD_MAX_NS {
        return Err(format!("{rate_hz:.0} states a second come; 100 must"));
    }
    let Some(gap_ns) = longest_gap_ns(&arm.record) else {
        return Err("two states have the same stamp, or one before that of the last".to_owned());
    };
    let gap_ms = 1e-6 * gap_ns as f64;
    if gap_ns > GAP_MAX_NS {
        return Err(format!(
            "two states are {gap_ms:.0} ms apart; at most 250 may be"
        ));
    }
    let age_ns = median_age_ns(&arm.record);
    let age_ms = 1e-6 * age_ns as f64;
    if !(-1_000_000..=AGE_MAX_NS).contains(&age_ns) {
        return Err(format!(
            "states are {age_ms:.0} ms old when they come; stamps are of the monotonic clock, and at \
             most 100 ms old"
        ));
    }
    Ok(format!(
        "{rate_hz:.0} a second, at most {gap_ms:.0} ms apart, {age_ms:.1} ms old"
    ))
}

fn median_age_ns(record: &[RecordedState]) -> i64 {
    let age_ns = |one: &RecordedState| {
        one.received_ns
            .cast_signed()
            .saturating_sub(one.state.stamp_ns.cast_signed())
    };
    let mut ages_ns: Vec<i64> = record.iter().map(age_ns).collect();
    ages_ns.sort_unstable();
    ages_ns.get(ages_ns.len() / 2).copied().unwrap_or_default()
}

/// Fields of a state, and their agreement with the answer to a request.
pub(super) fn content(arm: &mut ArmUnderTest) -> Outcome {
    arm.begin_record()?;
    arm.record_for(Duration::from_millis(100))?;
    let report = arm.answer(&request::arm())?;
    let Some(one) = arm.record.last() else {
        return Err("no states of the arm come on arm/state".to_owned());
    };
    let n_capsules = sound(one)?;
    if !is_at_rest(&one.state) {
        return Err("an arm that nobody has commanded moves".to_owned());
    }
    agree(one, &report)?;
    Ok(format!(
        "activity {}, six joints, a pose, {n_capsules} capsules, as the report tells",
        report.activity
    ))
}

/// Number of capsules of a state whose fields are in order.
fn sound(one: &RecordedState) -> Result<usize, String> {
    let state = &one.state;
    if activity(state).is_none() {
        return Err(format!("{} is the code of no activity", state.activity));
    }
    let numbers = state
        .joint_angles_rad
        .iter()
        .chain(&state.joint_velocities_rad_s)
        .chain(&state.world_from_gripper.position_m)
        .chain([&state.opening_m]);
    if !numbers.copied().all(f64::is_finite) {
        return Err("an angle, a velocity, the position or the opening is not finite".to_owned());
    }
    let [x, y, z, w] = state.world_from_gripper.orientation_xyzw;
    let norm = (x * x + y * y + z * z + w * w).sqrt();
    if norm.is_nan() || (norm - 1.0).abs() > UNIT_TOLERANCE {
        return Err(format!(
            "the orientation of the gripper has length {norm}, and not 1"
        ));
    }
    match one.n_capsules {
        Some(n) if n > 0 => Ok(n),
        Some(_) => {
            Err("there are no capsules, so that nobody can keep away from the arm".to_owned())
        }
        None => Err("a capsule has a number that is not finite, or a negative radius".to_owned()),
    }
}

fn agree(one: &RecordedState, report: &ArmReport) -> Result<(), String> {
    let state = &one.state;
    let farthest = |ours: &[f64], theirs: &[f64]| {
        let differences = ours.iter().zip(theirs).map(|(a, b)| (a - b).abs());
        differences.fold(0.0_f64, f64::max)
    };
    let angle_rad = farthest(&state.joint_angles_rad, &report.joint_angles_rad);
    let position_m = farthest(&state.world_from_gripper.position_m, &report.position_m);
    if angle_rad > ANGLE_TOLERANCE_RAD || position_m > POSITION_TOLERANCE_M {
        return Err(format!(
            "arm/state and the report of an arm at rest differ by {angle_rad:.3} rad and \
             {position_m:.3} m"
        ));
    }
    let word = activity(state).map_or("", message::ArmActivity::word);
    if word != report.activity {
        return Err(format!(
            "arm/state tells {word}, and the report {}",
            report.activity
        ));
    }
    Ok(())
}
