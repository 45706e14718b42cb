//! Fault tolerance: processes that are killed, stopped, or cannot start. Acknowledged
//! changes survive, the daemon recovers, and nothing is left behind.

use crate::daemon::{
    Daemon, Sandbox, WATCHDOG, WITH_CAMERA, eventually, nearest, send_signal, suspend, wait_for_end,
};
use crate::skeleton::{id, place_of, wait_for_all};
use message::ProcessKind;
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::os::unix::fs::MetadataExt;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::time::Duration;

/// The synthetic table at a low rate, since several daemons share the cores.
const TABLE: [&str; 4] = ["--source", "synthetic:0", "--rate", "10"];
/// Pause between kills, in which a process can work. One that ends again within 10 s is
/// restarted after a longer delay.
const BETWEEN_KILLS: Duration = Duration::from_secs(1);

/// Teaches the labels of two objects.
fn teach_two(daemon: &Daemon<'_>) {
    let objects = wait_for_all(daemon, 0);
    for (name, label) in [("mug", "mug"), ("box", "cereal box")] {
        let report = daemon.ask(&["teach", &id(nearest(&objects, place_of(0, name))), label]);
        assert!(report["n_views_changed"].as_u64().unwrap() > 0, "{report}");
    }
}

/// Waits until all objects are tracked and the taught ones are labelled.
fn wait_for_names(daemon: &Daemon<'_>) {
    wait_for_all(daemon, 0);
    let is_named = |objects: &[Value], name: &str, label: &str| {
        !objects.is_empty() && nearest(objects, place_of(0, name))["label"] == label
    };
    let objects = daemon.wait_for("what was taught is named", |objects| {
        is_named(objects, "mug", "mug") && is_named(objects, "box", "cereal box")
    });
    let ball = nearest(&objects, place_of(0, "ball"));
    assert_eq!(ball["label"], Value::Null, "{objects:#?}");
}

/// Number of frames that a process has handled since its start.
pub(crate) fn n_frames(daemon: &Daemon<'_>, process: ProcessKind) -> u64 {
    let health = daemon.health(process.word());
    health
        .and_then(|health| health["frames"].as_u64())
        .unwrap_or(0)
}

/// Waits until a process has handled more frames.
pub(crate) fn wait_for_frames(daemon: &Daemon<'_>, process: ProcessKind) {
    let before = n_frames(daemon, process);
    let what = format!("tabula-{} handles frames", process.word());
    eventually(&what, || n_frames(daemon, process) > before + 5);
}

/// Kills a process and waits for its replacement.
fn kill(daemon: &Daemon<'_>, process: ProcessKind) {
    let mut killed = None;
    eventually("the process reports its id", || {
        killed = daemon.pid(process);
        killed.is_some()
    });
    kill_pid(killed.unwrap());
    eventually("the process is started again", || {
        daemon.pid(process).is_some_and(|pid| Some(pid) != killed)
    });
}

/// Kills a process that may have ended already.
fn kill_pid(pid: u32) {
    let _ = send_signal(pid, Signal::KILL);
}

/// Number of stored views of each category.
fn categories(daemon: &Daemon<'_>) -> BTreeMap<String, u64> {
    let document = daemon.ask(&["categories"]);
    let all = document["categories"].as_array().unwrap().iter();
    all.map(|one| {
        (
            one["category"].as_str().unwrap().to_owned(),
            one["n_views"].as_u64().unwrap(),
        )
    })
    .collect()
}

/// Pseudo-random number generator (xorshift64) with a fixed seed.
struct XorShift(u64);

impl XorShift {
    fn below(&mut self, limit: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 % limit
    }
}

#[test]
fn killed_process_is_restarted_and_labels_are_recognised() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    teach_two(&daemon);
    for process in WITH_CAMERA {
        let others = || -> Vec<_> {
            let pids = WITH_CAMERA.into_iter().zip(daemon.pids());
            pids.filter(|(other, _)| *other != process).collect()
        };
        let before = others();
        kill(&daemon, process);
        wait_for_frames(&daemon, ProcessKind::CAMERA);
        wait_for_frames(&daemon, ProcessKind::PERCEPTION);
        wait_for_names(&daemon);
        assert_eq!(
            before,
            others(),
            "the others live on when {process:?} is killed"
        );
    }
    daemon.stop();
}

#[test]
fn acknowledged_labels_survive_kill_9_of_the_memory() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    let objects = wait_for_all(&daemon, 0);
    let mug = id(nearest(&objects, place_of(0, "mug")));
    for round in 0..5 {
        let label = format!("mug {round}");
        eventually("the correction is acknowledged", || {
            sandbox.tabula(&["correct", &mug, &label]).status.success()
        });
        kill(&daemon, ProcessKind::MEMORY);
        eventually("the memory answers", || {
            sandbox.tabula(&["categories"]).status.success()
        });
        let known = categories(&daemon);
        assert_eq!(
            known.keys().collect::<Vec<_>>(),
            [&label],
            "acknowledged, then killed"
        );
        assert!(known[&label] > 0, "{known:?}");
    }
    daemon.stop();
    let daemon = sandbox.start(&TABLE);
    assert!(categories(&daemon).contains_key("mug 4"));
    daemon.wait_for("the last name is the one that counts", |objects| {
        !objects.is_empty() && nearest(objects, place_of(0, "mug"))["label"] == "mug 4"
    });
    daemon.stop();
}

#[test]
fn children_end_when_tabula_run_is_killed() {
    let sandbox = Sandbox::new();
    let mut daemon = sandbox.start(&TABLE);
    teach_two(&daemon);
    daemon.signal_parent(Signal::KILL);
    assert!(!daemon.wait(WATCHDOG).success());
    eventually("the children follow their parent", || sandbox.is_deserted());
    let daemon = sandbox.start(&TABLE);
    wait_for_names(&daemon);
    daemon.stop();
}

/// Kills `tabula run` at random times while it starts.
fn kill_while_starting(n_rounds: u32) {
    let sandbox = Sandbox::new();
    let mut dice = XorShift(0x5eed);
    for _ in 0..n_rounds {
        let mut run = sandbox.launch(&TABLE);
        std::thread::sleep(Duration::from_millis(dice.below(400)));
        run.kill().unwrap();
        run.wait().unwrap();
        eventually("no child outlives its parent", || sandbox.is_deserted());
    }
    let daemon = sandbox.start(&TABLE);
    wait_for_all(&daemon, 0);
    daemon.stop();
}

#[test]
fn children_end_when_tabula_run_is_killed_while_starting() {
    kill_while_starting(8);
}

#[test]
#[ignore = "long"]
fn long_children_end_when_tabula_run_is_killed_while_starting() {
    kill_while_starting(100);
}

#[test]
fn shared_memory_of_a_crash_is_removed_at_the_next_start() {
    let sandbox = Sandbox::new();
    let mut daemon = sandbox.start(&TABLE);
    teach_two(&daemon);
    // The parent first, so that it has no time to clean up; nor have the children,
    // which are told to stop when it dies.
    let children = sandbox.processes();
    assert_eq!(children.len(), WITH_CAMERA.len());
    for pid in &children {
        suspend(*pid);
    }
    daemon.signal_parent(Signal::KILL);
    children.into_iter().for_each(kill_pid);
    daemon.wait(WATCHDOG);
    eventually("all are dead", || sandbox.is_deserted());
    let left = files_and_inodes(&sandbox);
    assert!(left.len() > 10, "a crash leaves shared memory: {left:?}");
    let doctor = sandbox.tabula(&["doctor"]);
    let findings = String::from_utf8(doctor.stdout).unwrap();
    assert!(findings.contains("crashed run has left"), "{findings}");

    let daemon = sandbox.start(&TABLE);
    let kept: Vec<_> = files_and_inodes(&sandbox)
        .intersection(&left)
        .cloned()
        .collect();
    assert!(
        kept.is_empty(),
        "what the crash left is still there: {kept:?}"
    );
    wait_for_names(&daemon);
    daemon.stop();
}

/// Shared memory files of the domain; the inode distinguishes files of the same name.
fn files_and_inodes(sandbox: &Sandbox) -> BTreeSet<(String, u64)> {
    let files = sandbox.shared_memory_files().into_iter();
    files
        .filter_map(|name| {
            let file = std::fs::metadata(Path::new("/dev/shm").join(&name)).ok()?;
            Some((name, file.ino()))
        })
        .collect()
}

/// Labels that were sent for one track.
#[derive(Debug, Default)]
struct LabelHistory {
    /// Last label that was acknowledged.
    acknowledged: Option<String>,
    /// Later labels without an answer, since the memory was killed.
    in_doubt: Vec<String>,
}

impl LabelHistory {
    /// Corrects the label of the track.
    fn correct(&mut self, sandbox: &Sandbox, track: &str, label: String) {
        let output = sandbox.tabula(&["correct", track, &label]);
        match output.status.code() {
            Some(0) => {
                *self = Self {
                    acknowledged: Some(label),
                    in_doubt: Vec::new(),
                }
            }
            // Refused: the memory knows no view of this track, and says so.
            Some(4) => {}
            _ => self.in_doubt.push(label),
        }
    }

    /// Asserts that the track has the last acknowledged label, or a later one.
    fn check(&self, known: &BTreeMap<String, u64>) {
        if let Some(acknowledged) = &self.acknowledged {
            let mut possible = self.in_doubt.iter().chain([acknowledged]);
            assert!(
                possible.any(|label| known.get(label).is_some_and(|n| *n > 0)),
                "{self:?} is not in {known:?}"
            );
        }
    }
}

/// Kills random processes while labels are taught.
fn kill_at_random(n_kills: u32) {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    let first = id(&wait_for_all(&daemon, 0)[0]);
    let mut dice = XorShift(0xfa17);
    let mut lessons: BTreeMap<String, LabelHistory> = BTreeMap::new();
    // At least one label is acknowledged, on however busy a computer.
    daemon.ask(&["correct", &first, "first"]);
    let acknowledged = LabelHistory {
        acknowledged: Some("first".to_owned()),
        in_doubt: Vec::new(),
    };
    lessons.insert(first, acknowledged);
    for round in 0..n_kills {
        let process = WITH_CAMERA[dice.below(WITH_CAMERA.len() as u64) as usize];
        let mut victim = None;
        eventually("the process reports its id", || {
            victim = daemon.pid(process);
            victim.is_some()
        });
        let pause = Duration::from_millis(dice.below(60));
        std::thread::scope(|scope| {
            scope.spawn(|| {
                std::thread::sleep(pause);
                kill_pid(victim.unwrap());
            });
            for lesson in 0..4 {
                let objects = objects_if_any(&sandbox);
                let Some(object) = objects.get(dice.below(5) as usize) else {
                    continue;
                };
                let label = format!("round {round} lesson {lesson}");
                lessons
                    .entry(id(object))
                    .or_default()
                    .correct(&sandbox, &id(object), label);
            }
        });
        std::thread::sleep(BETWEEN_KILLS);
    }
    let handles_frames = |process: &ProcessKind| *process != ProcessKind::GATEWAY;
    for process in WITH_CAMERA.into_iter().filter(handles_frames) {
        wait_for_frames(&daemon, process);
    }
    let known = categories(&daemon);
    for lessons in lessons.values() {
        lessons.check(&known);
    }
    daemon.stop();
    let daemon = sandbox.start(&TABLE);
    assert_eq!(categories(&daemon), known, "a restart changes nothing");
    wait_for_all(&daemon, 0);
    daemon.stop();
}

/// Tracked objects; none while a process restarts.
fn objects_if_any(sandbox: &Sandbox) -> Vec<Value> {
    let output = sandbox.tabula(&["objects", "--json"]);
    let document: Value = serde_json::from_slice(&output.stdout).unwrap_or_default();
    document["objects"].as_array().cloned().unwrap_or_default()
}

#[test]
fn kills_at_random_instants_lose_nothing_acknowledged() {
    kill_at_random(6);
}

#[test]
#[ignore = "long"]
fn long_kills_at_random_instants_lose_nothing_acknowledged() {
    kill_at_random(100);
}

#[test]
fn a_stopped_perception_blocks_neither_camera_nor_memory_and_is_replaced() {
    let sandbox = Sandbox::new();
    // Time for what is asked meanwhile, on however busy a computer.
    sandbox.configure("[run]\nwatchdog_s = 30.0\nmemory_watchdog_s = 30.0");
    let daemon = sandbox.start(&TABLE);
    teach_two(&daemon);
    let mug = id(nearest(&daemon.objects(), place_of(0, "mug")));
    let perception = daemon.pid(ProcessKind::PERCEPTION).unwrap();
    suspend(perception);
    wait_for_frames(&daemon, ProcessKind::CAMERA);
    let report = daemon.ask(&["correct", &mug, "cup"]);
    assert_eq!(report["category"], "cup");
    assert!(categories(&daemon).contains_key("cup"));
    let (_, sentence) = daemon.refused(&["objects"]);
    assert!(sentence.contains("no answer within"), "{sentence}");
    wait_for_frames(&daemon, ProcessKind::CAMERA);
    eventually("perception is replaced", || {
        let pid = daemon.pid(ProcessKind::PERCEPTION);
        pid.is_some_and(|pid| pid != perception)
    });
    wait_for_frames(&daemon, ProcessKind::PERCEPTION);
    daemon.wait_for(
        "perception goes on with what was taught meanwhile",
        |objects| !objects.is_empty() && nearest(objects, place_of(0, "mug"))["label"] == "cup",
    );
    daemon.stop();
}

#[test]
fn stopped_memory_times_out_with_a_sentence_and_continues_afterwards() {
    let sandbox = Sandbox::new();
    sandbox.configure(
        "[run]\nwatchdog_s = 3600.0\nmemory_watchdog_s = 3600.0\nstartup_watchdog_s = 3600.0",
    );
    let daemon = sandbox.start(&TABLE);
    teach_two(&daemon);
    let memory = daemon.pid(ProcessKind::MEMORY).unwrap();
    suspend(memory);
    let (code, sentence) = daemon.refused(&["categories"]);
    assert_eq!(code, 5, "{sentence}");
    assert!(
        sentence.contains("no answer within 4 s from tabula-memory"),
        "{sentence}"
    );
    send_signal(memory, Signal::CONT).unwrap();
    wait_for_frames(&daemon, ProcessKind::MEMORY);
    wait_for_names(&daemon);
    daemon.stop();
}

#[test]
fn a_running_daemon_ends_on_sigterm_and_sigint() {
    for signal in [Signal::TERM, Signal::INT] {
        let sandbox = Sandbox::new();
        let mut daemon = sandbox.start(&TABLE);
        wait_for_all(&daemon, 0);
        daemon.signal_parent(signal);
        let status = daemon.wait(WATCHDOG);
        assert!(status.success(), "{signal:?}: {status}\n{}", daemon.log());
        assert_nothing_is_left(&sandbox);
    }
}

fn assert_nothing_is_left(sandbox: &Sandbox) {
    eventually("all processes have ended", || sandbox.is_deserted());
    assert_eq!(sandbox.shared_memory_files(), Vec::<String>::new());
    assert!(!sandbox.run_folder().domain_folder(&sandbox.domain).exists());
}

/// True if the tests ignore a signal, and so do the programs they start until they handle
/// it, as for SIGINT in a script's background jobs.
fn is_ignored(signal: Signal) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = u64::from_str_radix(mask.unwrap().trim(), 16).unwrap();
    mask >> (signal.as_raw() - 1) & 1 == 1
}

#[test]
fn a_starting_daemon_ends_on_sigterm_and_sigint() {
    let sandbox = Sandbox::new();
    let mut dice = XorShift(0x57a7);
    let ends_at_sigint = !is_ignored(Signal::INT);
    for round in 0..10 {
        let mut run = sandbox.launch(&TABLE);
        std::thread::sleep(Duration::from_millis(dice.below(500)));
        let pid = Pid::from_child(&run);
        let signal = if round % 2 == 0 || !ends_at_sigint {
            Signal::TERM
        } else {
            Signal::INT
        };
        kill_process(pid, signal).unwrap();
        let status = wait_for_end(&mut run, WATCHDOG).unwrap_or_else(|| {
            let _ = run.kill();
            panic!("it does not stop after {signal:?}")
        });
        // Before it has made anything, the signal ends it as it ends any program.
        let is_clean = status.success() || status.signal() == Some(signal.as_raw());
        assert!(is_clean, "{signal:?}: {status}");
        assert_nothing_is_left(&sandbox);
    }
}

#[test]
fn a_stopped_child_does_not_keep_the_daemon_from_ending() {
    for process in WITH_CAMERA {
        let sandbox = Sandbox::new();
        let daemon = sandbox.start(&TABLE);
        wait_for_all(&daemon, 0);
        suspend(daemon.pid(process).unwrap());
        daemon.stop();
    }
}
