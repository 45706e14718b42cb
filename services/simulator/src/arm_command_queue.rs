//! Arm command queue: from the control server to the simulation thread.

use channel::control::{self, Handler};
use control_protocol::{ArmCommand, ArmReport, Command, Refusal, RefusalKind, Reply};
use crossbeam::channel::{Receiver, Sender, TrySendError, bounded};
use service::monotonic_ns;
use std::collections::VecDeque;
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

/// Sending ends of the queue.
#[derive(Debug, Clone)]
struct ArmCommandSender {
    waiting: Sender<QueuedArmCommand>,
    stops: Sender<QueuedArmCommand>,
    thread: Arc<OnceLock<Thread>>,
}

/// Receiving end of the queue, in the simulation thread. A stop overtakes all other commands.
#[derive(Debug)]
pub(crate) struct ArmCommandQueue {
    waiting: Receiver<QueuedArmCommand>,
    stops: Receiver<QueuedArmCommand>,
    /// Commands that arrived after a stop that was answered before them.
    after_stop: VecDeque<QueuedArmCommand>,
    thread: Arc<OnceLock<Thread>>,
}

impl ArmCommandQueue {
    /// Next command to carry out: a stop, or the oldest of the others. Those that arrived before a
    /// stop are refused.
    pub(crate) fn next(&mut self) -> Option<QueuedArmCommand> {
        let Ok(stop) = self.stops.try_recv() else {
            let later = self.after_stop.pop_front();
            return later.or_else(|| self.waiting.try_recv().ok());
        };
        let waiting = std::mem::take(&mut self.after_stop);
        for command in waiting.into_iter().chain(self.waiting.try_iter()) {
            if command.arrived_ns > stop.arrived_ns {
                self.after_stop.push_back(command);
            } else {
                let sentence = "the arm was stopped before this command was carried out";
                let refusal = Refusal::new(RefusalKind::Unavailable, sentence);
                // The client may have gone.
                let _ = command.answer.send(Err(refusal));
            }
        }
        Some(stop)
    }

    /// Registers the calling thread to be woken by each command.
    pub(crate) fn wake_this_thread(&self) {
        let _ = self.thread.set(std::thread::current());
    }
}

/// Handler for the control server, and the queue that it fills.
pub(crate) fn arm_command_queue() -> (Handler, ArmCommandQueue) {
    let (sender, requests) = queue();
    let handler = control::handler(move |command, _peer| {
        let sender = sender.clone();
        async move {
            let answer = answer(command, &sender).await;
            answer.unwrap_or_else(Reply::Refused)
        }
    });
    (handler, requests)
}

fn queue() -> (ArmCommandSender, ArmCommandQueue) {
    let (waiting_sender, waiting) = bounded(QUEUE_CAPACITY);
    let (stop_sender, stops) = bounded(QUEUE_CAPACITY);
    let sender = ArmCommandSender {
        waiting: waiting_sender,
        stops: stop_sender,
        thread: Arc::default(),
    };
    let queue = ArmCommandQueue {
        waiting,
        stops,
        after_stop: VecDeque::new(),
        thread: Arc::clone(&sender.thread),
    };
    (sender, queue)
}

async fn answer(command: Command, sender: &ArmCommandSender) -> Result<Reply, Refusal> {
    let Command::Arm(command) = command else {
        let sentence = format!("tabula-simulator does not answer {command:?}");
        return Err(Refusal::new(RefusalKind::Internal, sentence));
    };
    let queue = match command {
        ArmCommand::Stop => &sender.stops,
        _ => &sender.waiting,
    };
    let (answer, answered) = oneshot::channel();
    let request = QueuedArmCommand {
        command,
        arrived_ns: monotonic_ns(),
        answer,
    };
    queue.try_send(request).map_err(|error| {
        let sentence = match error {
            TrySendError::Full(_) => "the arm has 16 commands waiting; try again",
            TrySendError::Disconnected(_) => "the simulation has ended",
        };
        Refusal::new(RefusalKind::Unavailable, sentence)
    })?;
    if let Some(thread) = sender.thread.get() {
        thread.unpark();
    }
    let report = answered
        .await
        .map_err(|_| Refusal::new(RefusalKind::Unavailable, "the simulation has ended"))?;
    report.map(Reply::Arm)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn command(
        command: ArmCommand,
        arrived_ns: u64,
    ) -> (
        QueuedArmCommand,
        oneshot::Receiver<Result<ArmReport, Refusal>>,
    ) {
        let (answer, answered) = oneshot::channel();
        let queued = QueuedArmCommand {
            command,
            arrived_ns,
            answer,
        };
        (queued, answered)
    }

    #[test]
    fn stop_overtakes_a_full_queue_and_ends_what_came_before_it() {
        let (sender, mut queue) = queue();
        let mut answers = Vec::new();
        for arrived_ns in 1..=QUEUE_CAPACITY as u64 {
            let (home, answered) = command(ArmCommand::Home, 10 * arrived_ns);
            sender.waiting.try_send(home).unwrap();
            answers.push(answered);
        }
        let (stop, _stopped) = command(ArmCommand::Stop, 155);
        sender.stops.try_send(stop).unwrap();
        assert_eq!(queue.next().unwrap().command, ArmCommand::Stop);
        for answered in &mut answers[..15] {
            let refusal = answered.try_recv().unwrap().unwrap_err();
            assert!(refusal.sentence.contains("stopped"), "{refusal}");
        }
        assert!(answers[15].try_recv().is_err(), "not answered yet");
        let later = queue.next().unwrap();
        assert_eq!((later.command, later.arrived_ns), (ArmCommand::Home, 160));
        assert!(queue.next().is_none());
    }

    #[tokio::test]
    async fn stop_is_accepted_while_sixteen_commands_wait() {
        let (sender, mut queue) = queue();
        for _ in 0..QUEUE_CAPACITY {
            sender
                .waiting
                .try_send(command(ArmCommand::Home, 1).0)
                .unwrap();
        }
        let full = answer(Command::Arm(ArmCommand::Home), &sender).await;
        assert_eq!(full.unwrap_err().kind, RefusalKind::Unavailable);
        let stop = answer(Command::Arm(ArmCommand::Stop), &sender);
        let serve = async {
            tokio::task::yield_now().await;
            let stop = queue.next().unwrap();
            let gone = Refusal::new(RefusalKind::Invalid, "served");
            stop.answer.send(Err(gone)).unwrap();
        };
        let (stopped, ()) = tokio::join!(stop, serve);
        assert_eq!(stopped.unwrap_err().sentence, "served");
    }
}
