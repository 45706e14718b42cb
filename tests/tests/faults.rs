//! Faults: processes that are killed, stopped, or can not start. What was
//! acknowledged stays, the daemon comes back, and nothing is left behind.

use crate::daemon::{
    Daemon, PATIENCE, Place, WITH_CAMERA, eventually, nearest, run_to_end, wait_for_end,
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

/// The synthetic table, slowly: several daemons share the machine's cores.
const TABLE: [&str; 4] = ["--source", "synthetic:0", "--rate", "10"];
/// The daemon gives up when one process ends more than 30 times in a minute; a kill
/// a second among three stays below it.
const BETWEEN_KILLS: Duration = Duration::from_secs(1);

/// Teaches the names of two objects.
fn teach_two(daemon: &Daemon<'_>) {
    let objects = wait_for_all(daemon, 0);
    for (name, label) in [("mug", "mug"), ("box", "cereal box")] {
        let report = daemon.ask(&["teach", &id(nearest(&objects, place_of(0, name))), label]);
        assert!(report["n_views_changed"].as_u64().unwrap() > 0, "{report}");
    }
}

/// Waits until all objects are tracked and those that were taught have their names.
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

/// Number of frames a process has handled since its start.
fn n_frames(daemon: &Daemon<'_>, process: ProcessKind) -> u64 {
    let health = daemon.health(process.name());
    health
        .and_then(|health| health["frames"].as_u64())
        .unwrap_or(0)
}

/// Waits until a process has handled more frames.
fn wait_for_frames(daemon: &Daemon<'_>, process: ProcessKind) {
    let before = n_frames(daemon, process);
    let what = format!("tabula-{} handles frames", process.name());
    eventually(&what, || n_frames(daemon, process) > before + 5);
}

/// Kills a process and waits until another one has taken its place.
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
    signal_pid(pid, Signal::KILL);
}

fn signal_pid(pid: u32, signal: Signal) {
    let _ = kill_process(Pid::from_raw(pid.cast_signed()).unwrap(), signal);
}

/// Views of each category.
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

/// Numbers that are the same in each run.
struct Dice(u64);

impl Dice {
    fn below(&mut self, limit: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 % limit
    }
}

#[test]
fn a_killed_process_is_restarted_and_what_was_taught_is_recognised() {
    let place = Place::new();
    let daemon = place.start(&TABLE);
    teach_two(&daemon);
    for process in WITH_CAMERA {
        let others = || {
            WITH_CAMERA
                .into_iter()
                .filter(move |other| *other != process)
        };
        let before: Vec<_> = others().map(|other| daemon.pid(other)).collect();
        kill(&daemon, process);
        wait_for_frames(&daemon, ProcessKind::Camera);
        wait_for_frames(&daemon, ProcessKind::Perception);
        wait_for_names(&daemon);
        let after: Vec<_> = others().map(|other| daemon.pid(other)).collect();
        assert_eq!(
            before, after,
            "the others live on when {process:?} is killed"
        );
    }
    daemon.stop();
}

#[test]
fn what_was_acknowledged_survives_kill_9_of_the_memory() {
    let place = Place::new();
    let daemon = place.start(&TABLE);
    let objects = wait_for_all(&daemon, 0);
    let mug = id(nearest(&objects, place_of(0, "mug")));
    for round in 0..5 {
        let label = format!("mug {round}");
        eventually("the correction is acknowledged", || {
            place.tabula(&["correct", &mug, &label]).status.success()
        });
        kill(&daemon, ProcessKind::Memory);
        eventually("the memory answers", || {
            place.tabula(&["categories"]).status.success()
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
    let daemon = place.start(&TABLE);
    assert!(categories(&daemon).contains_key("mug 4"));
    daemon.wait_for("the last name is the one that counts", |objects| {
        !objects.is_empty() && nearest(objects, place_of(0, "mug"))["label"] == "mug 4"
    });
    daemon.stop();
}

#[test]
fn the_children_end_when_tabula_run_is_killed() {
    let place = Place::new();
    let mut daemon = place.start(&TABLE);
    teach_two(&daemon);
    daemon.signal_parent(Signal::KILL);
    assert!(!daemon.wait(PATIENCE).success());
    eventually("the children follow their parent", || place.is_deserted());
    let daemon = place.start(&TABLE);
    wait_for_names(&daemon);
    daemon.stop();
}

/// `tabula run` is killed while it starts, at instants of a seeded choice.
fn kill_while_starting(n_rounds: u32) {
    let place = Place::new();
    let mut dice = Dice(0x5eed);
    for _ in 0..n_rounds {
        let mut run = place.launch(&TABLE);
        std::thread::sleep(Duration::from_millis(dice.below(400)));
        run.kill().unwrap();
        run.wait().unwrap();
        eventually("no child outlives its parent", || place.is_deserted());
    }
    let daemon = place.start(&TABLE);
    wait_for_all(&daemon, 0);
    daemon.stop();
}

#[test]
fn no_child_outlives_a_parent_that_is_killed_while_it_starts() {
    kill_while_starting(8);
}

#[test]
#[ignore = "long"]
fn long_no_child_outlives_a_parent_that_is_killed_while_it_starts() {
    kill_while_starting(100);
}

#[test]
fn the_next_start_cleans_up_when_everything_was_killed_at_once() {
    let place = Place::new();
    let mut daemon = place.start(&TABLE);
    teach_two(&daemon);
    // The parent first, so that it has no time to clean up; nor have the children,
    // which are told to stop when it dies.
    let children = place.processes();
    assert_eq!(children.len(), WITH_CAMERA.len());
    for pid in &children {
        signal_pid(*pid, Signal::STOP);
    }
    daemon.signal_parent(Signal::KILL);
    children.into_iter().for_each(kill_pid);
    daemon.wait(PATIENCE);
    eventually("all are dead", || place.is_deserted());
    let left = files_and_inodes(&place);
    assert!(left.len() > 10, "a crash leaves shared memory: {left:?}");
    let doctor = place.tabula(&["doctor"]);
    let findings = String::from_utf8(doctor.stdout).unwrap();
    assert!(findings.contains("crashed run has left"), "{findings}");

    let daemon = place.start(&TABLE);
    let kept: Vec<_> = files_and_inodes(&place)
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

/// The domain's files in shared memory; the inode tells a new one of an old name.
fn files_and_inodes(place: &Place) -> BTreeSet<(String, u64)> {
    let files = place.shared_memory_files().into_iter();
    files
        .filter_map(|name| {
            let file = std::fs::metadata(Path::new("/dev/shm").join(&name)).ok()?;
            Some((name, file.ino()))
        })
        .collect()
}

/// What was tried to be taught of one track.
#[derive(Debug, Default)]
struct Lessons {
    /// The last label that was acknowledged.
    acknowledged: Option<String>,
    /// Labels since, of which nobody knows: the memory was killed meanwhile.
    in_doubt: Vec<String>,
}

impl Lessons {
    /// Corrects the name of the track.
    fn correct(&mut self, place: &Place, track: &str, label: String) {
        let output = place.tabula(&["correct", track, &label]);
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

    /// The track must carry what was acknowledged last, or what came later.
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

/// Kills processes of a seeded choice while names are taught all the time.
fn kill_at_random(n_kills: u32) {
    let place = Place::new();
    let daemon = place.start(&TABLE);
    let first = id(&wait_for_all(&daemon, 0)[0]);
    let mut dice = Dice(0xfa17);
    let mut lessons: BTreeMap<String, Lessons> = BTreeMap::new();
    // At least one label is acknowledged, on however busy a computer.
    daemon.ask(&["correct", &first, "first"]);
    let acknowledged = Lessons {
        acknowledged: Some("first".to_owned()),
        in_doubt: Vec::new(),
    };
    lessons.insert(first, acknowledged);
    for round in 0..n_kills {
        let process = WITH_CAMERA[dice.below(3) as usize];
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
                let objects = objects_if_any(&place);
                let Some(object) = objects.get(dice.below(5) as usize) else {
                    continue;
                };
                let label = format!("round {round} lesson {lesson}");
                lessons
                    .entry(id(object))
                    .or_default()
                    .correct(&place, &id(object), label);
            }
        });
        std::thread::sleep(BETWEEN_KILLS);
    }
    for process in WITH_CAMERA {
        wait_for_frames(&daemon, process);
    }
    let known = categories(&daemon);
    for lessons in lessons.values() {
        lessons.check(&known);
    }
    daemon.stop();
    let daemon = place.start(&TABLE);
    assert_eq!(categories(&daemon), known, "a restart changes nothing");
    wait_for_all(&daemon, 0);
    daemon.stop();
}

/// The objects; none while a process is being restarted.
fn objects_if_any(place: &Place) -> Vec<Value> {
    let output = place.tabula(&["objects", "--json"]);
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
fn a_stopped_perception_blocks_neither_camera_nor_memory() {
    let place = Place::new();
    let daemon = place.start(&TABLE);
    teach_two(&daemon);
    let mug = id(nearest(&daemon.objects(), place_of(0, "mug")));
    let perception = daemon.pid(ProcessKind::Perception).unwrap();
    let perception = Pid::from_raw(perception.cast_signed()).unwrap();
    kill_process(perception, Signal::STOP).unwrap();
    wait_for_frames(&daemon, ProcessKind::Camera);
    let report = daemon.ask(&["correct", &mug, "cup"]);
    assert_eq!(report["category"], "cup");
    assert!(categories(&daemon).contains_key("cup"));
    let (_, sentence) = daemon.refused(&["objects"]);
    assert!(sentence.contains("no answer within"), "{sentence}");
    wait_for_frames(&daemon, ProcessKind::Camera);
    kill_process(perception, Signal::CONT).unwrap();
    wait_for_frames(&daemon, ProcessKind::Perception);
    daemon.wait_for(
        "perception goes on with what was taught meanwhile",
        |objects| !objects.is_empty() && nearest(objects, place_of(0, "mug"))["label"] == "cup",
    );
    let pid = daemon.pid(ProcessKind::Perception).unwrap();
    assert_eq!(
        pid,
        perception.as_raw_nonzero().get().cast_unsigned(),
        "it was not restarted"
    );
    daemon.stop();
}

#[test]
fn a_stopped_memory_is_a_sentence_and_goes_on_afterwards() {
    let place = Place::new();
    let daemon = place.start(&TABLE);
    teach_two(&daemon);
    let memory = daemon.pid(ProcessKind::Memory).unwrap();
    let memory = Pid::from_raw(memory.cast_signed()).unwrap();
    kill_process(memory, Signal::STOP).unwrap();
    let (code, sentence) = daemon.refused(&["categories"]);
    assert_eq!(code, 5, "{sentence}");
    assert!(sentence.contains("no answer within"), "{sentence}");
    kill_process(memory, Signal::CONT).unwrap();
    wait_for_frames(&daemon, ProcessKind::Memory);
    wait_for_names(&daemon);
    daemon.stop();
}

#[test]
fn a_process_that_can_not_start_ends_the_daemon_with_a_reason() {
    let place = Place::new();
    // A file where the memory needs a folder stops even root.
    std::fs::write(place.home().join("perceptual-memory"), "not a folder").unwrap();
    let output = run_to_end(place.command("tabula").arg("run").args(TABLE), PATIENCE);
    let sentence = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{sentence}");
    let last = sentence.lines().last().unwrap();
    assert!(
        last.contains("tabula-memory has ended more than 30 times"),
        "{sentence}"
    );
    assert!(last.contains("tabula doctor"), "{sentence}");
    assert!(
        sentence.contains("perceptual-memory"),
        "the cause is named: {sentence}"
    );
    assert!(place.is_deserted());
    assert_eq!(place.shared_memory_files(), Vec::<String>::new());
    assert!(!place.run_folder().of_domain(&place.domain).exists());
}

#[test]
fn a_running_daemon_ends_on_sigterm_sigint_and_sighup() {
    for signal in [Signal::TERM, Signal::INT, Signal::HUP] {
        let place = Place::new();
        let mut daemon = place.start(&TABLE);
        wait_for_all(&daemon, 0);
        daemon.signal_parent(signal);
        let status = daemon.wait(PATIENCE);
        assert!(status.success(), "{signal:?}: {status}\n{}", daemon.log());
        assert_nothing_is_left(&place);
    }
}

fn assert_nothing_is_left(place: &Place) {
    eventually("all processes have ended", || place.is_deserted());
    assert_eq!(place.shared_memory_files(), Vec::<String>::new());
    assert!(!place.run_folder().of_domain(&place.domain).exists());
}

/// Whether these tests ignore a signal, and with them every program they start, until
/// it takes the signal over: so it is with SIGINT in a script's background jobs.
fn is_ignored(signal: Signal) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = u64::from_str_radix(mask.unwrap().trim(), 16).unwrap();
    mask >> (signal.as_raw() - 1) & 1 == 1
}

#[test]
fn a_starting_daemon_ends_on_sigterm_and_sigint() {
    let place = Place::new();
    let mut dice = Dice(0x57a7);
    let ends_at_sigint = !is_ignored(Signal::INT);
    for round in 0..10 {
        let mut run = place.launch(&TABLE);
        std::thread::sleep(Duration::from_millis(dice.below(500)));
        let pid = Pid::from_child(&run);
        let signal = if round % 2 == 0 || !ends_at_sigint {
            Signal::TERM
        } else {
            Signal::INT
        };
        kill_process(pid, signal).unwrap();
        let status = wait_for_end(&mut run, PATIENCE).unwrap_or_else(|| {
            let _ = run.kill();
            panic!("it does not stop after {signal:?}")
        });
        // Before it has made anything, the signal ends it as it ends any program.
        let is_clean = status.success() || status.signal() == Some(signal.as_raw());
        assert!(is_clean, "{signal:?}: {status}");
        assert_nothing_is_left(&place);
    }
}

#[test]
fn a_stopped_child_does_not_keep_the_daemon_from_ending() {
    for process in WITH_CAMERA {
        let place = Place::new();
        let daemon = place.start(&TABLE);
        wait_for_all(&daemon, 0);
        daemon.signal(process, Signal::STOP);
        daemon.stop();
    }
}
