//! Where commands for the arm arrive, and wait until the simulation takes them.

use channel::control::{AnswerFuture, Handler};
use crossbeam::channel::{Receiver, Sender, TrySendError, bounded};
use message::control::{ArmCommand, ArmReport, Command, Refusal, RefusalKind, Reply};
use service::monotonic_ns;
use std::sync::{Arc, OnceLock};
use std::thread::Thread;
use tokio::sync::oneshot;

/// Commands that may wait; one more is refused.
const MOST_WAITING: usize = 16;

/// A command for the arm.
#[derive(Debug)]
pub(crate) struct ArmRequest {
    pub(crate) command: ArmCommand,
    /// When it arrived, monotonic.
    pub(crate) arrived_ns: u64,
    pub(crate) answer: oneshot::Sender<Result<ArmReport, Refusal>>,
}

/// The desk's side of the simulation: the commands, and whom to wake.
#[derive(Debug)]
pub(crate) struct ArmRequests {
    pub(crate) waiting: Receiver<ArmRequest>,
    thread: Arc<OnceLock<Thread>>,
}

impl ArmRequests {
    /// From now on each command wakes the calling thread.
    pub(crate) fn wake_this_thread(&self) {
        let _ = self.thread.set(std::thread::current());
    }
}

/// A handler for the control server, and where its commands come out.
pub(crate) fn desk() -> (Handler, ArmRequests) {
    let (sender, waiting) = bounded(MOST_WAITING);
    let thread = Arc::new(OnceLock::new());
    let requests = ArmRequests {
        waiting,
        thread: Arc::clone(&thread),
    };
    let handler: Handler = Arc::new(move |command| -> AnswerFuture {
        let (sender, thread) = (sender.clone(), Arc::clone(&thread));
        Box::pin(async move {
            let answer = answer(command, &sender, &thread).await;
            answer.unwrap_or_else(Reply::Refused)
        })
    });
    (handler, requests)
}

async fn answer(
    command: Command,
    sender: &Sender<ArmRequest>,
    thread: &OnceLock<Thread>,
) -> Result<Reply, Refusal> {
    let Command::Arm(command) = command else {
        let sentence = format!("tabula-simulator does not answer {command:?}");
        return Err(Refusal::new(RefusalKind::Internal, sentence));
    };
    let (answer, answered) = oneshot::channel();
    let request = ArmRequest {
        command,
        arrived_ns: monotonic_ns(),
        answer,
    };
    sender.try_send(request).map_err(|error| {
        let sentence = match error {
            TrySendError::Full(_) => "the arm has 16 commands waiting; try again",
            TrySendError::Disconnected(_) => "the simulation has ended",
        };
        Refusal::new(RefusalKind::Unavailable, sentence)
    })?;
    if let Some(thread) = thread.get() {
        thread.unpark();
    }
    let report = answered
        .await
        .map_err(|_| Refusal::new(RefusalKind::Unavailable, "the simulation has ended"))?;
    report.map(Reply::Arm)
}
