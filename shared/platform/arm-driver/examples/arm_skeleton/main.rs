//! Skeleton of a driver for an arm with six motors that take velocities.
//!
//! Copy it, replace [`Integrator`] by what speaks to your motors, and put your arm's dimensions, its
//! place and its limits into [`SkeletonArm::new`]. `tabula run --arm-driver PROGRAM` starts it, and
//! `tabula arm check` checks it.

mod motors;
mod skeleton_arm;

use clap::Parser;
use message::ProcessKind;
use motors::Integrator;
use service::{CountingAllocator, ProcessArguments};
use skeleton_arm::SkeletonArm;
use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

/// Drives an arm that is not there: its motors are integrators.
#[derive(Debug, Parser)]
#[command(name = "tabula-arm", version)]
struct DriverArguments {
    #[command(flatten)]
    process: ProcessArguments,
}

fn main() -> ExitCode {
    let arguments: DriverArguments = service::parse_arguments();
    service::run(
        ProcessKind::ARM,
        &arguments.process,
        |_, _| Ok(()),
        |context, _| async {
            let arm = SkeletonArm::new(Integrator::at_home()).map_err(service::Failure::usage)?;
            arm_driver::run(context, arm).await
        },
    )
}
