//! Kill tests: SIGKILL at any instant loses nothing acknowledged and leaves nothing half done.

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use perceptual_memory::{Condition, PerceptualMemory, StoreConfig, StoreThread};
use random::Random;

use crate::archiving;
use crate::builders::{correct, folder, name_of, open, store, teach, view};

/// Environment variable with the folder of the child process.
const FOLDER: &str = "TABULA_STORE_KILL_TEST_FOLDER";
const N_TEACHERS: u64 = 4;
const VIEWS_PER_TRACK: u32 = 3;
/// Label of a track after teaching, and after correction.
const NAMES: [&str; 2] = ["Taught", "Corrected"];

/// Endless loop of one teacher: store, teach and correct a track. Prints a line for each
/// acknowledged step.
fn teach_forever(store_handle: &perceptual_memory::StoreHandle) {
    loop {
        let track = store_handle.lease_track_ids_and_wait(1).unwrap();
        let views = (0..VIEWS_PER_TRACK).map(|i| view(track, i, 0)).collect();
        let id = track as u128 * 3;
        let steps = [
            store(id, views),
            teach(id + 1, track, NAMES[0]),
            correct(id + 2, track, NAMES[1]),
        ];
        for (step, mutation) in steps.into_iter().enumerate() {
            store_handle.mutate_and_wait(mutation).unwrap();
            println!("acknowledged {track} {step}");
        }
    }
}

#[test]
#[ignore = "works only as the child of the tests below"]
fn child_teaches_until_killed() {
    let Ok(folder) = std::env::var(FOLDER) else {
        return;
    };
    let config = StoreConfig {
        folder: folder.into(),
        queue_capacity: 16,
        limits: archiving::limits(),
        write_buffer_bytes: perceptual_memory::WRITE_BUFFER_BYTES,
        wall_clock: || 1,
        on_reopened: Box::new(|_| {}),
        on_notice: Box::new(|_| {}),
    };
    let (_thread, handle, report) = StoreThread::start(config).unwrap();
    assert!(!report.is_loss(), "{report}");
    std::thread::scope(|scope| {
        for _ in 0..N_TEACHERS {
            scope.spawn(|| teach_forever(&handle));
        }
    });
}

/// Child process, killed when the test fails.
struct Teacher(Child);

impl Drop for Teacher {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Runs a child for a while, kills it, and returns its acknowledged steps.
fn teach_and_kill(folder: &Path, random: &mut Random) -> BTreeMap<u64, usize> {
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args([
            "--exact",
            "kill::child_teaches_until_killed",
            "--ignored",
            "--nocapture",
        ])
        .env(FOLDER, folder)
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let stdout = child.stdout.take().unwrap();
    let mut child = Teacher(child);
    let (sender, lines) = channel();
    let reader = std::thread::spawn(move || {
        for line in BufReader::new(stdout).lines().map_while(Result::ok) {
            let _ = sender.send(line);
        }
    });
    let mut acknowledged = BTreeMap::new();
    let mut note = |line: String| {
        // The first line comes behind what the test runner prints.
        let Some((_, numbers)) = line.split_once("acknowledged ") else {
            return;
        };
        let mut numbers = numbers.split(' ').map(|n| n.parse::<u64>().unwrap());
        let (track, step) = (numbers.next().unwrap(), numbers.next().unwrap() as usize);
        acknowledged.insert(track, step);
    };
    // Sometimes before it has opened the store, sometimes long after.
    let n_lines = random.below(60);
    for _ in 0..n_lines {
        match lines.recv_timeout(Duration::from_secs(60)) {
            Ok(line) => note(line),
            Err(RecvTimeoutError::Timeout) => panic!("the child does nothing"),
            Err(RecvTimeoutError::Disconnected) => panic!("the child ended by itself"),
        }
    }
    std::thread::sleep(Duration::from_micros(random.below(20_000) as u64));
    child.0.kill().unwrap();
    child.0.wait().unwrap();
    reader.join().unwrap();
    lines.try_iter().for_each(note);
    acknowledged
}

/// Checks that the history is complete, archived or not, and the store holds each acknowledged
/// step, or one more: a line is printed after the step.
fn check(memory: &mut PerceptualMemory, acknowledged: &BTreeMap<u64, usize>) {
    let history = memory.history(1, usize::MAX).unwrap();
    assert!(
        history
            .iter()
            .map(|entry| entry.sequence)
            .eq(1..=memory.sequence())
    );
    let found = memory.checkpoint().unwrap().open().unwrap();
    assert_eq!(found.verify(|_| {}).unwrap().findings, [""; 0]);
    for (&track, &step) in acknowledged {
        let stored = memory.views_of_track(track).unwrap();
        assert_eq!(stored.len(), VIEWS_PER_TRACK as usize, "track {track}");
        let mut names: Vec<Option<&str>> = stored.iter().map(name_of).collect();
        names.dedup();
        assert_eq!(names.len(), 1, "track {track} is half taught: {names:?}");
        let reached = names[0].map_or(0, |name| 1 + NAMES.iter().position(|n| *n == name).unwrap());
        assert!(
            reached == step || reached == step + 1,
            "track {track}: {reached}, told {step}"
        );
        for (i, stored) in (0..).zip(stored) {
            assert_eq!(stored.view, view(track, i, 0));
        }
    }
}

fn check_rounds(n_rounds: usize, seed: u64) {
    let folder = folder();
    let mut random = Random::from_seed(seed);
    let mut acknowledged = BTreeMap::new();
    for round in 0..n_rounds {
        acknowledged.extend(teach_and_kill(folder.path(), &mut random));
        let (mut memory, report) = open(&folder);
        let is_sound = matches!(report.condition, Condition::Sound | Condition::New);
        assert!(is_sound, "round {round}: {report}");
        check(&mut memory, &acknowledged);
    }
    assert!(!acknowledged.is_empty());
}

#[test]
fn kill_loses_nothing_acknowledged() {
    check_rounds(8, 1);
}

#[test]
#[ignore = "long"]
fn long_kill_loses_nothing_acknowledged() {
    for seed in 0..10 {
        check_rounds(40, 100 + seed);
    }
}
