//! The memory is killed at random instants while people teach at full speed, and
//! everybody asks again until they are answered: nothing acknowledged is lost,
//! nothing is done twice, nothing is half done.

use crate::daemon::{PATIENCE, Place};
use channel::control::SocketClient;
use message::control::{
    Command, HistoryReport, LearningReport, MemoryAnswer, MemoryQuery, MutationId, RefusalKind,
    Reply, Revision, RevisionChange, StoredView, ViewId,
};
use random::Random;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::process::{Child, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// People who teach at once.
const N_TEACHERS: u64 = 4;
const VIEWS_PER_TRACK: u32 = 3;
/// Until the memory answers again, a teacher asks this often.
const ASK_AGAIN: Duration = Duration::from_millis(3);
/// A life is ended within this after its start, sometimes before it answers.
const LONGEST_LIFE_MS: u64 = 160;

/// The memory alone, killed when it is dropped.
struct Memory(Child);

impl Memory {
    fn start(place: &Place) -> Self {
        let log = std::fs::File::options()
            .create(true)
            .append(true)
            .open(place.log())
            .unwrap();
        let child = place
            .command("tabula-memory")
            .arg(format!("--domain={}", place.domain))
            .stdout(Stdio::null())
            .stderr(log)
            .spawn();
        Self(child.unwrap())
    }
}

impl Drop for Memory {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Asks until it is answered, over as many connections as that takes. The same
/// command, so with the same id.
struct Stubborn<'a> {
    place: &'a Place,
    client: Option<SocketClient>,
}

impl Stubborn<'_> {
    fn ask(&mut self, command: &Command) -> Reply {
        let begin = Instant::now();
        while begin.elapsed() < 2 * PATIENCE {
            match self.try_ask(command) {
                Some(Reply::Refused(refusal)) if refusal.kind == RefusalKind::Unavailable => {}
                Some(reply) => return reply,
                None => self.client = None,
            }
            std::thread::sleep(ASK_AGAIN);
        }
        panic!("the memory does not answer {command:?}");
    }

    fn try_ask(&mut self, command: &Command) -> Option<Reply> {
        if self.client.is_none() {
            let folders = [self.place.run_folder()];
            self.client = SocketClient::connect(&self.place.domain, &folders, PATIENCE).ok();
        }
        self.client.as_mut()?.call(command.clone()).ok()
    }
}

fn id_of(track_id: u64, step: usize) -> MutationId {
    MutationId(u128::from(track_id) << 8 | step as u128)
}

fn view(track_id: u64, view_id: u32) -> StoredView {
    let values = (0..309).map(|i| (track_id + u64::from(view_id) + i) as f32);
    StoredView {
        id: ViewId { track_id, view_id },
        descriptor_kind: "kill-test".into(),
        descriptor: values.flat_map(f32::to_le_bytes).collect(),
        position_m: [0.1, 0.2, 0.3],
        orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
        size_m: [0.1; 3],
        captured_ns: 5,
        frame_sequence: track_id,
        source_name: "kill-test".into(),
        points: Vec::new(),
        mean_rgb: None,
    }
}

/// A category of this many tracks, so that none grows beyond what is kept of one.
fn name(category: &str, track_id: u64) -> String {
    format!("{category} {}", track_id / 100)
}

/// What is done with a track: stored, named, corrected, taken back. Undoing names the
/// entry of the correction.
fn command(track_id: u64, step: usize, corrected: Option<u64>) -> Command {
    let id = id_of(track_id, step);
    let author = format!("teacher {}", track_id % N_TEACHERS);
    let labelling = |category: &str| message::control::Labelling {
        id,
        author: author.clone(),
        track_id,
        category: name(category, track_id),
    };
    match step {
        0 => Command::StoreViews {
            id,
            views: (0..VIEWS_PER_TRACK).map(|i| view(track_id, i)).collect(),
        },
        1 => Command::Teach(labelling("taught")),
        2 => Command::Correct(labelling("corrected")),
        _ => Command::Revise(Revision {
            id,
            author,
            change: RevisionChange::Undo {
                sequence: corrected,
            },
        }),
    }
}

/// Sequence of each acknowledged change; storing views is acknowledged without one.
type Acknowledged = BTreeMap<(u64, usize), Option<u64>>;

/// Teaches one track after the other until told to stop, each of them to its end
/// every second time, else up to the correction.
fn teach(place: &Place, teacher: u64, is_over: &AtomicBool) -> Acknowledged {
    let mut stubborn = Stubborn {
        place,
        client: None,
    };
    let mut acknowledged = Acknowledged::new();
    for round in 0.. {
        let track_id = 1 + teacher + N_TEACHERS * round;
        let mut corrected = None;
        for step in 0..3 + (round as usize % 2) {
            match stubborn.ask(&command(track_id, step, corrected)) {
                Reply::Stored => {
                    acknowledged.insert((track_id, step), None);
                }
                Reply::Learned(LearningReport {
                    sequence,
                    n_views_changed,
                    ..
                }) => {
                    assert_eq!(n_views_changed, u64::from(VIEWS_PER_TRACK));
                    acknowledged.insert((track_id, step), Some(sequence));
                    corrected = Some(sequence);
                }
                other => panic!("track {track_id}, step {step}: {other:?}"),
            }
        }
        if is_over.load(Ordering::Relaxed) {
            break;
        }
    }
    acknowledged
}

fn history(stubborn: &mut Stubborn<'_>) -> Vec<HistoryReport> {
    let mut all: Vec<HistoryReport> = Vec::new();
    loop {
        let from = Some(all.len() as u64 + 1);
        let query = MemoryQuery::History { from, max: 1000 };
        match stubborn.ask(&Command::Memory(query)) {
            Reply::Memory(MemoryAnswer::History { entries, .. }) if entries.is_empty() => {
                return all;
            }
            Reply::Memory(MemoryAnswer::History { entries, .. }) => all.extend(entries),
            other => panic!("{other:?}"),
        }
    }
}

/// Every change that was acknowledged is in the history, where it was told to be,
/// and no change is there twice or was asked for by nobody.
fn check_history(history: &[HistoryReport], acknowledged: &Acknowledged) {
    let ids: Vec<MutationId> = history.iter().filter_map(|entry| entry.mutation).collect();
    let different: BTreeSet<u128> = ids.iter().map(|id| id.0).collect();
    assert_eq!(different.len(), ids.len(), "a change was made twice");
    assert_eq!(ids.len(), history.len());
    let asked: BTreeSet<u128> = acknowledged
        .keys()
        .map(|(track_id, step)| id_of(*track_id, *step).0)
        .collect();
    assert_eq!(different, asked, "exactly what was acknowledged");
    for (&(track_id, step), &sequence) in acknowledged {
        let Some(sequence) = sequence else { continue };
        let entry = &history[sequence as usize - 1];
        assert_eq!(entry.sequence, sequence);
        assert_eq!(entry.mutation, Some(id_of(track_id, step)));
    }
}

/// Every track is called what its last change made it, with all of its views.
fn check_names(place: &Place, acknowledged: &Acknowledged) {
    let output = place.tabula(&["memory", "inspect", "--json"]);
    let document: Value = serde_json::from_slice(&output.stdout).unwrap();
    let mut names: BTreeMap<u64, Vec<String>> = BTreeMap::new();
    for view in document["views"].as_array().unwrap() {
        let track_id = view["id"]["track_id"].as_u64().unwrap();
        let name = view["category"].as_str().unwrap_or("none").to_owned();
        names.entry(track_id).or_default().push(name);
    }
    let last_steps: BTreeMap<u64, usize> = acknowledged.keys().copied().collect();
    let expected = last_steps.into_iter().map(|(track_id, step)| {
        let name = match step {
            0 => "none".to_owned(),
            2 => name("corrected", track_id),
            _ => name("taught", track_id),
        };
        (track_id, vec![name; VIEWS_PER_TRACK as usize])
    });
    assert_eq!(names, expected.collect());
}

fn check_kills(n_kills: usize, seed: u64) {
    let place = Place::new();
    let is_over = AtomicBool::new(false);
    let mut random = Random::from_seed(seed);
    let acknowledged = std::thread::scope(|scope| {
        let teachers: Vec<_> = (0..N_TEACHERS)
            .map(|teacher| {
                let (place, is_over) = (&place, &is_over);
                scope.spawn(move || teach(place, teacher, is_over))
            })
            .collect();
        for _ in 0..n_kills {
            let memory = Memory::start(&place);
            std::thread::sleep(Duration::from_millis(random.next_u64() % LONGEST_LIFE_MS));
            drop(memory);
        }
        let _last = Memory::start(&place);
        is_over.store(true, Ordering::Relaxed);
        let acknowledged = teachers.into_iter().map(|teacher| teacher.join().unwrap());
        let acknowledged: Acknowledged = acknowledged.flatten().collect();
        let mut stubborn = Stubborn {
            place: &place,
            client: None,
        };
        check_history(&history(&mut stubborn), &acknowledged);
        check_names(&place, &acknowledged);
        let verified = place.tabula(&["memory", "verify", "--json"]);
        assert!(verified.status.success(), "{verified:?}");
        acknowledged
    });
    let log = std::fs::read_to_string(place.log()).unwrap();
    assert!(!log.contains("lost:"), "a store was not sound:\n{log}");
    let n_tracks = acknowledged
        .keys()
        .map(|(t, _)| *t)
        .collect::<BTreeSet<_>>()
        .len();
    println!(
        "{n_kills} kills: {} changes of {n_tracks} tracks acknowledged, each once in the history",
        acknowledged.len()
    );
    assert!(
        acknowledged.len() > n_kills / 4,
        "hardly anything was taught"
    );
}

#[test]
fn what_the_memory_acknowledged_survives_its_kills_and_is_done_once() {
    check_kills(25, 1);
}

#[test]
#[ignore = "long"]
fn long_what_the_memory_acknowledged_survives_its_kills_and_is_done_once() {
    check_kills(500, 2);
}
