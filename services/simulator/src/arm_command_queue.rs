//! Arm command queue: from the control server to the simulation thread.

use channel::control::{AnswerFuture, Handler};
use crossbeam::channel::{Receiver, Sender, TrySendError, bounded};
use message::control::{ArmCommand, ArmReport, Command, Refusal, RefusalKind, Reply};
use service::monotonic_ns;
use std::sync::{Arc, OnceLock};
use std::thread::Thread;
use tokio::sync::oneshot;

/// Capacity of the queue; further commands are refused.
const QUEUE_CAPACITY: usize = 16;

/// Arm command with the channel of its answer.
#[derive(Debug)]
pub(crate) struct QueuedArmCommand {
    pub(crate) command: ArmCommand,
    /// Time of arrival, monotonic clock, nanoseconds.
    pub(crate) arrived_ns: u64,
    pub(crate) answer: oneshot::Sender<Result<ArmReport, Refusal>>,
}

/// Receiving end of the queue, in the simulation thread.
#[derive(Debug)]
pub(crate) struct ArmCommandQueue {
    pub(crate) waiting: Receiver<QueuedArmCommand>,
    thread: Arc<OnceLock<Thread>>,
}

impl ArmCommandQueue {
    /// Registers the calling thread to be woken by each command.
    pub(crate) fn wake_this_thread(&self) {
        let _ = self.thread.set(std::thread::current());
    }
}

/// Handler for the control server, and the queue that it fills.
pub(crate) fn arm_command_queue() -> (Handler, ArmCommandQueue) {
    let (sender, waiting) = bounded(QUEUE_CAPACITY);
    let thread = Arc::new(OnceLock::new());
    let requests = ArmCommandQueue {
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
    sender: &Sender<QueuedArmCommand>,
    thread: &OnceLock<Thread>,
) -> Result<Reply, Refusal> {
    let Command::Arm(command) = command else {
        let sentence = format!("tabula-simulator does not answer {command:?}");
        return Err(Refusal::new(RefusalKind::Internal, sentence));
    };
    let (answer, answered) = oneshot::channel();
    let request = QueuedArmCommand {
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
