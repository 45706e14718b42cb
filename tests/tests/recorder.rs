//! Recorder of all messages of a topic, in order, in a guest that polls.

use crate::daemon::{Sandbox, eventually};
use channel::topic::{Scene, Topic};
use channel::{Domain, Received, Role, Subscriber};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

/// Polling period, short enough that no message is overwritten.
const PERIOD: Duration = Duration::from_micros(500);

/// Recorded copy of a published message.
pub(crate) struct RecordedMessage<T: Topic> {
    /// Header of the recorded message.
    pub(crate) header: T::Header,
    /// Items of the recorded message.
    pub(crate) items: Vec<T::Item>,
}

impl<T: Topic> Clone for RecordedMessage<T> {
    fn clone(&self) -> Self {
        Self {
            header: self.header,
            items: self.items.clone(),
        }
    }
}

impl<T: Topic> std::fmt::Debug for RecordedMessage<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RecordedMessage")
            .field("header", &self.header)
            .field("items", &self.items)
            .finish()
    }
}

/// Recorded copy of a published scene.
pub(crate) type RecordedScene = RecordedMessage<Scene>;

/// Recorder of scenes.
pub(crate) type SceneRecorder = Recorder<Scene>;

struct SharedRecording<T: Topic> {
    messages: Mutex<Vec<RecordedMessage<T>>>,
    is_over: AtomicBool,
}

/// Recorder thread. It must stop before the daemon, which would otherwise not be the last
/// in its domain.
pub(crate) struct Recorder<T: Topic> {
    shared: Arc<SharedRecording<T>>,
    thread: Option<JoinHandle<u64>>,
}

impl<T: Topic> Recorder<T> {
    /// Joins the domain of a sandbox, which need not exist yet, and starts recording.
    pub(crate) fn start(sandbox: &Sandbox) -> Self {
        let domain = Domain::join(&sandbox.domain, &sandbox.run_folder(), Role::Guest).unwrap();
        let mut subscriber = Subscriber::<T>::polled(&domain).unwrap();
        let shared = Arc::new(SharedRecording {
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

    /// True if a predicate holds for the recorded messages.
    pub(crate) fn is(&self, so: impl FnOnce(&[RecordedMessage<T>]) -> bool) -> bool {
        so(&self.shared.messages.lock().unwrap())
    }

    /// Number of messages recorded so far.
    pub(crate) fn len(&self) -> usize {
        self.shared.messages.lock().unwrap().len()
    }

    /// Newest recorded message.
    pub(crate) fn last(&self) -> Option<RecordedMessage<T>> {
        self.shared.messages.lock().unwrap().last().cloned()
    }

    /// First message that fulfils a predicate.
    pub(crate) fn find(
        &self,
        is_it: impl Fn(&RecordedMessage<T>) -> bool,
    ) -> Option<RecordedMessage<T>> {
        let messages = self.shared.messages.lock().unwrap();
        messages.iter().find(|message| is_it(message)).cloned()
    }

    /// Waits until a predicate holds for the recorded messages.
    pub(crate) fn wait_for(&self, what: &str, is_so: impl Fn(&[RecordedMessage<T>]) -> bool) {
        eventually(what, || self.is(&is_so));
    }

    /// Leaves the domain; returns the messages, and the number of lost ones.
    pub(crate) fn stop(mut self) -> (Vec<RecordedMessage<T>>, u64) {
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

fn take_all<T: Topic>(subscriber: &mut Subscriber<T>, shared: &SharedRecording<T>) {
    while let Received::Message(message) = subscriber.receive().unwrap() {
        shared.messages.lock().unwrap().push(RecordedMessage {
            header: *message.header(),
            items: message.items().to_vec(),
        });
    }
}
