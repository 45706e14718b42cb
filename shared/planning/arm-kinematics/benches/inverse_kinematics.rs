//! Benchmarks of inverse kinematics, line planning and link capsules.

use arm_kinematics::{
    Arm, HOME, IkConfig, JointVector, LineTrajectory, inverse_kinematics, link_capsules,
};
use divan::{Bencher, black_box};
use geometry::RigidTransform;
use nalgebra::{UnitQuaternion, Vector3};
use std::f64::consts::PI;

fn main() {
    divan::main();
}

fn downward(x: f64, z: f64) -> RigidTransform {
    let flipped = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI);
    RigidTransform::from_parts([x, 0.1, z].into(), flipped)
}

#[divan::bench(args = [0.4, 2.0])]
fn pose(bencher: Bencher<'_, '_>, x: f64) {
    let (arm, home, config) = (Arm::jaco_like(), HOME.into(), IkConfig::default());
    let target = downward(x, 0.1);
    bencher.bench_local(|| inverse_kinematics(&arm, black_box(&target), &home, &config));
}

#[divan::bench]
fn is_reachable(bencher: Bencher<'_, '_>) {
    let (arm, target) = (Arm::jaco_like(), downward(0.4, 0.1));
    bencher.bench_local(|| arm.can_reach(black_box(&target)));
}

#[divan::bench]
fn line_of_100_mm(bencher: Bencher<'_, '_>) {
    let (arm, home, config) = (Arm::jaco_like(), HOME.into(), IkConfig::default());
    let start = inverse_kinematics(&arm, &downward(0.4, 0.2), &home, &config)
        .expect("the pose is well within reach")
        .joints_rad;
    let target = downward(0.4, 0.1);
    bencher.bench_local(|| LineTrajectory::plan(&arm, &start, black_box(&target), 1.0));
}

#[divan::bench]
fn capsules(bencher: Bencher<'_, '_>) {
    let (arm, joints) = (Arm::jaco_like(), JointVector::from(HOME));
    bencher.bench_local(|| link_capsules(&arm, black_box(&joints), 0.1));
}
