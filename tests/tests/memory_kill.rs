//! Durability under random kills of the memory: clients retry until they are answered.
//! Nothing acknowledged is lost, repeated, or half done.

use crate::daemon::{Sandbox, WATCHDOG, eventually};
use control_protocol::DescriptorBytes;
use control_protocol::{
    Command, HistoryReport, LearningReport, MemoryAnswer, MemoryQuery, MutationId, RefusalKind,
    Reply, Revision, RevisionChange, StoredView, ViewId,
};
use daemon_client::DaemonClient;
use random::Random;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::os::unix::net::UnixStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Number of concurrent clients.
const N_TEACHERS: u64 = 4;
/// Number of track-ids that each client leases.
const N_LEASED: u32 = 1 << 16;
const VIEWS_PER_TRACK: u32 = 3;
/// Pause before a client repeats a request.
const RETRY_PERIOD: Duration = Duration::from_millis(3);
/// Longest life of a memory process, milliseconds; some end before their first answer.
const LONGEST_LIFE_MS: u64 = 160;

/// Client that repeats a command, with the same id, over new connections until it is
/// answered.
struct RetryingClient<'a> {
    sandbox: &'a Sandbox,
    client: Option<DaemonClient>,
}

impl RetryingClient<'_> {
    fn ask(&mut self, command: &Command) -> Reply {
        let begin = Instant::now();
        while begin.elapsed() < 2 * WATCHDOG {
            match self.try_ask(command) {
                Some(Reply::Refused(refusal)) if is_transient(refusal.kind) => {}
                Some(reply) => return reply,
                None => self.client = None,
            }
            std::thread::sleep(RETRY_PERIOD);
        }
        panic!("the memory does not answer {command:?}");
    }

    fn try_ask(&mut self, command: &Command) -> Option<Reply> {
        if self.client.is_none() {
            // The memory's own socket: alone in its domain, it cleans up after each kill.
            let folder = self
                .sandbox
                .run_folder()
                .domain_folder(&self.sandbox.domain);
            let stream = UnixStream::connect(folder.join("memory.sock")).ok()?;
            self.client = DaemonClient::from_stream(stream, WATCHDOG).ok();
        }
        self.client.as_mut()?.call(command.clone()).ok()
    }
}

/// The memory was not there, or ended before it answered.
fn is_transient(kind: RefusalKind) -> bool {
    matches!(kind, RefusalKind::Unavailable | RefusalKind::UnknownOutcome)
}

fn id_of(track_id: u64, step: usize) -> MutationId {
    MutationId(u128::from(track_id) << 8 | step as u128)
}

fn view(track_id: u64, view_id: u32) -> StoredView {
    let values: Vec<f32> = (0..309)
        .map(|i| (track_id + u64::from(view_id) + i) as f32)
        .collect();
    StoredView {
        id: ViewId { track_id, view_id },
        descriptor_kind: "kill-test".into(),
        descriptor: DescriptorBytes::encode(&values),
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

/// Category of a limited number of tracks, so that none exceeds its retention limit.
fn name(category: &str, track_id: u64) -> String {
    format!("{category} {}", track_id / 100)
}

/// Changes of a track in order: store, teach, correct, undo the correction.
fn command(track_id: u64, step: usize, corrected: Option<u64>) -> Command {
    let id = id_of(track_id, step);
    let author = format!("teacher {}", track_id % N_TEACHERS);
    let labelling = |category: &str| control_protocol::Labelling {
        is_new: false,
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

/// History sequence of each acknowledged change; stored views have none.
type Acknowledged = BTreeMap<(u64, usize), Option<u64>>;

/// Changes one track after the other until the end, every second one including the undo.
fn teach(sandbox: &Sandbox, is_over: &AtomicBool) -> Acknowledged {
    let mut client = RetryingClient {
        sandbox,
        client: None,
    };
    let mut acknowledged = Acknowledged::new();
    let first = match client.ask(&Command::LeaseTrackIds { count: N_LEASED }) {
        Reply::TrackIds { first } => first,
        other => panic!("lease: {other:?}"),
    };
    for (round, track_id) in (first..first + u64::from(N_LEASED)).enumerate() {
        let mut corrected = None;
        for step in 0..3 + round % 2 {
            match client.ask(&command(track_id, step, corrected)) {
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

fn history(client: &mut RetryingClient<'_>) -> Vec<HistoryReport> {
    let mut all: Vec<HistoryReport> = Vec::new();
    loop {
        let from = Some(all.len() as u64 + 1);
        let query = MemoryQuery::History { from, max: 1000 };
        match client.ask(&Command::Memory(query)) {
            Reply::Memory(MemoryAnswer::History { entries, .. }) if entries.is_empty() => {
                return all;
            }
            Reply::Memory(MemoryAnswer::History { entries, .. }) => all.extend(entries),
            other => panic!("{other:?}"),
        }
    }
}

/// Asserts that the history has exactly the acknowledged changes, each once and at its
/// sequence number.
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

/// Asserts that all views of every track have the label of its last change.
fn check_names(sandbox: &Sandbox, acknowledged: &Acknowledged) {
    let output = sandbox.tabula(&["memory", "inspect", "--json"]);
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
    let sandbox = Sandbox::new();
    let is_over = AtomicBool::new(false);
    let mut random = Random::from_seed(seed);
    let acknowledged = std::thread::scope(|scope| {
        let teachers: Vec<_> = (0..N_TEACHERS)
            .map(|_| {
                let (sandbox, is_over) = (&sandbox, &is_over);
                scope.spawn(move || teach(sandbox, is_over))
            })
            .collect();
        for _ in 0..n_kills {
            let memory = sandbox.start_program("tabula-memory");
            std::thread::sleep(Duration::from_millis(random.next_u64() % LONGEST_LIFE_MS));
            drop(memory);
        }
        let _last = sandbox.start_program("tabula-memory");
        is_over.store(true, Ordering::Relaxed);
        let acknowledged = teachers.into_iter().map(|teacher| teacher.join().unwrap());
        let acknowledged: Acknowledged = acknowledged.flatten().collect();
        let mut client = RetryingClient {
            sandbox: &sandbox,
            client: None,
        };
        check_history(&history(&mut client), &acknowledged);
        let _gateway = sandbox.start_program("tabula-gateway");
        eventually("the gateway answers", || {
            sandbox.tabula(&["categories"]).status.success()
        });
        check_names(&sandbox, &acknowledged);
        let verified = sandbox.tabula(&["memory", "verify", "--json"]);
        assert!(verified.status.success(), "{verified:?}");
        acknowledged
    });
    let log = std::fs::read_to_string(sandbox.log()).unwrap();
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
fn acknowledged_changes_survive_kills_and_are_made_once() {
    check_kills(25, 1);
}

#[test]
#[ignore = "long"]
fn long_acknowledged_changes_survive_kills_and_are_made_once() {
    check_kills(500, 2);
}
