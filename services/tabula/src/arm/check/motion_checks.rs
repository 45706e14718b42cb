//! Checks of motions and of what ends them: silence, release, stop word, stop request.

use super::Outcome;
use super::arm_record::{
    RecordedState, activity, greatest_deceleration_rad_s2, integrated_rad, is_at_rest, speed_rad_s,
};
use super::arm_under_test::{ArmUnderTest, MOTION_LIMIT, N_ATTEMPTS, TOO_BUSY, TURNED, new_lease};
use super::lease_keeper::{LeaseKeeper, Renewals};
use arm_interface::{LEASE_TIME_NS, StopButton};
use arm_kinematics::Arm;
use control_protocol::{ArmLease, RefusalKind, request};
use message::ArmActivity;
use std::time::Duration;

/// Turn of the motion that ends well, radians.
const SHORT_TURN_RAD: f64 = 0.3;
/// Turn of the motions that are ended, radians: an arm within the limits of speed needs 1.5 s.
const LONG_TURN_RAD: f64 = 1.2;
/// Largest distance from the target at the end, radians. Chosen.
const TARGET_TOLERANCE_RAD: f64 = 0.02;
/// Factor over the greatest speed of the arm that tasks are planned for. Chosen: noise.
const SPEED_MARGIN: f64 = 1.1;
/// Speed from which the turned joint moves, rad/s: half of what a slow arm reaches.
const MOVING_RAD_S: f64 = 0.1;
/// Greatest deceleration, rad/s². Chosen: below that of a joint that stands still at once.
const DECELERATION_MAX_RAD_S2: f64 = 10.0;
/// Longest time from the beginning of braking to rest.
const BRAKING_LIMIT_NS: u64 = 1_000_000_000;
/// Longest time from a cause to the beginning of braking, nanoseconds: five times what 99 of 100
/// stops take, on any machine.
const REACTION_LIMIT_NS: u64 = 250_000_000;
/// Tolerance of the time at which a silent lease ends, nanoseconds: some cycles.
const EARLY_NS: u64 = 50_000_000;
/// Time for which a braked arm must stand.
const STANDING: Duration = Duration::from_millis(300);
/// Largest creep of a joint of an arm that stands, radians.
const CREEP_RAD: f64 = 0.005;

/// End of a motion before its target.
struct BrakedTurn {
    /// Lease with which the motion was commanded.
    lease: ArmLease,
    /// Time of the first state that tells of a stop, monotonic, nanoseconds.
    stopped_ns: u64,
    /// Time from there to rest, nanoseconds.
    braking_ns: u64,
    deceleration_rad_s2: f64,
}

/// A motion to a target, with bounded speeds.
pub(super) fn motion(arm: &mut ArmUnderTest) -> Outcome {
    let before = arm.answer(&request::arm())?;
    arm.begin_record()?;
    let report = arm.carry_out(&arm.turn(SHORT_TURN_RAD))?;
    arm.record_for(Duration::from_millis(50))?;
    let turned_rad = report.joint_angles_rad[TURNED] - before.joint_angles_rad[TURNED];
    if report.activity != "idle" || (turned_rad.abs() - SHORT_TURN_RAD).abs() > TARGET_TOLERANCE_RAD
    {
        return Err(format!(
            "a turn of the last joint by {SHORT_TURN_RAD} rad ended {} after {:.3} rad: {}",
            report.activity,
            turned_rad.abs(),
            report.note
        ));
    }
    if report.command_id == before.command_id {
        return Err("an accepted motion did not get another command_id".to_owned());
    }
    let fastest_rad_s = within_speeds(&arm.record)?;
    let integrated_rad = integrated_rad(&arm.record, TURNED);
    if (integrated_rad - turned_rad).abs() > 0.1 * SHORT_TURN_RAD {
        return Err(format!(
            "the velocities add up to a turn by {integrated_rad:.3} rad, the angles to \
             {turned_rad:.3} rad; both are in radians and seconds"
        ));
    }
    arm.go_back()?;
    Ok(format!(
        "the last joint turned by {SHORT_TURN_RAD} rad and back, at {:.0} °/s at most",
        fastest_rad_s.to_degrees()
    ))
}

/// Greatest speed of a record whose speeds are those of the arm that tasks are planned for.
fn within_speeds(record: &[RecordedState]) -> Result<f64, String> {
    let joints = Arm::jaco_like().chain().joints;
    for one in record {
        let speeds = one.state.joint_velocities_rad_s;
        for (number, (speed, joint)) in (1..).zip(speeds.iter().zip(&joints)) {
            let most_rad_s = joint.max_velocity_rad_s * SPEED_MARGIN;
            if speed.is_nan() || speed.abs() > most_rad_s {
                return Err(format!(
                    "joint {number} moved at {:.0} °/s; plans count on {:.0} at most",
                    speed.abs().to_degrees(),
                    joint.max_velocity_rad_s.to_degrees()
                ));
            }
        }
    }
    Ok(record
        .iter()
        .map(|one| speed_rad_s(&one.state))
        .fold(0.0, f64::max))
}

/// Braking after half a second without a renewal of the lease.
pub(super) fn silence(arm: &mut ArmUnderTest) -> Outcome {
    let (lease, renewals) = turn_under_lease(arm)?;
    let braked = braked_turn(arm, lease, "its commander was silent")?;
    if braked.stopped_ns + EARLY_NS < renewals.sent_ns + LEASE_TIME_NS {
        return Err("the arm braked before its commander was silent for 0.5 s".to_owned());
    }
    let latest_ns = renewals.answered_ns + LEASE_TIME_NS + REACTION_LIMIT_NS;
    let silence_ms = 1e-6 * braked.stopped_ns.saturating_sub(renewals.answered_ns) as f64;
    if braked.stopped_ns > latest_ns {
        return Err(format!(
            "the arm braked {silence_ms:.0} ms after its commander was heard last; 750 are allowed"
        ));
    }
    stays_ended(arm, &braked.lease)?;
    Ok(format!(
        "the arm braked {silence_ms:.0} ms after its commander was heard last, {}",
        braked.text()
    ))
}

/// Braking at the release of the lease.
pub(super) fn release(arm: &mut ArmUnderTest) -> Outcome {
    let (lease, _) = turn_under_lease(arm)?;
    arm.answer(&request::release_arm(lease.id))?;
    let braked = braked_turn(arm, lease, "its commander has released it")?;
    stays_ended(arm, &braked.lease)?;
    Ok(format!(
        "a moving arm that is released brakes, {}",
        braked.text()
    ))
}

/// Stop by the word in shared memory, for which nobody needs a lease.
pub(super) fn stop_word(arm: &mut ArmUnderTest) -> Outcome {
    let (lease, _) = turn_under_lease(arm)?;
    let button = StopButton::open(arm.domain.folder()).map_err(|error| error.to_string())?;
    let pressed = button.press().map_err(|error| error.to_string())?;
    let braked = braked_turn(arm, lease, "its stop word was pressed")?;
    let record = button.record().map_err(|error| error.to_string())?;
    if record.taken != pressed {
        return Err("the arm has not written its stop word back as taken".to_owned());
    }
    let reaction_ns = record.braking_ns.saturating_sub(pressed);
    if record.braking_ns < pressed || reaction_ns > REACTION_LIMIT_NS {
        return Err(format!(
            "braking began {:.0} ms after the stop word was pressed; 250 are allowed",
            1e-6 * (record.braking_ns as f64 - pressed as f64)
        ));
    }
    if record.rest_ns < record.braking_ns {
        return Err("the time of rest after the stop is not in the stop word's file".to_owned());
    }
    stays_ended(arm, &braked.lease)?;
    Ok(format!(
        "braking began {:.1} ms after the word was pressed, {}",
        1e-6 * reaction_ns as f64,
        braked.text()
    ))
}

/// Stop by a request, which needs no lease either.
pub(super) fn stop_request(arm: &mut ArmUnderTest) -> Outcome {
    let (lease, _) = turn_under_lease(arm)?;
    let report = arm.answer(&request::stop_arm())?;
    if report.activity != "stopped" || report.commander.is_some() {
        return Err(format!(
            "the answer to a stop is {}, commanded by {:?}",
            report.activity, report.commander
        ));
    }
    let braked = braked_turn(arm, lease, "a stop was requested")?;
    stays_ended(arm, &braked.lease)?;
    Ok(format!(
        "the arm was stopped by a request, {}",
        braked.text()
    ))
}

/// Motion by a new lease after a stop.
pub(super) fn resumption(arm: &mut ArmUnderTest) -> Outcome {
    let report = arm.answer(&request::arm())?;
    if report.activity != "stopped" {
        return Err(format!("the arm is {} after a stop", report.activity));
    }
    arm.go_back()?;
    Ok("after a stop a new lease moves the arm, back to where it was".to_owned())
}

/// Begins the long turn from where the arm was at first, and ends the renewals when the joint moves; the arm is under the lease for
/// half a second more.
fn turn_under_lease(arm: &mut ArmUnderTest) -> Result<(ArmLease, Renewals), String> {
    for _ in 0..N_ATTEMPTS {
        arm.go_back()?;
        let lease = new_lease()?;
        arm.begin_record()?;
        arm.answer(&request::move_arm(lease.clone(), arm.turn(LONG_TURN_RAD)))?;
        let keeper = LeaseKeeper::start(&arm.common, lease.clone());
        let moves = |record: &[RecordedState]| {
            let moving =
                |one: &RecordedState| one.state.joint_velocities_rad_s[TURNED].abs() > MOVING_RAD_S;
            record.iter().any(moving)
        };
        let has_moved = arm.record_until(MOTION_LIMIT, moves)?;
        let renewals = keeper.end();
        if !renewals.is_late {
            return if has_moved {
                Ok((lease, renewals))
            } else {
                Err("the last joint does not turn faster than 6 °/s".to_owned())
            };
        }
    }
    Err(TOO_BUSY.to_owned())
}

/// Waits until the turn has ended, and judges how.
fn braked_turn(arm: &mut ArmUnderTest, lease: ArmLease, cause: &str) -> Result<BrakedTurn, String> {
    let is_stopped = |one: &RecordedState| activity(&one.state) == Some(ArmActivity::Stopped);
    let has_ended = |record: &[RecordedState]| {
        let last = record.last();
        last.is_some_and(|last| {
            activity(&last.state) != Some(ArmActivity::Moving) && is_at_rest(&last.state)
        })
    };
    let stands = arm.record_until(MOTION_LIMIT, has_ended)?;
    let stopped = arm.record.iter().position(is_stopped);
    let Some(stopped) = stopped.filter(|_| stands) else {
        let turned_rad = turned_rad(&arm.record);
        return Err(format!(
            "the arm went on for {turned_rad:.2} rad after {cause}: it must brake, and report that \
             it is stopped"
        ));
    };
    within_speeds(&arm.record)?;
    let braking = &arm.record[stopped..];
    let stopped_ns = braking[0].state.stamp_ns;
    let at_rest = braking.iter().find(|one| is_at_rest(&one.state));
    let braking_ns = at_rest.map_or(u64::MAX, |one| one.state.stamp_ns - stopped_ns);
    let deceleration_rad_s2 = greatest_deceleration_rad_s2(&arm.record, TURNED);
    if braking_ns > BRAKING_LIMIT_NS {
        return Err(format!(
            "the arm was not at rest 1 s after it began to brake, when {cause}"
        ));
    }
    if deceleration_rad_s2 > DECELERATION_MAX_RAD_S2 {
        return Err(format!(
            "the last joint braked with {deceleration_rad_s2:.0} rad/s², when {cause}; more than 10 \
             throws what the fingers hold"
        ));
    }
    if turned_rad(&arm.record) > LONG_TURN_RAD - TARGET_TOLERANCE_RAD {
        return Err(format!("the arm went on to its target, when {cause}"));
    }
    creeps_not(arm)?;
    Ok(BrakedTurn {
        lease,
        stopped_ns,
        braking_ns,
        deceleration_rad_s2,
    })
}

/// Turn of the last joint in a record, radians.
fn turned_rad(record: &[RecordedState]) -> f64 {
    let angle = |one: &RecordedState| one.state.joint_angles_rad[TURNED];
    match (record.first(), record.last()) {
        (Some(first), Some(last)) => (angle(last) - angle(first)).abs(),
        _ => 0.0,
    }
}

/// Checks that an arm at rest stays where it is.
fn creeps_not(arm: &mut ArmUnderTest) -> Result<(), String> {
    let begin = arm.record.len() - 1;
    arm.record_for(STANDING)?;
    let (first, last) = (&arm.record[begin], &arm.record[arm.record.len() - 1]);
    let joints = first
        .state
        .joint_angles_rad
        .iter()
        .zip(last.state.joint_angles_rad);
    for (number, (before_rad, after_rad)) in (1..).zip(joints) {
        let creep_rad = (after_rad - before_rad).abs();
        if creep_rad.is_nan() || creep_rad > CREEP_RAD {
            return Err(format!(
                "joint {number} of a braked arm moves on, by {creep_rad:.3} rad"
            ));
        }
    }
    Ok(())
}

/// Checks that a lease that has ended neither moves the arm nor begins again.
fn stays_ended(arm: &mut ArmUnderTest, lease: &ArmLease) -> Result<(), String> {
    let motion = arm.turn(LONG_TURN_RAD);
    let moved = request::move_arm(lease.clone(), motion);
    arm.refusal(
        "a motion by the lease that has ended",
        &moved,
        RefusalKind::Conflict,
    )?;
    let held = request::hold_arm(lease.clone());
    arm.refusal("the lease that has ended", &held, RefusalKind::Conflict)?;
    match arm.answer(&request::arm())?.commander {
        Some(commander) => Err(format!("{commander} still commands the arm")),
        None => Ok(()),
    }
}

impl BrakedTurn {
    /// End of a sentence about the braking.
    fn text(&self) -> String {
        format!(
            "and was at rest {:.0} ms later, with at most {:.1} rad/s²",
            1e-6 * self.braking_ns as f64,
            self.deceleration_rad_s2
        )
    }
}
