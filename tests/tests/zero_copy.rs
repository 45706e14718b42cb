//! Zero-copy transport: detection and actors read the camera's own bytes, and nothing
//! outside the camera allocates as much as a frame.

use crate::daemon::{Daemon, Sandbox, WATCHDOG};
use crate::recorder::SceneRecorder;
use channel::topic::{CameraCloud, ObjectView};
use channel::{Domain, Received, Role, SharedMessage, Subscriber};
use message::{FrameHeader, ObjectViewHeader, ProcessKind, SegmentLocation};
use serde_json::Value;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// Number of observed frames with views.
const N_FRAMES: usize = 30;
/// Number of frames between two readings of the allocation counter.
const N_STEADY_FRAMES: usize = 120;
/// Largest allocation of a process for each frame in steady state, bytes. Chosen, against
/// 9.8 MB of a frame.
const MAX_BYTES_PER_FRAME: u64 = 64_000;

/// Guest that collects the camera's headers and the objects' views.
struct FrameWatcher {
    clouds: Subscriber<CameraCloud>,
    views: Subscriber<ObjectView>,
    headers: BTreeMap<(u64, u64), FrameHeader>,
    viewed: Vec<ObjectViewHeader>,
    /// Newest frame, held so that the camera writes the next one elsewhere.
    held: Vec<SharedMessage<CameraCloud>>,
}

impl FrameWatcher {
    fn new(sandbox: &Sandbox) -> Self {
        let domain = Domain::join(&sandbox.domain, &sandbox.run_folder(), Role::Guest).unwrap();
        Self {
            clouds: Subscriber::polled(&domain).unwrap(),
            views: Subscriber::polled(&domain).unwrap(),
            headers: BTreeMap::new(),
            viewed: Vec::new(),
            held: Vec::new(),
        }
    }

    /// Receives all queued messages and asserts zero copy: each header names the location of the
    /// payload in this process's mapping.
    fn take_all(&mut self) {
        while let Received::Message(frame) = self.clouds.receive().unwrap() {
            let header = *frame.header();
            assert_ne!(header.location.inode, 0, "{header:?}");
            assert_eq!(frame.location(), header.location, "{header:?}");
            self.headers
                .insert((header.session, header.sequence), header);
            self.held.clear();
            self.held.push(frame);
        }
        while let Received::Message(view) = self.views.receive().unwrap() {
            self.viewed.push(*view.header());
        }
    }

    /// Watches until a number of frames have both a header and views.
    fn watch(&mut self, n_frames: usize) {
        let deadline = Instant::now() + WATCHDOG;
        while self.matched().len() < n_frames {
            assert!(Instant::now() < deadline, "{} views", self.viewed.len());
            self.take_all();
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    /// Views by frame, for frames with a header.
    fn matched(&self) -> BTreeMap<(u64, u64), Vec<ObjectViewHeader>> {
        let mut frames = BTreeMap::<_, Vec<_>>::new();
        for view in &self.viewed {
            let frame = (view.session, view.sequence);
            if self.headers.contains_key(&frame) {
                frames.entry(frame).or_default().push(*view);
            }
        }
        frames
    }
}

#[test]
fn detection_and_every_actor_read_the_cameras_own_bytes() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&["--source", "synthetic:0"]);
    let mut watcher = FrameWatcher::new(&sandbox);
    watcher.watch(N_FRAMES);
    let mut locations = Vec::<SegmentLocation>::new();
    for (frame, views) in watcher.matched() {
        let header = &watcher.headers[&frame];
        let n_points = header.size_px[0] * header.size_px[1];
        locations.push(header.location);
        for view in views {
            assert_eq!(view.frame_location, header.location, "{view:?}");
            assert_eq!(view.detection_location, header.location, "{view:?}");
            assert_eq!(view.capture_ns, header.capture_stamp_ns, "{view:?}");
            assert!(view.first_point_index < n_points, "{view:?}");
            assert!(view.n_points > 0 && view.n_points < n_points, "{view:?}");
        }
    }
    // The frames share a segment and not a slot of it, so that equal locations mean something.
    assert!(locations.iter().all(|l| l.inode == locations[0].inode));
    assert!(
        locations
            .iter()
            .any(|l| l.offset_bytes != locations[0].offset_bytes)
    );
    drop(watcher);
    daemon.stop();
}

/// Allocated bytes per frame of the camera between two health reports, without requests in
/// between: the memory allocates for every answer. Dropped frames count, since what a process
/// allocates for the reports of a second is no cost of the few that a loaded machine leaves.
fn bytes_per_frame(daemon: &Daemon<'_>, process: ProcessKind) -> u64 {
    let scenes = SceneRecorder::start(daemon.sandbox);
    let look = || {
        let health = daemon.health(process.word()).unwrap();
        let number = |name: &str| health[name].as_u64().unwrap();
        let n_frames = number("frames") + number("frames_dropped");
        (n_frames, number("allocated_bytes"))
    };
    let (first_frame, first_bytes) = look();
    let n_before = scenes.len();
    scenes.wait_for("frames pass", |scenes| {
        scenes.len() >= n_before + N_STEADY_FRAMES
    });
    scenes.stop();
    let (frame, bytes) = look();
    (bytes - first_bytes) / (frame - first_frame)
}

#[test]
fn steady_state_allocations_outside_the_camera_are_small() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&["--source", "synthetic:0"]);
    let watcher = FrameWatcher::new(&sandbox);
    let objects = daemon.wait_for("all objects are known well", |objects| {
        let is_known = |object: &&Value| object["n_views"].as_u64() > Some(60);
        objects.iter().filter(is_known).count() == 5
    });
    daemon.ask(&["teach", &objects[0]["track_id"].to_string(), "something"]);
    for process in [ProcessKind::PERCEPTION, ProcessKind::MEMORY] {
        let bytes = bytes_per_frame(&daemon, process);
        println!("{} allocates {bytes} bytes per frame", process.word());
        assert!(
            bytes <= MAX_BYTES_PER_FRAME,
            "{} allocates {bytes} bytes per frame",
            process.word()
        );
    }
    drop(watcher);
    daemon.stop();
}
