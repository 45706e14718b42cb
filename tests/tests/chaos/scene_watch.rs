//! Watch of good scenes: the time from a fault to the next scene in which all taught objects are
//! tracked and recognised.

use crate::daemon::Sandbox;
use channel::topic::Scene;
use channel::{Domain, Role, Subscriber};
use message::TrackState;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Polling period.
const PERIOD: Duration = Duration::from_millis(2);

#[derive(Default)]
struct Watched {
    is_over: AtomicBool,
    n_good: AtomicU64,
    /// Instant of the last good scene, and the longest time between two since it was asked for.
    last: Mutex<Option<(Instant, Duration)>>,
}

/// Thread that follows the scenes as a guest of the domain.
pub(super) struct SceneWatch {
    watched: Arc<Watched>,
    thread: Option<JoinHandle<()>>,
}

impl SceneWatch {
    /// Watches for scenes with at least `n_labelled` tracked objects that have a label.
    pub(super) fn start(sandbox: &Sandbox, n_labelled: usize) -> Self {
        let domain = Domain::join(&sandbox.domain, &sandbox.run_folder(), Role::Guest).unwrap();
        let mut subscriber = Subscriber::<Scene>::polled(&domain).unwrap();
        let watched = Arc::new(Watched::default());
        let thread = std::thread::spawn({
            let watched = watched.clone();
            move || {
                while !watched.is_over.load(Ordering::Relaxed) {
                    if let Ok(Some(scene)) = subscriber.latest() {
                        let is_good = |object: &&message::SceneObject| {
                            let is_tracked = object.state == TrackState::Tracked.code();
                            is_tracked && object.label().is_some_and(|label| !label.is_empty())
                        };
                        if scene.items().iter().filter(is_good).count() >= n_labelled {
                            watched.note_good();
                        }
                    }
                    std::thread::sleep(PERIOD);
                }
            }
        });
        Self {
            watched,
            thread: Some(thread),
        }
    }

    /// Waits until `n` further scenes were good; `None` if they do not come in time.
    pub(super) fn wait_for_good(&self, n: u64, watchdog: Duration) -> Option<()> {
        let begin = Instant::now();
        let wanted = self.watched.n_good.load(Ordering::Relaxed) + n;
        while self.watched.n_good.load(Ordering::Relaxed) < wanted {
            if begin.elapsed() > watchdog {
                return None;
            }
            std::thread::sleep(PERIOD);
        }
        Some(())
    }

    /// Forgets the pauses until now.
    pub(super) fn begin(&self) {
        *self.watched.last.lock().unwrap() = Some((Instant::now(), Duration::ZERO));
    }

    /// Longest time without a good scene since [`begin`](Self::begin), the present pause included.
    pub(super) fn longest_pause(&self) -> Duration {
        let last = self.watched.last.lock().unwrap();
        last.map_or(Duration::ZERO, |(instant, longest)| {
            longest.max(instant.elapsed())
        })
    }
}

impl Watched {
    fn note_good(&self) {
        let mut last = self.last.lock().unwrap();
        let now = Instant::now();
        let longest = last.map_or(Duration::ZERO, |(instant, longest)| {
            longest.max(now - instant)
        });
        *last = Some((now, longest));
        self.n_good.fetch_add(1, Ordering::Relaxed);
    }
}

impl Drop for SceneWatch {
    /// Leaves the domain, so that the daemon can be the last in it.
    fn drop(&mut self) {
        self.watched.is_over.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
