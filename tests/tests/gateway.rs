//! Gateway: a process that is dead, stopped or hung costs only the requests that it owns, and the
//! end of the gateway costs a moment.

use crate::daemon::{Daemon, Sandbox, eventually, send_signal, suspend};
use crate::skeleton::{id, wait_for_all};
use message::ProcessKind;
use rustix::process::Signal;
use std::time::Instant;

/// A simulated table with an arm.
const SIMULATION: [&str; 6] = ["--source", "simulation", "--objects", "3", "--seed", "4"];
/// No process is killed for a lack of progress.
pub(crate) const PATIENT: &str =
    "[run]\nwatchdog_s = 3600.0\nmemory_watchdog_s = 3600.0\nstartup_watchdog_s = 3600.0\n";

/// Requests that the memory does not own are answered.
fn assert_others_answer(daemon: &Daemon<'_>) {
    let objects = daemon.objects();
    assert!(!objects.is_empty(), "{}", daemon.log());
    let object = id(&objects[0]);
    for arguments in [
        &["ask", &object][..],
        &["ask", "--teach-me"],
        &["arm", "state"],
        &["arm", "stop"],
    ] {
        let asked = Instant::now();
        daemon.ask(arguments);
        println!(
            "{arguments:?}: {:.0} ms",
            asked.elapsed().as_secs_f64() * 1e3
        );
    }
    // A process in trouble makes the exit code of `status`, and the others are reported.
    let status = daemon.sandbox.tabula(&["status"]);
    let text = String::from_utf8_lossy(&status.stdout);
    for process in ["gateway", "perception", "simulator"] {
        assert!(text.contains(process), "{text}");
    }
}

#[test]
fn stopped_memory_costs_only_its_own_requests() {
    let sandbox = Sandbox::new();
    sandbox.configure(PATIENT);
    let daemon = sandbox.start(&SIMULATION);
    daemon.wait_for("objects are tracked", |objects| !objects.is_empty());
    let memory = daemon.pid(ProcessKind::MEMORY).unwrap();
    suspend(memory);
    assert_others_answer(&daemon);
    let (code, sentence) = daemon.refused(&["categories"]);
    assert_eq!(code, 5, "{sentence}");
    assert!(sentence.contains("tabula-memory"), "{sentence}");
    assert_others_answer(&daemon);
    send_signal(memory, Signal::CONT).unwrap();
    eventually("the memory answers again", || {
        sandbox.tabula(&["categories"]).status.success()
    });
    daemon.stop();
}

#[test]
fn dead_memory_costs_only_its_own_requests() {
    let script = "[ -e \"$TABULA_HOME/dead\" ] && exit 1\nexec \"$REAL\" \"$@\"";
    let sandbox = Sandbox::with_script(ProcessKind::MEMORY, script);
    let daemon = sandbox.start(&SIMULATION);
    daemon.wait_for("objects are tracked", |objects| !objects.is_empty());
    std::fs::write(sandbox.home().join("dead"), "").unwrap();
    daemon.signal(ProcessKind::MEMORY, Signal::KILL);
    eventually("the memory is refused", || {
        let refused = sandbox.tabula(&["categories"]);
        let sentence = String::from_utf8_lossy(&refused.stderr).into_owned();
        refused.status.code() == Some(3) && sentence.contains("tabula-memory is not running")
    });
    assert_others_answer(&daemon);
    std::fs::remove_file(sandbox.home().join("dead")).unwrap();
    eventually("the memory answers again", || {
        sandbox.tabula(&["categories"]).status.success()
    });
    daemon.stop();
}

#[test]
fn killed_gateway_is_replaced_and_nothing_else_ends() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&["--source", "synthetic:0", "--rate", "10"]);
    let objects = wait_for_all(&daemon, 0);
    daemon.ask(&["teach", &id(&objects[0]), "mug", "--author", "anna"]);
    // The first is the gateway.
    let others = daemon.pids().split_off(1);
    for signal in [Signal::KILL, Signal::ABORT] {
        let before = daemon.pid(ProcessKind::GATEWAY);
        daemon.signal(ProcessKind::GATEWAY, signal);
        eventually("the gateway is another process", || {
            let now = daemon.pid(ProcessKind::GATEWAY);
            now.is_some() && now != before
        });
        // What was acknowledged by the one before is in the answers of this one.
        let label = &daemon.ask(&["ask", &id(&objects[0])])["label"];
        assert_eq!(label, "mug");
    }
    assert_eq!(daemon.pids().split_off(1), others);
    daemon.stop();
}
