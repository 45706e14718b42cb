//! Every message of a topic, in order, taken by a guest that polls.

use crate::daemon::{Place, eventually};
use channel::topic::{Scene, Topic};
use channel::{Domain, Received, Role, Subscriber};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

/// Polled so often that no message is overwritten before it is taken.
const PERIOD: Duration = Duration::from_micros(500);

/// One message as published.
pub(crate) struct Recording<T: Topic> {
    /// Its header.
    pub(crate) header: T::Header,
    /// Its items.
    pub(crate) items: Vec<T::Item>,
}

impl<T: Topic> Clone for Recording<T> {
    fn clone(&self) -> Self {
        Self {
            header: self.header,
            items: self.items.clone(),
        }
    }
}

impl<T: Topic> std::fmt::Debug for Recording<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Recording")
            .field("header", &self.header)
            .field("items", &self.items)
            .finish()
    }
}

/// One scene as published.
pub(crate) type Recorded = Recording<Scene>;

/// Records the scenes.
pub(crate) type SceneRecorder = Recorder<Scene>;

struct Shared<T: Topic> {
    messages: Mutex<Vec<Recording<T>>>,
    is_over: AtomicBool,
}

/// Records on a thread of its own. To be stopped before the daemon, which would
/// otherwise not be the last one in its domain.
pub(crate) struct Recorder<T: Topic> {
    shared: Arc<Shared<T>>,
    thread: Option<JoinHandle<u64>>,
}

impl<T: Topic> Recorder<T> {
    /// Joins a place's domain, which need not be there yet, and begins to record.
    pub(crate) fn start(place: &Place) -> Self {
        let domain = Domain::join(&place.domain, &place.run_folder(), Role::Guest).unwrap();
        let mut subscriber = Subscriber::<T>::polled(&domain).unwrap();
        let shared = Arc::new(Shared {
            messages: Mutex::default(),
            is_over: AtomicBool::new(false),
        });
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

    /// Whether the recorded messages are as wanted.
    pub(crate) fn is(&self, so: impl FnOnce(&[Recording<T>]) -> bool) -> bool {
        so(&self.shared.messages.lock().unwrap())
    }

    /// How many messages were recorded.
    pub(crate) fn len(&self) -> usize {
        self.shared.messages.lock().unwrap().len()
    }

    /// The newest message.
    pub(crate) fn last(&self) -> Option<Recording<T>> {
        self.shared.messages.lock().unwrap().last().cloned()
    }

    /// The first message that is as wanted.
    pub(crate) fn find(&self, is_it: impl Fn(&Recording<T>) -> bool) -> Option<Recording<T>> {
        let messages = self.shared.messages.lock().unwrap();
        messages.iter().find(|message| is_it(message)).cloned()
    }

    /// Waits until the recorded messages are as wanted.
    pub(crate) fn wait_for(&self, what: &str, is_so: impl Fn(&[Recording<T>]) -> bool) {
        eventually(what, || self.is(&is_so));
    }

    /// Leaves the domain: the messages, and how many were published and not taken.
    pub(crate) fn stop(mut self) -> (Vec<Recording<T>>, u64) {
        let n_lost = self.leave().unwrap();
        let messages = std::mem::take(&mut *self.shared.messages.lock().unwrap());
        (messages, n_lost)
    }

    fn leave(&mut self) -> Option<u64> {
        self.shared.is_over.store(true, Ordering::Relaxed);
        self.thread.take()?.join().ok()
    }
}

impl<T: Topic> Drop for Recorder<T> {
    fn drop(&mut self) {
        self.leave();
    }
}

fn take_all<T: Topic>(subscriber: &mut Subscriber<T>, shared: &Shared<T>) {
    while let Received::Message(message) = subscriber.receive().unwrap() {
        shared.messages.lock().unwrap().push(Recording {
            header: *message.header(),
            items: message.items().to_vec(),
        });
    }
}
