//! Conformance of drivers of an arm: the simulated arm and the skeleton pass `tabula arm check`, and
//! drivers that ignore what must end a motion fail it.

use crate::daemon::{Daemon, Sandbox, arm_skeleton, eventually};
use crate::simulation::{CARTON, scene_file};
use arm_driver::{Arm, ArmReading, BrakingCause, CyclicArm};
use channel::{Domain, Role};
use control_protocol::ArmMotion;
use message::{ProcessKind, WireCapsule};
use motors::Integrator;
use rustix::process::Signal;
use serde_json::Value;
use service::{Context, HealthCounters, Home, Shutdown, ShutdownTrigger};
use skeleton_arm::SkeletonArm;
use std::sync::Arc;
use tokio::runtime::Runtime;

#[path = "../../shared/platform/arm-driver/examples/arm_skeleton/motors.rs"]
mod motors;
#[path = "../../shared/platform/arm-driver/examples/arm_skeleton/skeleton_arm.rs"]
mod skeleton_arm;

/// Table that costs little beside a loop that must be on time.
const TABLE: [&str; 4] = ["--source", "synthetic", "--rate", "5"];
/// Exit code of a check that has failed.
const FAILURE: i32 = 1;

/// Exit code of `tabula arm check`, and its document.
fn check(daemon: &Daemon<'_>) -> (Option<i32>, Value) {
    let arguments = ["--json", "arm", "check", "--yes"];
    let output = daemon.sandbox.tabula(&arguments);
    let document: Value = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|_| panic!("{output:?}\n{}", daemon.log()));
    (output.status.code(), document)
}

/// Names of the checks that have failed. Each has its sentence, which is printed.
fn failed(document: &Value) -> Vec<String> {
    let checks = document["checks"].as_array().unwrap();
    assert!(checks.len() >= 13, "{document:#}");
    let mut failed = Vec::new();
    for check in checks {
        let word = |key: &str| check[key].as_str().unwrap().to_owned();
        println!(
            "{} {}: {}",
            word("verdict"),
            word("check"),
            word("sentence")
        );
        assert!(word("sentence").split(' ').count() > 2, "{check}");
        if word("verdict") == "failed" {
            failed.push(word("check"));
        }
    }
    assert_eq!(document["n_failed"], failed.len());
    failed
}

fn assert_passes(daemon: &Daemon<'_>) {
    let (code, document) = check(daemon);
    assert_eq!(failed(&document), Vec::<String>::new(), "{}", daemon.log());
    assert_eq!(code, Some(0));
}

#[test]
fn simulated_arm_passes_the_conformance_check() {
    let sandbox = Sandbox::new();
    let (_scene, source) = scene_file(CARTON);
    let daemon = sandbox.start(&["--source", &source, "--rate", "10"]);
    let (code, sentence) = daemon.refused(&["arm", "check"]);
    assert_eq!(code, 2, "{sentence}");
    assert!(sentence.contains("moves the arm"), "{sentence}");
    assert_passes(&daemon);
    daemon.stop();
}

#[test]
fn skeleton_driver_passes_the_conformance_check_beside_a_camera() {
    let sandbox = Sandbox::new();
    let driver = arm_skeleton();
    let with_driver = [&TABLE[..], &["--arm-driver", driver.to_str().unwrap()]].concat();
    let daemon = sandbox.start(&with_driver);
    assert_passes(&daemon);
    // A daemon with an arm carries out tasks.
    assert!(daemon.pid(ProcessKind::EXECUTIVE).is_some());
    assert_eq!(daemon.ask(&["task", "state"])["task_id"], Value::Null);
    let doctor = daemon.sandbox.tabula(&["doctor"]);
    let doctor = String::from_utf8(doctor.stdout).unwrap();
    assert!(doctor.contains("6 of 6 processes report"), "{doctor}");
    // A driver that dies is started again, and requests are its own again.
    let killed = daemon.pid(ProcessKind::ARM).unwrap();
    daemon.signal(ProcessKind::ARM, Signal::KILL);
    eventually("another driver answers", || {
        let pid = daemon.pid(ProcessKind::ARM);
        let state = daemon.sandbox.tabula(&["arm", "state"]);
        pid.is_some_and(|pid| pid != killed) && state.status.success()
    });
    daemon.stop();
}

#[test]
fn driver_that_is_not_there_is_told_before_the_daemon_starts() {
    let sandbox = Sandbox::new();
    let arguments = [
        &["run"],
        &TABLE[..],
        &["--arm-driver", "/nowhere/tabula-arm"],
    ]
    .concat();
    let output = sandbox.tabula(&arguments);
    let sentence = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{sentence}");
    assert!(sentence.contains("/nowhere/tabula-arm"), "{sentence}");
}

/// Skeleton that ignores one cause of a braking.
struct BrokenArm {
    arm: SkeletonArm<Integrator>,
    ignored: BrakingCause,
}

impl Arm for BrokenArm {
    fn begin(&mut self, motion: &ArmMotion, arrived_ns: u64) -> Result<(), String> {
        self.arm.begin(motion, arrived_ns)
    }

    fn brake(&mut self, cause: BrakingCause) {
        if cause != self.ignored {
            self.arm.brake(cause);
        }
    }

    fn reading(&self) -> Result<ArmReading, String> {
        self.arm.reading()
    }
}

impl CyclicArm for BrokenArm {
    fn cycle(&mut self, now_ns: u64) -> Result<(), String> {
        self.arm.cycle(now_ns)
    }

    fn capsules(&self) -> Vec<WireCapsule> {
        self.arm.capsules()
    }
}

/// Driver in this process, until it is dropped.
struct OwnDriver {
    trigger: ShutdownTrigger,
    runtime: Runtime,
    ended: Option<tokio::task::JoinHandle<Result<(), service::Failure>>>,
}

impl OwnDriver {
    fn start(sandbox: &Sandbox, arm: impl CyclicArm + Send + 'static) -> Self {
        let runtime = Runtime::new().unwrap();
        let entered = runtime.enter();
        let role = Role::Only("tabula-arm");
        let domain = Domain::join(&sandbox.domain, &sandbox.run_folder(), role).unwrap();
        let (trigger, shutdown) = Shutdown::new();
        let context = Context {
            process: ProcessKind::ARM,
            domain,
            home: Home::at(sandbox.home().to_owned()),
            shutdown,
            health: Arc::new(HealthCounters::default()),
        };
        let ended = Some(runtime.spawn(arm_driver::run(context, arm)));
        drop(entered);
        Self {
            trigger,
            runtime,
            ended,
        }
    }
}

impl Drop for OwnDriver {
    fn drop(&mut self) {
        self.trigger.request();
        if let Some(ended) = self.ended.take() {
            let _ = self.runtime.block_on(ended);
        }
    }
}

fn failed_of_driver_without(ignored: BrakingCause) -> Vec<String> {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    let (_, sentence) = daemon.refused(&["arm", "state"]);
    assert!(sentence.contains("this daemon has no arm"), "{sentence}");
    let arm = SkeletonArm::new(Integrator::at_home()).unwrap();
    let driver = OwnDriver::start(&sandbox, BrokenArm { arm, ignored });
    eventually("the driver answers", || {
        daemon.sandbox.tabula(&["arm", "state"]).status.success()
    });
    let (code, document) = check(&daemon);
    assert_eq!(code, Some(FAILURE), "{document:#}");
    let failed = failed(&document);
    drop(driver);
    daemon.stop();
    failed
}

#[test]
fn driver_that_ignores_the_lease_fails_the_conformance_check() {
    let failed = failed_of_driver_without(BrakingCause::Silence);
    assert_eq!(failed, ["silence"]);
}

#[test]
fn driver_that_ignores_the_stop_word_fails_the_conformance_check() {
    let failed = failed_of_driver_without(BrakingCause::Stop);
    assert_eq!(failed, ["stop word", "stop request", "resumption"]);
}
