//! Requests to the arm: from the control server to the arm's loop.

use arm_interface::{StopButton, StopWordError};
use channel::control::{self, Handler};
use control_protocol::{ArmCommand, ArmReport, Command, Refusal, RefusalKind, Reply};
use crossbeam::channel::{Receiver, Sender, TrySendError, bounded};
use service::monotonic_ns;
use std::collections::VecDeque;
use std::path::Path;
use std::sync::{Arc, OnceLock};
use std::thread::Thread;
use tokio::sync::oneshot;

/// Capacity of each queue; further requests are refused.
const QUEUE_CAPACITY: usize = 16;

/// Sentence of a refusal when nobody is left to answer.
const LOOP_ENDED: &str = "the loop of the arm has ended; its driver is started again";

/// Sentence of a refusal when a stop came before the command.
pub(crate) const STOPPED_BEFORE: &str = "the arm was stopped before this command was carried out";

/// Request with the channel of its answer.
#[derive(Debug)]
pub struct ArmRequest {
    /// Command to the arm; never a stop, which is a word in shared memory.
    pub command: ArmCommand,
    /// Time of arrival, monotonic clock, nanoseconds.
    pub arrived_ns: u64,
    answer: oneshot::Sender<Result<ArmReport, Refusal>>,
}

impl ArmRequest {
    /// Request that has arrived now.
    pub(crate) fn new(
        command: ArmCommand,
        answer: oneshot::Sender<Result<ArmReport, Refusal>>,
    ) -> Self {
        Self {
            command,
            arrived_ns: monotonic_ns(),
            answer,
        }
    }

    /// Answers the request.
    pub fn reply(self, report: Result<ArmReport, Refusal>) {
        // The client may have gone.
        let _ = self.answer.send(report);
    }

    /// Refuses the request.
    pub fn refuse(self, kind: RefusalKind, sentence: impl Into<String>) {
        self.reply(Err(Refusal::new(kind, sentence.into())));
    }
}

/// Sending ends of the queues.
#[derive(Debug, Clone)]
pub(crate) struct ArmRequestSender {
    waiting: Sender<ArmRequest>,
    after_stop: Sender<ArmRequest>,
    thread: Arc<OnceLock<Thread>>,
}

/// Receiving ends of the queues, in the arm's loop. Whoever has stopped the arm is answered first.
#[derive(Debug)]
pub struct ArmRequests {
    waiting: Receiver<ArmRequest>,
    after_stop: Receiver<ArmRequest>,
    /// Questions that waited during a stop.
    questions: VecDeque<ArmRequest>,
    thread: Arc<OnceLock<Thread>>,
}

impl ArmRequests {
    /// Next request to answer.
    pub fn next_request(&mut self) -> Option<ArmRequest> {
        let urgent = self.after_stop.try_recv().ok();
        urgent
            .or_else(|| self.questions.pop_front())
            .or_else(|| self.waiting.try_recv().ok())
    }

    /// Refuses all commands that wait, since the arm is stopped; questions are kept.
    pub fn refuse_commands(&mut self) {
        for request in self.waiting.try_iter() {
            if request.command == ArmCommand::State {
                self.questions.push_back(request);
            } else {
                request.refuse(RefusalKind::Conflict, STOPPED_BEFORE);
            }
        }
    }

    /// Registers the calling thread to be woken by each request.
    pub fn wake_this_thread(&self) {
        let _ = self.thread.set(std::thread::current());
    }
}

/// Handler for the control server, and the queues that it fills. `domain_folder` holds the stop
/// word.
pub fn arm_requests(domain_folder: &Path) -> (Handler, ArmRequests) {
    let (sender, requests) = queues();
    let folder = domain_folder.to_owned();
    let handler = control::handler(move |command, _peer| {
        let (sender, folder) = (sender.clone(), folder.clone());
        async move {
            let answer = answer(command, &sender, &folder).await;
            answer.unwrap_or_else(Reply::Refused)
        }
    });
    (handler, requests)
}

/// Both ends of the queues.
pub(crate) fn queues() -> (ArmRequestSender, ArmRequests) {
    let (waiting_sender, waiting) = bounded(QUEUE_CAPACITY);
    let (after_stop_sender, after_stop) = bounded(QUEUE_CAPACITY);
    let sender = ArmRequestSender {
        waiting: waiting_sender,
        after_stop: after_stop_sender,
        thread: Arc::default(),
    };
    let requests = ArmRequests {
        waiting,
        after_stop,
        questions: VecDeque::new(),
        thread: Arc::clone(&sender.thread),
    };
    (sender, requests)
}

async fn answer(
    command: Command,
    sender: &ArmRequestSender,
    folder: &Path,
) -> Result<Reply, Refusal> {
    let Command::Arm(command) = command else {
        let sentence = format!("the driver of the arm does not answer {command:?}");
        return Err(Refusal::new(RefusalKind::Internal, sentence));
    };
    let (queue, command) = if command == ArmCommand::Stop {
        let pressed = StopButton::open(folder).and_then(|button| button.press());
        pressed.map_err(|error| match error {
            StopWordError::Absent(_) => Refusal::new(RefusalKind::Invalid, error.to_string()),
            StopWordError::File { .. } => Refusal::new(RefusalKind::Unavailable, error.to_string()),
        })?;
        (&sender.after_stop, ArmCommand::State)
    } else {
        (&sender.waiting, command)
    };
    let (answer, answered) = oneshot::channel();
    let request = ArmRequest::new(command, answer);
    queue.try_send(request).map_err(|error| {
        let sentence = match error {
            TrySendError::Full(_) => "the arm has 16 commands waiting; try again",
            TrySendError::Disconnected(_) => LOOP_ENDED,
        };
        Refusal::new(RefusalKind::Unavailable, sentence)
    })?;
    if let Some(thread) = sender.thread.get() {
        thread.unpark();
    }
    let report = answered
        .await
        .map_err(|_| Refusal::new(RefusalKind::Unavailable, LOOP_ENDED))?;
    report.map(Reply::Arm)
}

#[cfg(test)]
mod tests {
    use super::*;
    use arm_interface::StopWord;

    fn release(lease: u64) -> Command {
        Command::Arm(ArmCommand::Release { lease })
    }

    #[tokio::test]
    async fn stop_presses_the_word_and_is_answered_before_sixteen_that_wait() {
        let folder = tempfile::tempdir().unwrap();
        let mut word = StopWord::create(folder.path()).unwrap();
        let (sender, mut requests) = queues();
        let path = folder.path().to_owned();
        let waiting: Vec<_> = (0..QUEUE_CAPACITY as u64)
            .map(|lease| {
                let (sender, path) = (sender.clone(), path.clone());
                tokio::spawn(async move { answer(release(lease), &sender, &path).await })
            })
            .collect();
        while requests.waiting.len() < QUEUE_CAPACITY {
            tokio::task::yield_now().await;
        }
        let full = answer(release(99), &sender, &path).await;
        assert_eq!(full.unwrap_err().kind, RefusalKind::Unavailable);
        let stop = answer(Command::Arm(ArmCommand::Stop), &sender, &path);
        let serve = async {
            tokio::task::yield_now().await;
            assert!(word.poll(1).unwrap());
            requests.refuse_commands();
            let first = requests.next_request().unwrap();
            assert_eq!(first.command, ArmCommand::State);
            first.refuse(RefusalKind::Invalid, "served");
            assert!(requests.next_request().is_none());
        };
        let (stopped, ()) = tokio::join!(stop, serve);
        assert_eq!(stopped.unwrap_err().sentence, "served");
        for refused in waiting {
            let refusal = refused.await.unwrap().unwrap_err();
            assert!(refusal.sentence.contains("stopped"), "{refusal}");
        }
    }
}
