//! Every scene of a domain, in order, taken by a guest that polls.

use crate::daemon::{Place, eventually};
use channel::topic::Scene;
use channel::{Domain, Received, Role, Subscriber};
use message::{SceneObject, SceneSummary};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

/// Polled so often that no scene is overwritten before it is taken.
const PERIOD: Duration = Duration::from_micros(500);

/// One scene as published.
#[derive(Debug, Clone)]
pub(crate) struct Recorded {
    /// The summary.
    pub(crate) summary: SceneSummary,
    /// Its objects.
    pub(crate) objects: Vec<SceneObject>,
}

#[derive(Debug, Default)]
struct Shared {
    scenes: Mutex<Vec<Recorded>>,
    is_over: AtomicBool,
}

/// Records on a thread of its own. To be stopped before the daemon, which would
/// otherwise not be the last one in its domain.
#[derive(Debug)]
pub(crate) struct SceneRecorder {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<u64>>,
}

impl SceneRecorder {
    /// Joins a place's domain, which need not be there yet, and begins to record.
    pub(crate) fn start(place: &Place) -> Self {
        let domain = Domain::join(&place.domain, &place.run_folder(), Role::Guest).unwrap();
        let mut subscriber = Subscriber::<Scene>::polled(&domain).unwrap();
        let shared = Arc::new(Shared::default());
        let recording = shared.clone();
        let thread = std::thread::spawn(move || {
            while !recording.is_over.load(Ordering::Relaxed) {
                take_all(&mut subscriber, &recording);
                std::thread::sleep(PERIOD);
            }
            subscriber.n_lost()
        });
        Self {
            shared,
            thread: Some(thread),
        }
    }

    /// Whether the recorded scenes are as wanted.
    pub(crate) fn is(&self, so: impl FnOnce(&[Recorded]) -> bool) -> bool {
        so(&self.shared.scenes.lock().unwrap())
    }

    /// Waits until the recorded scenes are as wanted.
    pub(crate) fn wait_for(&self, what: &str, is_so: impl Fn(&[Recorded]) -> bool) {
        eventually(what, || self.is(&is_so));
    }

    /// Leaves the domain: the scenes, and how many were published and not taken.
    pub(crate) fn stop(mut self) -> (Vec<Recorded>, u64) {
        let n_lost = self.leave().unwrap();
        let scenes = std::mem::take(&mut *self.shared.scenes.lock().unwrap());
        (scenes, n_lost)
    }

    fn leave(&mut self) -> Option<u64> {
        self.shared.is_over.store(true, Ordering::Relaxed);
        self.thread.take()?.join().ok()
    }
}

impl Drop for SceneRecorder {
    fn drop(&mut self) {
        self.leave();
    }
}

fn take_all(subscriber: &mut Subscriber<Scene>, shared: &Shared) {
    while let Received::Message(scene) = subscriber.receive().unwrap() {
        shared.scenes.lock().unwrap().push(Recorded {
            summary: *scene.header(),
            objects: scene.items().to_vec(),
        });
    }
}
