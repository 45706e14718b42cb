//! Supervision of the daemon's processes: one that hangs is replaced, one that ends again and
//! again is restarted for ever and named, and the others go on.

use crate::daemon::{
    Daemon, Sandbox, WATCHDOG, WITH_CAMERA, eventually, send_signal, suspend, wait_for_end,
};
use crate::faults::wait_for_frames;
use message::ProcessKind;
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use std::process::Child;
use std::time::{Duration, Instant};

/// The synthetic table at a low rate, since several daemons share the cores.
const TABLE: [&str; 4] = ["--source", "synthetic:0", "--rate", "10"];
/// Shortest watchdog time that a configuration may have.
const SHORT_WATCHDOG: Duration = Duration::from_secs(4);
const WITH_SHORT_WATCHDOG: &str = "[run]\nwatchdog_s = 4.0\nmemory_watchdog_s = 4.0\n";
/// Restarts without a growing delay, so that there are many in a short time.
const WITH_FAST_RESTARTS: &str = "[run]\nrestart_delay_max_s = 0.05\n";

/// Exit codes of the programs.
const FAILURE: i32 = 1;
const NO_DAEMON: i32 = 3;

/// Document and exit code of `tabula status --json`.
fn status(sandbox: &Sandbox) -> (Value, i32) {
    let output = sandbox.tabula(&["status", "--json"]);
    let document = serde_json::from_slice(&output.stdout).unwrap_or_default();
    (document, output.status.code().unwrap())
}

/// Expected process in a document of `tabula status`.
fn expected(document: &Value, process: ProcessKind) -> Option<Value> {
    let all = document["expected"].as_array()?;
    let found = all.iter().find(|one| one["process"] == process.word());
    found.cloned()
}

/// Sentence about the trouble of a process, when it has any.
fn trouble(document: &Value, process: ProcessKind) -> Option<String> {
    let sentence = expected(document, process)?["trouble"].as_str()?.to_owned();
    (!sentence.is_empty()).then_some(sentence)
}

/// Waits until `tabula status` succeeds, which means that all processes work.
fn wait_until_well(sandbox: &Sandbox) -> Value {
    let mut last = Value::Null;
    eventually("all processes work", || {
        let (document, code) = status(sandbox);
        let states = document["expected"].as_array();
        let run = states.is_some_and(|all| all.iter().all(|one| one["state"] == "running"));
        last = document;
        code == 0 && run
    });
    last
}

/// Waits until objects are tracked: camera, perception and memory work together. How many there
/// are is the matter of other tests.
fn wait_for_objects(daemon: &Daemon<'_>) {
    daemon.wait_for("objects are tracked", |objects| {
        objects.iter().any(|object| object["state"] == "tracked")
    });
}

fn log(sandbox: &Sandbox) -> String {
    std::fs::read_to_string(sandbox.log()).unwrap_or_default()
}

/// Number that follows a part of the log.
fn number_after(log: &str, part: &str) -> f64 {
    let (_, rest) = log.split_once(part).unwrap();
    rest.split_whitespace().next().unwrap().parse().unwrap()
}

/// Stops a process with SIGSTOP and asserts that it is replaced and that everything works again.
fn check_replaced(daemon: &Daemon<'_>, process: ProcessKind) {
    let pid = daemon.pid(process).unwrap();
    let begun = Instant::now();
    suspend(pid);
    let line = format!(
        "{} (process {pid}) has made no progress for",
        process.program()
    );
    eventually("the watchdog finds it", || daemon.log().contains(&line));
    let found_after = begun.elapsed();
    let silence_s = number_after(&daemon.log(), &line);
    assert!(
        silence_s >= SHORT_WATCHDOG.as_secs_f64(),
        "{process:?} was ended after {silence_s} s without progress already"
    );
    eprintln!("{process:?}: stopped, and ended by the watchdog after {found_after:?}");
    let document = wait_until_well(daemon.sandbox);
    let new = expected(&document, process).unwrap()["pid"].as_u64();
    assert_ne!(new, Some(u64::from(pid)), "it is another process");
    let log = daemon.log();
    assert_eq!(log.matches(&line).count(), 1, "{log}");
    let again = format!("{} runs again", process.program());
    assert_eq!(log.matches(&again).count(), 1, "{log}");
}

#[test]
fn stopped_process_is_replaced_and_the_domain_works_again() {
    let sandbox = Sandbox::new();
    sandbox.configure(WITH_SHORT_WATCHDOG);
    let daemon = sandbox.start(&TABLE);
    wait_for_objects(&daemon);
    for process in WITH_CAMERA {
        check_replaced(&daemon, process);
        wait_for_frames(&daemon, ProcessKind::CAMERA);
        wait_for_frames(&daemon, ProcessKind::PERCEPTION);
        wait_for_objects(&daemon);
    }
    daemon.stop();
}

#[test]
fn stopped_simulator_is_replaced_and_sends_frames_again() {
    let sandbox = Sandbox::new();
    sandbox.configure(WITH_SHORT_WATCHDOG);
    let daemon = sandbox.start(&["--source", "simulation:isolated", "--rate", "5"]);
    wait_for_frames(&daemon, ProcessKind::PERCEPTION);
    check_replaced(&daemon, ProcessKind::SIMULATOR);
    wait_for_frames(&daemon, ProcessKind::SIMULATOR);
    wait_for_frames(&daemon, ProcessKind::PERCEPTION);
    daemon.stop();
}

#[test]
fn stopped_process_is_ended_for_a_core_dump_when_configured() {
    let sandbox = Sandbox::new();
    sandbox.configure(&format!("{WITH_SHORT_WATCHDOG}watchdog_core_dump = true\n"));
    let daemon = sandbox.start(&TABLE);
    check_replaced(&daemon, ProcessKind::PERCEPTION);
    assert!(
        daemon.log().contains("ending it with SIGABRT"),
        "{}",
        daemon.log()
    );
    daemon.stop();
}

#[test]
fn wait_for_another_process_is_no_stall() {
    let sandbox = Sandbox::new();
    sandbox.configure(WITH_SHORT_WATCHDOG);
    let daemon = sandbox.start(&["--source", "synthetic:0", "--lockstep"]);
    wait_for_frames(&daemon, ProcessKind::PERCEPTION);
    let pids = |kind| daemon.pid(kind).unwrap();
    let before = [ProcessKind::CAMERA, ProcessKind::PERCEPTION].map(pids);
    // In lockstep all wait for the memory, until it is replaced.
    check_replaced(&daemon, ProcessKind::MEMORY);
    wait_for_frames(&daemon, ProcessKind::PERCEPTION);
    let after = [ProcessKind::CAMERA, ProcessKind::PERCEPTION].map(pids);
    assert_eq!(before, after, "{}", daemon.log());
    daemon.stop();
}

#[test]
fn stalled_process_is_named_and_goes_on_when_it_is_continued_in_time() {
    let sandbox = Sandbox::new();
    sandbox.configure(
        "[run]\nwatchdog_s = 3600.0\nmemory_watchdog_s = 3600.0\nstartup_watchdog_s = 3600.0\n",
    );
    let daemon = sandbox.start(&TABLE);
    wait_until_well(&sandbox);
    let pid = daemon.pid(ProcessKind::PERCEPTION).unwrap();
    suspend(pid);
    eventually("the status names the process", || {
        let (document, code) = status(&sandbox);
        let sentence = trouble(&document, ProcessKind::PERCEPTION).unwrap_or_default();
        code == NO_DAEMON && sentence.contains("has made no progress since")
    });
    let (document, _) = status(&sandbox);
    assert_eq!(trouble(&document, ProcessKind::CAMERA), None);
    let doctor = sandbox.tabula(&["doctor"]);
    let findings = String::from_utf8(doctor.stdout).unwrap();
    assert_eq!(doctor.status.code(), Some(FAILURE), "{findings}");
    assert!(
        findings.contains("FAILURE  processes: tabula-perception"),
        "{findings}"
    );
    send_signal(pid, Signal::CONT).unwrap();
    let document = wait_until_well(&sandbox);
    let same = expected(&document, ProcessKind::PERCEPTION).unwrap()["pid"].as_u64();
    assert_eq!(same, Some(u64::from(pid)), "it was not restarted");
    assert!(sandbox.tabula(&["doctor"]).status.success());
    daemon.stop();
}

/// Daemon that may never be ready as a whole. It is stopped at the end of the test.
struct Launched<'a> {
    sandbox: &'a Sandbox,
    run: Child,
}

impl<'a> Launched<'a> {
    fn new(sandbox: &'a Sandbox) -> Self {
        let run = sandbox.launch(&TABLE);
        Self { sandbox, run }
    }

    /// Waits until a process has ended more than so many times, and returns the status.
    fn wait_for_ends(&mut self, process: ProcessKind, n_ends: u64) -> Value {
        let mut last = Value::Null;
        eventually("it ends again and again", || {
            let ended = self.run.try_wait().unwrap();
            assert!(ended.is_none(), "{ended:?}\n{}", log(self.sandbox));
            last = status(self.sandbox).0;
            expected(&last, process).is_some_and(|one| one["n_ends"].as_u64() > Some(n_ends))
        });
        last
    }

    fn stop(mut self) {
        kill_process(Pid::from_child(&self.run), Signal::INT).unwrap();
        let status = wait_for_end(&mut self.run, WATCHDOG).expect("it stops");
        assert!(status.success(), "{status}\n{}", log(self.sandbox));
        eventually("all processes have ended", || self.sandbox.is_deserted());
        assert_eq!(self.sandbox.shared_memory_files(), Vec::<String>::new());
        let folder = self
            .sandbox
            .run_folder()
            .domain_folder(&self.sandbox.domain);
        assert!(!folder.exists(), "the run folder is left");
    }
}

impl Drop for Launched<'_> {
    fn drop(&mut self) {
        if matches!(self.run.try_wait(), Ok(None)) {
            let _ = kill_process(Pid::from_child(&self.run), Signal::TERM);
            let _ = wait_for_end(&mut self.run, WATCHDOG);
        }
    }
}

/// Pids of processes in a status document.
fn pids(document: &Value, processes: [ProcessKind; 2]) -> [Option<u64>; 2] {
    processes.map(|process| expected(document, process)?["pid"].as_u64())
}

#[test]
fn program_that_ends_at_once_many_times_does_not_stop_the_others() {
    const OTHERS: [ProcessKind; 2] = [ProcessKind::MEMORY, ProcessKind::PERCEPTION];
    let script = "case \"$*\" in *--check-config*) exec \"$REAL\" \"$@\";; esac\nexit 42";
    let sandbox = Sandbox::with_script(ProcessKind::CAMERA, script);
    sandbox.configure(WITH_FAST_RESTARTS);
    let mut launched = Launched::new(&sandbox);
    let early = launched.wait_for_ends(ProcessKind::CAMERA, 5);
    let document = launched.wait_for_ends(ProcessKind::CAMERA, 40);
    assert_eq!(
        pids(&early, OTHERS),
        pids(&document, OTHERS),
        "the others go on"
    );
    assert!(
        sandbox.tabula(&["categories"]).status.success(),
        "the memory answers"
    );
    for process in OTHERS {
        assert_eq!(trouble(&document, process), None, "{document:#}");
    }
    let sentence = trouble(&document, ProcessKind::CAMERA).unwrap();
    assert!(sentence.contains("tabula-camera"), "{sentence}");
    assert!(sentence.contains("exit status: 42"), "{sentence}");
    let text = sandbox.tabula(&["status"]);
    assert_eq!(text.status.code(), Some(NO_DAEMON), "{text:?}");
    let text = String::from_utf8(text.stdout).unwrap();
    assert!(
        text.contains("tabula-camera has not been working since"),
        "{text}"
    );
    let doctor = sandbox.tabula(&["doctor"]);
    assert_eq!(doctor.status.code(), Some(FAILURE), "{doctor:?}");
    let n_lines = log(&sandbox).matches("tabula-camera has ended").count();
    assert!(
        (2..=12).contains(&n_lines),
        "{n_lines} lines\n{}",
        log(&sandbox)
    );
    launched.stop();
}

#[test]
fn process_that_cannot_start_is_retried_until_it_can() {
    let sandbox = Sandbox::new();
    sandbox.configure(WITH_FAST_RESTARTS);
    // A file where the memory needs a folder stops even root.
    let obstacle = sandbox.home().join("perceptual-memory");
    std::fs::write(&obstacle, "not a folder").unwrap();
    let mut launched = Launched::new(&sandbox);
    let document = launched.wait_for_ends(ProcessKind::MEMORY, 3);
    // The memory answers nothing, and still the status names it.
    let sentence = trouble(&document, ProcessKind::MEMORY).unwrap();
    assert!(sentence.contains("tabula-memory"), "{sentence}");
    assert!(sentence.contains("exit status: 1"), "{sentence}");
    assert_eq!(status(&sandbox).1, NO_DAEMON);
    let camera = |document: &Value| expected(document, ProcessKind::CAMERA).unwrap();
    eventually("the camera works without the memory", || {
        camera(&status(&sandbox).0)["state"] == "running"
    });
    let before = camera(&status(&sandbox).0)["pid"].clone();
    assert!(
        log(&sandbox).contains("perceptual-memory"),
        "the cause is named"
    );
    std::fs::remove_file(&obstacle).unwrap();
    let document = wait_until_well(&sandbox);
    assert_eq!(camera(&document)["pid"], before, "the camera went on");
    launched.stop();
}

#[test]
fn process_that_hangs_while_starting_is_replaced_and_those_that_wait_for_it_are_not() {
    // It never reports anything, and perception waits for its track-ids.
    let script = "case \"$*\" in *--check-config*) exec \"$REAL\" \"$@\";; esac\nexec sleep 300";
    let sandbox = Sandbox::with_script(ProcessKind::MEMORY, script);
    sandbox.configure(&format!("{WITH_SHORT_WATCHDOG}startup_watchdog_s = 5.0\n"));
    let mut launched = Launched::new(&sandbox);
    let document = launched.wait_for_ends(ProcessKind::MEMORY, 1);
    let sentence = trouble(&document, ProcessKind::MEMORY).unwrap();
    assert!(sentence.contains("no progress"), "{sentence}");
    for process in [ProcessKind::PERCEPTION, ProcessKind::CAMERA] {
        let others = expected(&document, process).unwrap();
        assert_eq!(others["n_ends"], 0, "{document:#}\n{}", log(&sandbox));
    }
    launched.stop();
}

/// Kills the camera once it has been ready, after which it ends with an exit code, and asserts
/// that it is retried.
fn check_retried_after_readiness(code: i32) {
    let script = "case \"$*\" in *--check-config*) ;; *)\n\
                  [ -e \"$TABULA_HOME/exit-code\" ] && exit $(cat \"$TABULA_HOME/exit-code\");;\n\
                  esac\nexec \"$REAL\" \"$@\"";
    let sandbox = Sandbox::with_script(ProcessKind::CAMERA, script);
    sandbox.configure(WITH_FAST_RESTARTS);
    let daemon = sandbox.start(&TABLE);
    wait_until_well(&sandbox);
    let exit_code = sandbox.home().join("exit-code");
    std::fs::write(&exit_code, code.to_string()).unwrap();
    daemon.signal(ProcessKind::CAMERA, Signal::KILL);
    eventually("it ends with the exit code several times", || {
        let camera = expected(&status(&sandbox).0, ProcessKind::CAMERA);
        camera.is_some_and(|camera| {
            camera["n_ends"].as_u64() > Some(4) && camera["cause"] == format!("exit status: {code}")
        })
    });
    std::fs::remove_file(&exit_code).unwrap();
    wait_until_well(&sandbox);
    wait_for_frames(&daemon, ProcessKind::CAMERA);
    wait_for_objects(&daemon);
    daemon.stop();
}

#[test]
fn usage_and_already_running_are_retried_after_readiness() {
    check_retried_after_readiness(2);
    check_retried_after_readiness(6);
}

#[test]
fn usage_and_already_running_are_final_before_readiness() {
    for code in [2, 6] {
        let script =
            format!("case \"$*\" in *--check-config*) exec \"$REAL\" \"$@\";; esac\nexit {code}");
        let sandbox = Sandbox::with_script(ProcessKind::CAMERA, &script);
        let mut run = sandbox.launch(&TABLE);
        let status = wait_for_end(&mut run, WATCHDOG).unwrap_or_else(|| {
            let _ = kill_process(Pid::from_child(&run), Signal::TERM);
            panic!("it goes on with exit code {code}")
        });
        assert_eq!(status.code(), Some(code), "{}", log(&sandbox));
        assert!(log(&sandbox).contains("tabula-camera cannot run"));
        eventually("all processes have ended", || sandbox.is_deserted());
        assert!(!sandbox.run_folder().domain_folder(&sandbox.domain).exists());
    }
}

#[test]
fn restart_messages_go_to_the_log_only() {
    let sandbox = Sandbox::new();
    let output = std::fs::File::create(sandbox.home().join("stdout.txt")).unwrap();
    let errors = std::fs::File::create(sandbox.log()).unwrap();
    let mut command = sandbox.command("tabula");
    command.arg("run").args(TABLE).stdout(output).stderr(errors);
    let launched = Launched {
        sandbox: &sandbox,
        run: command.spawn().unwrap(),
    };
    let printed = || std::fs::read_to_string(sandbox.home().join("stdout.txt")).unwrap();
    eventually("it is announced", || printed().contains("Ctrl-C stops"));
    let document = wait_until_well(&sandbox);
    let camera = expected(&document, ProcessKind::CAMERA).unwrap()["pid"].as_u64();
    send_signal(camera.unwrap() as u32, Signal::KILL).unwrap();
    eventually("the camera runs again", || {
        log(&sandbox).contains("tabula-camera runs again")
    });
    assert!(log(&sandbox).contains("WARN tabula-camera has ended (signal: 9"));
    launched.stop();
    let printed = printed();
    for word in ["has ended", "runs again", "stopping"] {
        assert!(!printed.contains(word), "{word}: {printed}");
    }
}
