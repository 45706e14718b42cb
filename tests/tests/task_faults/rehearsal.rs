//! Rehearsal of a task in lockstep: steps through its phases, and watches by truth what moves.

use crate::daemon::{Daemon, Sandbox};
use crate::simulation::scene_file;
use capture::{Follower, FrameFollower};
use channel::topic::TrueObjects;
use channel::{Domain, Role, Subscriber};
use control_protocol::{RefusalKind, TaskReport, TypedRequest, request};
use daemon_client::{DaemonLink, Unanswered};
use evaluation::disturbance::is_disturbed;
use geometry::RigidTransform;
use message::{ProcessKind, TrueState};
use std::collections::BTreeMap;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Time limit of a request, and of a frame when processes are started anew.
const PATIENCE: Duration = Duration::from_secs(60);
/// Period of the looks for a finished frame.
const POLL_PERIOD: Duration = Duration::from_micros(300);
/// Phases in which a task has ended.
pub(super) const ENDS: [&str; 3] = ["succeeded", "failed", "cancelled"];
/// Fall between two frames of what nobody holds, metres: after 3 cm of a free fall.
const FALL_M: f64 = 0.022;

/// Object as the truth of one frame shows it.
struct TrueBody {
    pose: RigidTransform,
    category: String,
}

/// Running rehearsal.
pub(super) struct Rehearsal<'a> {
    pub(super) daemon: Daemon<'a>,
    follower: FrameFollower,
    truth: Subscriber<TrueObjects>,
    link: DaemonLink,
    bodies: BTreeMap<u32, TrueBody>,
    /// Poses of the objects when the rehearsal began.
    first: BTreeMap<u32, RigidTransform>,
    pub(super) n_frames: u64,
    /// Harm that was done, in words.
    pub(super) faults: Vec<String>,
    domain: Domain,
    _scene: TempDir,
}

impl<'a> Rehearsal<'a> {
    /// Starts a daemon in lockstep.
    pub(super) fn start(sandbox: &'a Sandbox, scene: &str) -> Self {
        let (folder, source) = scene_file(scene);
        // A guest before the daemon starts, so that no frame is missed.
        let domain = Domain::join(&sandbox.domain, &sandbox.run_folder(), Role::Guest).unwrap();
        let before = [
            ProcessKind::PERCEPTION,
            ProcessKind::MEMORY,
            ProcessKind::EXECUTIVE,
        ];
        let follower = FrameFollower::polled(&domain, Follower::Observer, &before).unwrap();
        let truth = Subscriber::polled(&domain).unwrap();
        Self {
            daemon: sandbox.start(&["--source", &source, "--lockstep", "--lockstep-observer"]),
            follower,
            truth,
            link: DaemonLink::new(sandbox.domain.clone(), sandbox.run_folder(), PATIENCE),
            bodies: BTreeMap::new(),
            first: BTreeMap::new(),
            n_frames: 0,
            faults: Vec::new(),
            domain,
            _scene: folder,
        }
    }

    /// Waits for the next frame, lets `act` look at it, and lets the source go on.
    pub(super) fn frame<T>(&mut self, act: impl FnOnce(&mut Self) -> T) -> T {
        let begun = Instant::now();
        let frame = loop {
            if let Some(frame) = self.follower.next_frame().unwrap() {
                break frame;
            }
            assert!(
                begun.elapsed() < PATIENCE,
                "no frame\n{}",
                self.daemon.log()
            );
            std::thread::sleep(POLL_PERIOD);
        };
        self.n_frames += 1;
        self.look();
        let acted = act(self);
        self.follower.report(frame).unwrap();
        acted
    }

    /// Answer to a request, repeated while its process is started anew; a refusal is a sentence.
    pub(super) fn ask<T>(&mut self, request: &TypedRequest<T>) -> Result<T, String> {
        let begun = Instant::now();
        loop {
            match self.link.ask(request) {
                Ok(value) => return Ok(value),
                Err(Unanswered::Refused(refusal)) if refusal.kind != RefusalKind::Unavailable => {
                    return Err(refusal.sentence);
                }
                Err(unanswered) => {
                    let log = self.daemon.log();
                    assert!(begun.elapsed() < PATIENCE, "{unanswered}\n{log}");
                    std::thread::sleep(Duration::from_millis(50));
                }
            }
        }
    }

    /// State of the task.
    pub(super) fn task(&mut self) -> TaskReport {
        self.ask(&request::task_state()).unwrap()
    }

    /// Goes on until the task is in one of some phases; panics after too many frames.
    pub(super) fn until(&mut self, phases: &[&str], n_frames_max: u64) -> TaskReport {
        let limit = self.n_frames + n_frames_max;
        loop {
            let task = self.frame(Self::task);
            if phases.contains(&task.phase.as_str()) {
                return task;
            }
            assert!(self.n_frames < limit, "{task:?}\n{}", self.daemon.log());
        }
    }

    /// Goes on for a number of frames.
    pub(super) fn wait(&mut self, n_frames: u64) {
        for _ in 0..n_frames {
            self.frame(|_| ());
        }
    }

    /// Takes the truth of the frame, and looks for falls.
    fn look(&mut self) {
        let Some(truth) = self.truth.latest().unwrap() else {
            return;
        };
        for object in truth.items() {
            let pose = object.world_from_object.checked().unwrap();
            self.first.entry(object.id).or_insert(pose);
            let category = object.category.as_str().unwrap_or_default().to_owned();
            let before = self.bodies.insert(
                object.id,
                TrueBody {
                    pose,
                    category: category.clone(),
                },
            );
            let is_free = TrueState::from_code(object.state) == Some(TrueState::Moving);
            let fall_m = before.map_or(0.0, |it| it.pose.translation.z - pose.translation.z);
            if is_free && fall_m > FALL_M {
                let frame = self.n_frames;
                self.faults
                    .push(format!("the {category} falls at frame {frame}"));
            }
        }
    }

    /// Notes a collision if an object of a category is not where it stood.
    pub(super) fn check_unmoved(&mut self, category: &str) {
        let moved = self.bodies.iter().filter(|(_, it)| it.category == category);
        for (id, body) in moved {
            let first = &self.first[id];
            if is_disturbed(first, &body.pose) {
                let moved = body.pose.translation.vector - first.translation.vector;
                let sentence = format!("the {category} was moved by {:.3} m", moved.norm());
                self.faults.push(sentence);
            }
        }
    }

    /// Stops the daemon, and returns what went wrong.
    pub(super) fn stop(self) -> Vec<String> {
        // The guest leaves first: the last member of a domain removes its files.
        drop((self.follower, self.truth, self.domain));
        self.daemon.stop();
        self.faults
    }
}
