//! `tabula arm`: commands and state of the robot arm.

mod check;

use crate::arguments::{ArmMove, ArmVerb};
use arm_interface::{StopButton, StopRecord, monotonic_ns};
use command_line::Output;
use control_client::ask_once;
use control_protocol::{ArmLease, ArmMotion, ArmReport, request};
use daemon_client::RunFolder;
use nalgebra::{Rotation3, UnitQuaternion, Vector3};
use service::{CommonArguments, Failure, exit_code};
use std::f64::consts::PI;
use std::path::Path;
use std::process::ExitCode;
use std::time::Duration;

/// Period in which the lease is renewed, and the progress of a command looked at. Chosen: a tenth of
/// the silence after which a lease ends.
const POLL_PERIOD: Duration = Duration::from_millis(50);
/// Time limit for the arm's loop to act on its stop word, which it reads 120 times a second. Chosen.
const STOP_LIMIT: Duration = Duration::from_secs(1);

/// Sends a command to the arm, waits until it is done, and prints the state of the arm.
pub(crate) fn run(
    common: &CommonArguments,
    verb: &ArmVerb,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let motion = match verb {
        ArmVerb::State => {
            let report = ask_once(common, &request::arm())?;
            output.answer(&report, || text(&report));
            return Ok(ExitCode::SUCCESS);
        }
        ArmVerb::Stop => return stop(common, output),
        ArmVerb::Check { yes } => return check::run(common, *yes, output),
        ArmVerb::Move(to) => move_to(to)?,
        ArmVerb::Home => ArmMotion::Home,
        ArmVerb::Open { width_mm: None } => ArmMotion::Open,
        ArmVerb::Open {
            width_mm: Some(width_mm),
        } => ArmMotion::OpenTo {
            opening_m: 1e-3 * width_mm,
        },
        ArmVerb::Close => ArmMotion::Close,
    };
    let lease = lease()?;
    let report = carry_out(common, &lease, motion);
    // It ends by itself, too.
    let _ = ask_once(common, &request::release_arm(lease.id));
    let report = ArmReport {
        commander: None,
        ..report?
    };
    output.answer(&report, || text(&report));
    Ok(if report.activity == "failed" {
        ExitCode::from(exit_code::REFUSED)
    } else {
        ExitCode::SUCCESS
    })
}

/// Lease of this process.
fn lease() -> Result<ArmLease, Failure> {
    let id = getrandom::u64()
        .map_err(|error| Failure::general(format!("the system has no random numbers: {error}")))?;
    let holder = format!("`tabula arm`, process {}", std::process::id());
    Ok(ArmLease { id, holder })
}

/// Begins a motion, and renews the lease until its end.
fn carry_out(
    common: &CommonArguments,
    lease: &ArmLease,
    motion: ArmMotion,
) -> Result<ArmReport, Failure> {
    let mut report = ask_once(common, &request::move_arm(lease.clone(), motion))?;
    let id = report.command_id;
    while report.command_id == id && is_busy(&report) {
        std::thread::sleep(POLL_PERIOD);
        report = ask_once(common, &request::hold_arm(lease.clone()))?;
    }
    if report.command_id != id {
        let sentence = "the command was not carried out to its end, since the simulator began anew";
        return Err(Failure::new(exit_code::REFUSED, sentence));
    }
    Ok(report)
}

/// Stops the arm by its word in shared memory, which needs no other process than that of the arm; by
/// a request where the word belongs to another user, or its arm has died.
fn stop(common: &CommonArguments, output: &Output) -> Result<ExitCode, Failure> {
    let folders = RunFolder::candidates();
    let pressed: Vec<_> = folders
        .iter()
        .filter_map(|folder| press(&folder.domain_folder(&common.domain)))
        .collect();
    let Some((button, word)) = pressed.iter().find(|(button, _)| is_alive(button)) else {
        let report = ask_once(common, &request::stop_arm())?;
        output.answer(&report, || text(&report));
        return Ok(ExitCode::SUCCESS);
    };
    let taken = button.wait_until_taken(*word, STOP_LIMIT);
    let Some(taken) = taken.map_err(Failure::general)? else {
        let sentence = "the stop is written, but the arm's loop has not acted on it within 1 s; it \
                        may hang, so switch the arm off; see `tabula status`";
        return Err(Failure::new(exit_code::TIMED_OUT, sentence));
    };
    match ask_once(common, &request::arm()) {
        Ok(report) => output.answer(&report, || text(&report)),
        Err(unknown) => output.answer(&None::<ArmReport>, || stopped_text(*word, &taken, &unknown)),
    }
    Ok(ExitCode::SUCCESS)
}

/// Presses the stop word in the folder of a domain; `None` where there is none that this user may
/// write.
fn press(domain_folder: &Path) -> Option<(StopButton, u64)> {
    let button = StopButton::open(domain_folder).ok()?;
    let word = button.press().ok()?;
    Some((button, word))
}

/// True if the arm's loop has run within the last second: the word of an arm that has died may be
/// there still.
fn is_alive(button: &StopButton) -> bool {
    let limit_ns = STOP_LIMIT.as_nanos() as u64;
    button
        .record()
        .is_ok_and(|record| monotonic_ns().saturating_sub(record.cycle_ns) < limit_ns)
}

fn stopped_text(word: u64, taken: &StopRecord, unknown: &Failure) -> String {
    let delay_ms = taken.braking_ns.saturating_sub(word) as f64 * 1e-6;
    format!(
        "the arm is stopped: it brakes since {delay_ms:.1} ms after the stop; more is not known: \
         {unknown}"
    )
}

fn is_busy(report: &ArmReport) -> bool {
    ["moving", "opening", "closing"].contains(&&*report.activity)
}

/// Motion to a pose: fingers down and closing along x, then tilted forward and turned about the
/// vertical.
fn move_to(to: &ArmMove) -> Result<ArmMotion, Failure> {
    let position_m = [to.x, to.y, to.z];
    let numbers = position_m.iter().chain([&to.tilt, &to.yaw]);
    if !numbers.copied().all(f64::is_finite) {
        return Err(Failure::usage(
            "position, tilt and yaw must be finite numbers",
        ));
    }
    let yaw = Rotation3::from_axis_angle(&Vector3::z_axis(), to.yaw.to_radians());
    let tilt = Rotation3::from_axis_angle(&Vector3::x_axis(), PI + to.tilt.to_radians());
    let orientation = UnitQuaternion::from_rotation_matrix(&(yaw * tilt));
    let orientation_xyzw = orientation.coords.into();
    Ok(ArmMotion::MoveTo {
        position_m,
        orientation_xyzw,
        straight: to.straight,
    })
}

fn text(report: &ArmReport) -> String {
    let [x, y, z] = report.position_m;
    let joints: Vec<String> = report
        .joint_angles_rad
        .iter()
        .map(|angle| format!("{:.0}", angle.to_degrees()))
        .collect();
    let note = if report.note.is_empty() {
        String::new()
    } else {
        format!(": {}", report.note)
    };
    let commander = match &report.commander {
        Some(commander) => format!(", commanded by {commander}"),
        None => String::new(),
    };
    format!(
        "the arm is {}{note}{commander}\n\
         gripper at {x:.3} {y:.3} {z:.3} m, open {:.0} mm, {}\n\
         joints {} degrees",
        report.activity,
        report.opening_m * 1000.0,
        if report.is_holding {
            "holding something"
        } else {
            "empty"
        },
        joints.join(" ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gripper_axes(tilt: f64, yaw: f64) -> [Vector3<f64>; 2] {
        let to = ArmMove {
            x: 0.1,
            y: 0.2,
            z: 0.9,
            tilt,
            yaw,
            straight: false,
        };
        let ArmMotion::MoveTo {
            orientation_xyzw: [x, y, z, w],
            ..
        } = move_to(&to).unwrap()
        else {
            panic!("no pose");
        };
        let rotation = UnitQuaternion::new_normalize(nalgebra::Quaternion::new(w, x, y, z));
        [rotation * Vector3::x(), rotation * Vector3::z()]
    }

    #[test]
    fn pose_points_the_fingers_down_and_tilts_them_forward() {
        let close = |a: Vector3<f64>, b: Vector3<f64>| assert!((a - b).norm() < 1e-9, "{a} {b}");
        let [closing, forward] = gripper_axes(0.0, 0.0);
        close(closing, Vector3::x());
        close(forward, -Vector3::z());
        let [closing, forward] = gripper_axes(90.0, 0.0);
        close(closing, Vector3::x());
        close(forward, Vector3::y());
        let [closing, forward] = gripper_axes(0.0, 90.0);
        close(closing, Vector3::y());
        close(forward, -Vector3::z());
    }
}
