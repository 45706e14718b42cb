//! `tabula arm`: commands and state of the robot arm.

use crate::arguments::{ArmMove, ArmVerb};
use command_line::Output;
use control_client::ask_once;
use control_protocol::{ArmReport, TypedRequest, request};
use nalgebra::{Rotation3, UnitQuaternion, Vector3};
use service::{CommonArguments, Failure, exit_code};
use std::f64::consts::PI;
use std::process::ExitCode;
use std::time::Duration;

/// Polling period of a command's progress. Chosen.
const POLL_PERIOD: Duration = Duration::from_millis(50);

/// Sends a command to the arm, waits until it is done, and prints the state of the arm.
pub(crate) fn run(
    common: &CommonArguments,
    verb: &ArmVerb,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let (request, waits) = match verb {
        ArmVerb::State => (request::arm(), false),
        ArmVerb::Move(to) => (move_to(to)?, !to.wait.no_wait),
        ArmVerb::Home(wait) => (request::home_arm(), !wait.no_wait),
        ArmVerb::Open(wait) => (request::open_gripper(), !wait.no_wait),
        ArmVerb::Close(wait) => (request::close_gripper(), !wait.no_wait),
        ArmVerb::Stop => (request::stop_arm(), false),
    };
    let mut report = ask_once(common, &request)?;
    let id = report.command_id;
    while waits && report.command_id == id && is_busy(&report) {
        std::thread::sleep(POLL_PERIOD);
        report = ask_once(common, &request::arm())?;
    }
    output.answer(&report, || text(&report));
    let is_replaced = report.command_id != id;
    if waits && (is_replaced || report.activity == "stopped") {
        let sentence = "the command was not carried out to its end: another one replaced it, the \
                        arm was stopped, or the simulation began anew";
        return Err(Failure::new(exit_code::REFUSED, sentence));
    }
    Ok(if waits && report.activity == "failed" {
        ExitCode::from(exit_code::REFUSED)
    } else {
        ExitCode::SUCCESS
    })
}

fn is_busy(report: &ArmReport) -> bool {
    ["moving", "opening", "closing"].contains(&&*report.activity)
}

/// Request of a pose: fingers down and closing along x, then tilted forward and turned about the
/// vertical.
fn move_to(to: &ArmMove) -> Result<TypedRequest<ArmReport>, Failure> {
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
    Ok(request::move_gripper(
        position_m,
        orientation_xyzw,
        to.straight,
    ))
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
    format!(
        "the arm is {}{note}\n\
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
    use crate::arguments::ArmWait;
    use control_protocol::{ArmCommand, Command};

    fn gripper_axes(tilt: f64, yaw: f64) -> [Vector3<f64>; 2] {
        let to = ArmMove {
            x: 0.1,
            y: 0.2,
            z: 0.9,
            tilt,
            yaw,
            straight: false,
            wait: ArmWait { no_wait: false },
        };
        let request = move_to(&to).unwrap();
        let Command::Arm(ArmCommand::MoveTo {
            orientation_xyzw: [x, y, z, w],
            ..
        }) = *request.command()
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
