//! Requests about tasks: from the control server to the executor's thread.

use channel::control::{self, Handler};
use control_protocol::{Command, Refusal, RefusalKind, Reply, TaskCommand, TaskReport};
use crossbeam::channel::{Receiver, Sender, TrySendError, bounded};
use tokio::sync::oneshot;

/// Capacity of the queue; further requests are refused.
const QUEUE_CAPACITY: usize = 16;

/// Request with the channel of its answer.
#[derive(Debug)]
pub(crate) struct WaitingTaskRequest {
    pub(crate) command: TaskCommand,
    answer: oneshot::Sender<Result<TaskReport, Refusal>>,
}

impl WaitingTaskRequest {
    /// Answers the request.
    pub(crate) fn answer(self, answer: Result<TaskReport, Refusal>) {
        // The client may have gone.
        let _ = self.answer.send(answer);
    }
}

/// Handler for the control server, and the queue that it fills.
pub(crate) fn task_requests() -> (Handler, Receiver<WaitingTaskRequest>) {
    let (sender, requests) = bounded(QUEUE_CAPACITY);
    let handler = control::handler(move |command, _peer| {
        let sender = sender.clone();
        async move {
            let answer = answer(command, &sender).await;
            answer.map_or_else(Reply::Refused, |report| Reply::Task(Box::new(report)))
        }
    });
    (handler, requests)
}

async fn answer(
    command: Command,
    sender: &Sender<WaitingTaskRequest>,
) -> Result<TaskReport, Refusal> {
    let Command::Task(command) = command else {
        let sentence = format!("tabula-executive does not answer {command:?}");
        return Err(Refusal::new(RefusalKind::Internal, sentence));
    };
    let ended = "tabula-executive is ending";
    let (answer, answered) = oneshot::channel();
    let request = WaitingTaskRequest { command, answer };
    sender.try_send(request).map_err(|error| {
        let sentence = match error {
            TrySendError::Full(_) => "tabula-executive has 16 requests waiting; try again",
            TrySendError::Disconnected(_) => ended,
        };
        Refusal::new(RefusalKind::Unavailable, sentence)
    })?;
    let answered = answered.await;
    answered.map_err(|_| Refusal::new(RefusalKind::Unavailable, ended))?
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn seventeenth_request_is_refused() {
        let (sender, requests) = bounded(QUEUE_CAPACITY);
        let waiting: Vec<_> = (0..QUEUE_CAPACITY)
            .map(|_| {
                let sender = sender.clone();
                tokio::spawn(
                    async move { answer(Command::Task(TaskCommand::State), &sender).await },
                )
            })
            .collect();
        while requests.len() < QUEUE_CAPACITY {
            tokio::task::yield_now().await;
        }
        let refused = answer(Command::Task(TaskCommand::State), &sender).await;
        assert_eq!(refused.unwrap_err().kind, RefusalKind::Unavailable);
        for request in requests.try_iter() {
            request.answer(Ok(TaskReport::default()));
        }
        for one in waiting {
            assert_eq!(one.await.unwrap(), Ok(TaskReport::default()));
        }
    }
}
