//! Recordings of a running daemon: frames to the bit, rotation, kills, recovery.

use crate::daemon::{Daemon, Sandbox, WATCHDOG, eventually, send_signal, suspend, wait_for_end};
use crate::recorder::Recorder;
use channel::topic::CameraCloud;
use message::{CloudPoint, FrameHeader, service_name};
use recording::{FramePlayer, RecordingReader};
use rustix::process::Signal;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};

/// Running `tabula record`.
pub(crate) struct RecordingProcess {
    child: Child,
    folder: PathBuf,
}

impl RecordingProcess {
    /// Starts recording into a folder of the sandbox, and waits for the first file.
    pub(crate) fn start(sandbox: &Sandbox, options: &[&str]) -> Self {
        let folder = sandbox.home().join("recordings");
        let child = sandbox
            .command("tabula")
            .args(["record", "--json", "--min-free-mb", "1", "--out"])
            .arg(&folder)
            .args(options)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let process = Self { child, folder };
        eventually("the recording begins", || !process.files("").is_empty());
        process
    }

    pub(crate) fn pid(&self) -> u32 {
        self.child.id()
    }

    /// Waits until the recording has a frame, since what came before it is not missed.
    fn wait_for_a_frame(&self) {
        const FRAME_BYTES: u64 = 200_000;
        eventually("a frame is recorded", || {
            let sizes = self.files("").into_iter();
            let mut sizes = sizes.filter_map(|path| Some(std::fs::metadata(path).ok()?.len()));
            sizes.any(|n_bytes| n_bytes > FRAME_BYTES)
        });
    }

    /// Files with this ending, in their order.
    pub(crate) fn files(&self, ending: &str) -> Vec<PathBuf> {
        let entries = std::fs::read_dir(&self.folder).into_iter().flatten();
        let mut files: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
        files.retain(|path| path.to_string_lossy().ends_with(ending));
        files.sort();
        files
    }

    /// Waits for the end and returns the document.
    pub(crate) fn finished(mut self) -> Value {
        let status = wait_for_end(&mut self.child, WATCHDOG).expect("the recording ends");
        assert!(status.success(), "{status}");
        let mut document = String::new();
        let mut stdout = self.child.stdout.take().unwrap();
        stdout.read_to_string(&mut document).unwrap();
        serde_json::from_str(&document).unwrap()
    }

    /// Stops with a signal and returns the document.
    pub(crate) fn stop(self, signal: Signal) -> Value {
        send_signal(self.pid(), signal).unwrap();
        self.finished()
    }
}

/// Frame as read from a file.
struct ReadFrame {
    header: FrameHeader,
    points: Vec<CloudPoint>,
    /// Stamps of the states of the arm before it, and of people.
    arm_ns: Vec<u64>,
    people_ns: Vec<u64>,
}

fn frames(path: &Path) -> Vec<ReadFrame> {
    let bytes = std::fs::read(path).unwrap();
    let mut player = FramePlayer::new(&bytes[..], bytes.len() as u64);
    let mut frames = Vec::new();
    while let Some(played) = player.next_frame().unwrap() {
        let mut points = vec![CloudPoint::default(); played.n_points()];
        played.fill(&mut points).unwrap();
        frames.push(ReadFrame {
            header: played.record().unwrap().header,
            points,
            arm_ns: played.arm.iter().map(|(state, _)| state.stamp_ns).collect(),
            people_ns: played
                .people
                .iter()
                .map(|(body, _)| body.stamp_ns)
                .collect(),
        });
    }
    assert_eq!(player.n_unusable(), 0);
    frames
}

/// Numbers of messages by topic.
fn topics(path: &Path) -> BTreeMap<String, u64> {
    let bytes = std::fs::read(path).unwrap();
    let mut reader = RecordingReader::new(&bytes[..], bytes.len() as u64);
    let mut topics = BTreeMap::new();
    while let Some(message) = reader.next_message().unwrap() {
        *topics.entry(message.channel.topic.clone()).or_default() += 1;
    }
    topics
}

/// Bits of the points, which compare NaN with NaN.
fn bits(points: &[CloudPoint]) -> Vec<[u32; 4]> {
    let bits = |p: &CloudPoint| [p.x.to_bits(), p.y.to_bits(), p.z.to_bits(), p.argb];
    points.iter().map(bits).collect()
}

/// Header without what is left out of a recording.
fn recorded_part(header: &FrameHeader) -> FrameHeader {
    FrameHeader {
        sent: 0,
        location: message::SegmentLocation::default(),
        ..*header
    }
}

/// Single file of a finished recording.
fn only_file(document: &Value) -> PathBuf {
    let files = document["files"].as_array().unwrap();
    assert_eq!(files.len(), 1, "{document:#}");
    files[0].as_str().unwrap().into()
}

/// Asserts that before each frame are the states since the one before, of the arm 120 a second,
/// and that no more are missing than the recorder has told: a busy computer may overwrite states
/// before they are read.
fn check_states(frames: &[ReadFrame], document: &Value) {
    let mut n_missing = 0;
    for pair in frames.windows(2) {
        let [before_ns, capture_ns] = [0, 1].map(|i| pair[i].header.capture_stamp_ns);
        let (states, people) = (&pair[1].arm_ns, &pair[1].people_ns);
        let is_between = |&stamp_ns: &u64| stamp_ns > before_ns && stamp_ns <= capture_ns;
        assert!(states.iter().chain(people).all(is_between), "{states:?}");
        assert!(states.is_sorted() && people.is_sorted(), "{states:?}");
        // More than one frame when others were dropped between the two.
        let n_frames = (pair[1].header.sequence - pair[0].header.sequence) as usize;
        assert!(states.len() <= 12 * n_frames, "{states:?}");
        assert!(people.len() <= n_frames, "{people:?}");
        n_missing += 13 * n_frames - states.len() - people.len();
    }
    let n_dropped = document["messages_dropped"].as_u64().unwrap();
    assert!(n_missing as u64 <= n_dropped, "{n_missing} are missing");
}

#[test]
fn recording_holds_the_published_frames_to_the_bit() {
    let sandbox = Sandbox::new();
    let published = Recorder::<CameraCloud>::start(&sandbox);
    let daemon = sandbox.start(&["--source", "simulation:everyday", "--rate", "10"]);
    let recording = RecordingProcess::start(&sandbox, &["--frames", "15"]);
    let document = recording.finished();
    let file = only_file(&document);
    let published = published.stop().0;
    daemon.stop();
    let by_sequence: BTreeMap<u64, _> = published
        .iter()
        .map(|frame| (frame.header.sequence, frame))
        .collect();
    let read = frames(&file);
    assert_eq!(read.len(), 15);
    assert_eq!(document["frames"], 15, "{document:#}");
    for frame in &read {
        let sent = by_sequence[&frame.header.sequence];
        assert_eq!(frame.header, recorded_part(&sent.header));
        assert!(
            bits(&frame.points) == bits(&sent.items),
            "{:?}",
            frame.header
        );
    }
    check_states(&read, &document);
    let topics = topics(&file);
    for topic in [
        service_name::SCENE,
        service_name::OBJECT_VIEW,
        service_name::ACTOR_EVENT,
        service_name::HEALTH,
        "foxglove/points",
        "foxglove/image",
        "foxglove/objects",
        "foxglove/transforms",
    ] {
        assert!(topics.contains_key(topic), "{topic} is missing: {topics:?}");
    }
}

#[test]
fn recording_rotates_and_keeps_the_newest_files_within_the_bound() {
    const KEEP_MB: u64 = 12;
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&["--source", "synthetic:0"]);
    let options = ["--rotate-mb", "3", "--keep-mb", "12", "--foxglove-hz", "0"];
    let recording = RecordingProcess::start(&sandbox, &options);
    let mut seen = BTreeSet::new();
    eventually("old files are deleted", || {
        let files = recording.files(".mcap");
        seen.extend(files.iter().cloned());
        let sizes = recording
            .files("")
            .into_iter()
            .filter_map(|path| path.metadata().ok());
        let total: u64 = sizes.map(|metadata| metadata.len()).sum();
        // A file ends with the chunk that reaches its limit.
        assert!(total < (KEEP_MB + 3) * 1_000_000, "{total} bytes");
        seen.len() > files.len() + 2
    });
    let document = recording.stop(Signal::INT);
    daemon.stop();
    assert!(
        document["files_deleted"].as_u64() >= Some(1),
        "{document:#}"
    );
    let left: Vec<PathBuf> = document["files"]
        .as_array()
        .unwrap()
        .iter()
        .map(|path| PathBuf::from(path.as_str().unwrap()))
        .collect();
    assert!(left.iter().all(|path| path.exists()), "{left:?}");
    // Each file can be played alone, and they follow each other.
    let mut next = None;
    for path in &left {
        for frame in frames(path) {
            let sequence = frame.header.sequence;
            assert!(
                next.is_none_or(|next| sequence >= next),
                "{}",
                path.display()
            );
            next = Some(sequence + 1);
        }
    }
    assert!(next.is_some());
}

#[test]
fn recording_of_a_killed_recorder_is_recovered() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&["--source", "synthetic:0"]);
    let mut recording = RecordingProcess::start(&sandbox, &[]);
    let active = recording.files(".active").remove(0);
    // More than one chunk, since the last one will be damaged.
    let is_begun = || std::fs::metadata(&active).unwrap().len() > 8;
    eventually("frames are in the file", || {
        is_begun() && frames(&active).len() >= 10
    });
    send_signal(recording.pid(), Signal::KILL).unwrap();
    wait_for_end(&mut recording.child, WATCHDOG).unwrap();
    let before = frames(&active).len();
    // A half-written end.
    let mut bytes = std::fs::read(&active).unwrap();
    bytes.truncate(bytes.len() - 100);
    std::fs::write(&active, bytes).unwrap();
    let report = daemon.ask(&["record", "--recover", active.to_str().unwrap()]);
    assert_eq!(report["was_complete"], false, "{report:#}");
    assert!(report["lost_bytes"].as_u64() > Some(0), "{report:#}");
    let recovered = frames(Path::new(report["file"].as_str().unwrap()));
    assert_eq!(report["frames"].as_u64(), Some(recovered.len() as u64));
    assert!(
        recovered.len() + 2 >= before,
        "{} of {before}",
        recovered.len()
    );
    let again = daemon.refused(&["record", "--recover", active.to_str().unwrap()]);
    assert!(
        again.1.contains("exists"),
        "a file is overwritten: {}",
        again.1
    );
    // What a killed guest leaves is removed by the others.
    daemon.stop();
}

#[test]
fn recording_ends_with_its_daemon() {
    let sandbox = Sandbox::new();
    let mut daemon = sandbox.start(&["--source", "synthetic:0"]);
    let recording = RecordingProcess::start(&sandbox, &[]);
    daemon.signal_parent(Signal::INT);
    assert!(daemon.wait(WATCHDOG).success());
    let document = recording.finished();
    assert_eq!(document["end"], "the daemon has ended");
    let left = sandbox.shared_memory_files();
    assert!(left.is_empty(), "{left:?}");
    assert!(only_file(&document).exists());
}

#[test]
fn recording_stops_at_sigterm_with_a_whole_file() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&["--source", "synthetic:0"]);
    let recording = RecordingProcess::start(&sandbox, &[]);
    let document = recording.stop(Signal::TERM);
    let bytes = std::fs::read(only_file(&document)).unwrap();
    let mut reader = RecordingReader::new(&bytes[..], bytes.len() as u64);
    while reader.next_message().unwrap().is_some() {}
    assert!(reader.summary().is_complete);
    assert_eq!(reader.summary().lost_bytes, 0);
    daemon.stop();
}

fn n_frames(daemon: &Daemon<'_>) -> Option<u64> {
    daemon.health("perception")?["frames"].as_u64()
}

#[test]
fn recorder_that_hangs_delays_no_frame_and_tells_what_it_missed() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&["--source", "synthetic:0"]);
    let recording = RecordingProcess::start(&sandbox, &["--foxglove-hz", "0"]);
    recording.wait_for_a_frame();
    suspend(recording.pid());
    let before = n_frames(&daemon).unwrap();
    eventually("frames go on", || n_frames(&daemon) > Some(before + 40));
    send_signal(recording.pid(), Signal::CONT).unwrap();
    let resumed = n_frames(&daemon).unwrap();
    eventually("frames come after that", || {
        n_frames(&daemon) > Some(resumed + 10)
    });
    let document = recording.stop(Signal::INT);
    assert!(
        document["frames_dropped"].as_u64() >= Some(20),
        "{document:#}"
    );
    daemon.stop();
}

#[test]
fn recording_on_a_full_disk_ends_with_one_document() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&["--source", "synthetic:0"]);
    let folder = sandbox.home().join("recordings");
    let folder = folder.to_str().unwrap();
    let limit = u64::MAX.to_string();
    let record = ["--json", "record", "--out", folder, "--min-free-mb", &limit];
    let output = sandbox.tabula(&record);
    daemon.stop();
    assert_eq!(output.status.code(), Some(1));
    let document: Value = serde_json::from_slice(&output.stdout).unwrap();
    let sentence = document["error"].as_str().unwrap();
    assert!(sentence.contains("--min-free-mb"), "{document:#}");
}

#[test]
fn recordings_of_the_same_second_all_stay() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&["--source", "synthetic:0"]);
    let files: BTreeSet<PathBuf> = (0..3)
        .map(|_| RecordingProcess::start(&sandbox, &["--frames", "1"]).finished())
        .map(|document| only_file(&document))
        .collect();
    daemon.stop();
    assert_eq!(files.len(), 3, "{files:?}");
    for file in &files {
        assert_eq!(frames(file).len(), 1);
    }
    let file = files.iter().next().unwrap();
    let output = sandbox.tabula(&["--json", "record", "--info", file.to_str().unwrap()]);
    let info: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(info["was_complete"], true, "{info:#}");
    assert_eq!(info["origin"], sandbox.domain.to_string());
}

#[test]
fn recording_needs_a_daemon() {
    let sandbox = Sandbox::new();
    let output = sandbox.tabula(&["record"]);
    assert_eq!(output.status.code(), Some(3));
    let sentence = String::from_utf8(output.stderr).unwrap();
    assert!(sentence.contains("no daemon runs"), "{sentence}");
}
