//! Stop of the arm, and its one commander: the stop word from any program and past dead processes,
//! and the lease.

use crate::daemon::{Daemon, Sandbox, eventually, send_signal, suspend};
use crate::gateway::PATIENT;
use crate::simulation::{CARTON, scene_file};
use arm_interface::{StopButton, StopRecord};
use control_protocol::{
    ArmLease, ArmMotion, ArmReport, Refusal, RefusalKind, TypedRequest, request,
};
use daemon_client::DaemonClient;
use message::ProcessKind;
use rustix::process::Signal;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

const WATCHDOG: Duration = Duration::from_secs(10);
/// Period in which a commander renews its lease.
const RENEWAL: Duration = Duration::from_millis(50);
/// Poses between which the arm moves: joint angles of home, and turned by 1.5 rad.
const TURN_RAD: f64 = 1.5;
/// Longest time from a stop to the beginning of braking, nanoseconds: five times the bound of p99,
/// on a machine that does anything.
const BRAKING_LIMIT_NS: u64 = 250_000_000;

/// Number of leases that a commander begins one after another until it gives up.
const N_LEASES: usize = 20;
/// Distance between the numbers of the leases of one commander.
const LEASE_STEP: u64 = 1_000;

/// Commander of the arm: a client with a lease, and with another one where that has ended because
/// the commander was silent, as on a machine that is too busy to renew it in time.
pub(crate) struct Commander<'a> {
    sandbox: &'a Sandbox,
    lease_id: AtomicU64,
    name: String,
}

impl<'a> Commander<'a> {
    pub(crate) fn new(sandbox: &'a Sandbox, id: u64, name: &str) -> Self {
        Self {
            sandbox,
            lease_id: AtomicU64::new(id),
            name: name.to_owned(),
        }
    }

    fn lease(&self) -> ArmLease {
        ArmLease {
            id: self.lease_id.load(Ordering::Acquire),
            holder: self.name.clone(),
        }
    }

    /// Result of an attempt that needs a lease for its whole time, made again with another lease
    /// while it ends because the commander was silent.
    fn leased<T>(&self, attempt: impl Fn() -> Result<T, Refusal>) -> T {
        for _ in 0..N_LEASES {
            match attempt() {
                Ok(result) => return result,
                Err(refusal) if refusal.sentence.contains("silent") => {
                    println!("{}: {refusal}", self.name);
                    self.lease_id.fetch_add(LEASE_STEP, Ordering::AcqRel);
                }
                Err(refusal) => panic!("{}: {refusal}", self.name),
            }
        }
        panic!("no lease of {} lasts for one motion", self.name)
    }

    /// Reply to a request, or the refusal.
    fn ask(&self, request: &TypedRequest<ArmReport>) -> Result<ArmReport, Refusal> {
        let folders = [self.sandbox.run_folder()];
        let client = DaemonClient::connect(&self.sandbox.domain, &folders, WATCHDOG);
        let reply = client.and_then(|mut client| client.call(request.command().clone()));
        request.read(reply.unwrap())
    }

    pub(crate) fn state(&self) -> ArmReport {
        self.ask(&request::arm()).unwrap()
    }

    fn hold(&self) -> Result<ArmReport, Refusal> {
        self.ask(&request::hold_arm(self.lease()))
    }

    /// Turns the arm's first joint.
    fn turn(&self, turn_rad: f64) -> Result<ArmReport, Refusal> {
        let mut angles_rad = self.state().joint_angles_rad;
        angles_rad[0] += turn_rad;
        let motion = ArmMotion::MoveJoints { angles_rad };
        self.begin(motion)
    }

    fn begin(&self, motion: ArmMotion) -> Result<ArmReport, Refusal> {
        self.ask(&request::move_arm(self.lease(), motion))
    }

    /// Begins a motion, and renews the lease until its end.
    pub(crate) fn carry_out(&self, motion: &ArmMotion) -> ArmReport {
        self.leased(|| {
            let mut report = self.begin(motion.clone())?;
            let id = report.command_id;
            while ["moving", "opening", "closing"].contains(&report.activity.as_str()) {
                std::thread::sleep(RENEWAL);
                report = self.hold()?;
            }
            assert_eq!(report.command_id, id);
            Ok(report)
        })
    }

    /// Begins to turn the arm, and waits until it moves.
    fn begin_to_turn(&self, turn_rad: f64) {
        self.leased(|| {
            let start_rad = self.turn(turn_rad)?.joint_angles_rad[0];
            let begun = Instant::now();
            while (self.hold()?.joint_angles_rad[0] - start_rad).abs() <= 0.02 {
                assert!(begun.elapsed() < WATCHDOG, "the arm does not move");
                std::thread::sleep(RENEWAL);
            }
            Ok(())
        });
    }

    /// Renews the lease beside an action, such as a program that takes long to start, until that
    /// has ended.
    fn renewing<T>(&self, action: impl FnOnce() -> T) -> T {
        let has_ended = AtomicBool::new(false);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                // A refusal is what the action may be about: a stop ends the lease.
                while !has_ended.load(Ordering::Acquire) && self.hold().is_ok() {
                    std::thread::sleep(RENEWAL);
                }
            });
            let result = action();
            has_ended.store(true, Ordering::Release);
            result
        })
    }
}

fn folder(sandbox: &Sandbox) -> PathBuf {
    sandbox.run_folder().domain_folder(&sandbox.domain)
}

/// Waits for the record of a stop after which the arm is at rest, and checks its times.
fn wait_for_rest(folder: &Path) -> StopRecord {
    let button = StopButton::open(folder).unwrap();
    let begun = Instant::now();
    loop {
        let record = button.record().unwrap();
        if record.taken == record.pressed && record.rest_ns > 0 {
            println!(
                "braking after {:.1} ms, at rest after {:.1} ms",
                (record.braking_ns - record.pressed) as f64 * 1e-6,
                (record.rest_ns - record.pressed) as f64 * 1e-6
            );
            assert!(
                record.braking_ns - record.pressed < BRAKING_LIMIT_NS,
                "{record:?}"
            );
            assert!(record.rest_ns >= record.braking_ns, "{record:?}");
            return record;
        }
        assert!(
            begun.elapsed() < WATCHDOG,
            "the arm does not rest: {record:?}"
        );
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn start(sandbox: &Sandbox) -> (tempfile::TempDir, Daemon<'_>) {
    let (scene, source) = scene_file(CARTON);
    let daemon = sandbox.start(&["--source", &source]);
    (scene, daemon)
}

/// Moves the arm, stops it by a program, and checks that it has stopped.
fn check_stopped_by(sandbox: &Sandbox, commander: &Commander<'_>, stop: impl FnOnce(&Path)) {
    commander.begin_to_turn(TURN_RAD);
    commander.renewing(|| stop(&folder(sandbox)));
    wait_for_rest(&folder(sandbox));
    let stopped = commander.state();
    assert_eq!(stopped.activity, "stopped");
    assert_eq!(stopped.commander, None, "a stop ends the lease");
    let refusal = commander.hold().unwrap_err();
    assert_eq!(refusal.kind, RefusalKind::Conflict);
    assert!(refusal.sentence.contains("stopped"), "{refusal}");
    std::thread::sleep(Duration::from_millis(300));
    assert_eq!(commander.state().joint_angles_rad, stopped.joint_angles_rad);
}

#[test]
fn ten_lines_of_c_and_of_python_stop_the_arm() {
    let sandbox = Sandbox::new();
    let (_scene, daemon) = start(&sandbox);
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/examples");
    let built = tempfile::tempdir().unwrap();
    let program = built.path().join("stop_arm");
    let compiled = Command::new("cc")
        .arg(examples.join("stop_arm.c"))
        .args([Path::new("-o"), &program])
        .status();
    assert!(compiled.unwrap().success());
    check_stopped_by(&sandbox, &Commander::new(&sandbox, 1, "anna"), |folder| {
        let stopped = Command::new(&program).arg(folder.join("arm-stop")).status();
        assert!(stopped.unwrap().success());
    });
    if Command::new("python3").arg("--version").output().is_ok() {
        check_stopped_by(&sandbox, &Commander::new(&sandbox, 2, "ben"), |folder| {
            let stopped = Command::new("python3")
                .arg(examples.join("stop_arm.py"))
                .arg(folder.join("arm-stop"))
                .status();
            assert!(stopped.unwrap().success());
        });
    } else {
        eprintln!("SKIPPED: the stop by Python, which is not installed");
    }
    daemon.stop();
}

#[test]
fn stop_needs_neither_memory_nor_gateway_nor_perception() {
    let sandbox = Sandbox::new();
    sandbox.configure(PATIENT);
    let (_scene, daemon) = start(&sandbox);
    Commander::new(&sandbox, 1, "anna").begin_to_turn(TURN_RAD);
    let others = [
        ProcessKind::MEMORY,
        ProcessKind::PERCEPTION,
        ProcessKind::GATEWAY,
    ];
    let pids = others.map(|process| daemon.pid(process).unwrap());
    pids.into_iter().for_each(suspend);
    let pressed = StopButton::open(&folder(&sandbox))
        .unwrap()
        .press()
        .unwrap();
    assert_eq!(wait_for_rest(&folder(&sandbox)).pressed, pressed);
    for pid in pids {
        send_signal(pid, Signal::CONT).unwrap();
    }
    daemon.stop();
}

#[test]
fn arm_brakes_when_its_whole_daemon_is_killed() {
    let sandbox = Sandbox::new();
    let (_scene, daemon) = start(&sandbox);
    Commander::new(&sandbox, 1, "anna").begin_to_turn(TURN_RAD);
    let button = StopButton::open(&folder(&sandbox)).unwrap();
    daemon.signal_parent(Signal::KILL);
    // The arm's process brakes before it ends; the file that is open outlives it.
    eventually("the arm is at rest", || {
        let record = button.record().unwrap();
        record.braking_ns > 0 && record.rest_ns >= record.braking_ns
    });
    eventually("all processes have ended", || {
        sandbox.processes().is_empty()
    });
}

#[test]
fn arm_has_one_commander_and_brakes_when_it_is_silent() {
    let sandbox = Sandbox::new();
    let (_scene, daemon) = start(&sandbox);
    let (anna, ben) = (
        Commander::new(&sandbox, 1, "anna"),
        Commander::new(&sandbox, 2, "ben"),
    );
    anna.begin_to_turn(TURN_RAD);
    anna.renewing(|| {
        let refusal = ben.turn(-TURN_RAD).unwrap_err();
        assert_eq!(refusal.kind, RefusalKind::Conflict);
        assert!(refusal.sentence.contains("anna"), "{refusal}");
        let (code, sentence) = daemon.refused(&["arm", "home"]);
        assert_eq!(code, 4, "{sentence}");
        assert!(sentence.contains("commanded by anna"), "{sentence}");
        assert_eq!(ben.state().commander.as_deref(), Some("anna"));
    });
    // Silence.
    eventually("the arm brakes", || ben.state().activity == "stopped");
    let refusal = anna.turn(0.1).unwrap_err();
    assert!(refusal.sentence.contains("silent"), "{refusal}");
    ben.begin_to_turn(-0.2);
    ben.ask(&request::release_arm(2)).unwrap();
    assert_eq!(ben.state().commander, None);
    // Names that would spoil a terminal are none.
    for name in ["", "\u{1b}[2J", &"x".repeat(65)] {
        let refusal = Commander::new(&sandbox, 3, name).hold().unwrap_err();
        assert_eq!(refusal.kind, RefusalKind::Invalid, "{refusal}");
    }
    daemon.stop();
}

#[test]
fn arm_is_stopped_when_somebody_removes_its_stop_word() {
    let sandbox = Sandbox::new();
    let (_scene, daemon) = start(&sandbox);
    let anna = Commander::new(&sandbox, 1, "anna");
    anna.begin_to_turn(TURN_RAD);
    std::fs::remove_file(folder(&sandbox).join("arm-stop")).unwrap();
    eventually("the arm is stopped", || anna.state().activity == "stopped");
    eventually("the log tells it", || daemon.log().contains("stop word"));
    // The next stop works.
    let again = Commander::new(&sandbox, 2, "anna");
    again.begin_to_turn(-TURN_RAD);
    daemon.ask(&["arm", "stop"]);
    wait_for_rest(&folder(&sandbox));
    daemon.stop();
}

#[test]
fn stop_tells_that_the_arm_hangs_and_stops_it_when_it_goes_on() {
    let sandbox = Sandbox::new();
    let (_scene, daemon) = start(&sandbox);
    Commander::new(&sandbox, 1, "anna").begin_to_turn(TURN_RAD);
    let simulator = daemon.pid(ProcessKind::SIMULATOR).unwrap();
    suspend(simulator);
    let (code, sentence) = daemon.refused(&["arm", "stop"]);
    assert!([3, 5].contains(&code), "{code}: {sentence}");
    send_signal(simulator, Signal::CONT).unwrap();
    let button = StopButton::open(&folder(&sandbox)).unwrap();
    eventually("the arm is at rest", || {
        let record = button.record().unwrap();
        record.taken == record.pressed && record.rest_ns > 0
    });
    daemon.stop();
}
