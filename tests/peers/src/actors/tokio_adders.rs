//! Baseline without an actor system: tokio tasks that own a bounded channel.

use crate::adder_group::{AdderGroup, MAILBOX_CAPACITY};
use tokio::sync::{mpsc, oneshot};
use tokio::task::JoinHandle;

/// Number to add, and the channel for the reply.
type Request = (u64, oneshot::Sender<u64>);

/// Group of adders as plain tokio tasks.
pub struct TokioAdders {
    tasks: Vec<mpsc::Sender<Request>>,
    handles: Vec<JoinHandle<()>>,
    replies: Vec<oneshot::Receiver<u64>>,
}

/// Adder task: replies with the running total until all senders are dropped.
async fn add_up(mut mailbox: mpsc::Receiver<Request>) {
    let mut total = 0;
    while let Some((n, reply)) = mailbox.recv().await {
        total += n;
        let _ = reply.send(total);
    }
}

impl AdderGroup for TokioAdders {
    const NAME: &'static str = "bare task";

    fn spawn(n: usize) -> Self {
        let (tasks, handles) = (0..n)
            .map(|_| {
                let (sender, receiver) = mpsc::channel(MAILBOX_CAPACITY);
                (sender, tokio::spawn(add_up(receiver)))
            })
            .unzip();
        Self {
            tasks,
            handles,
            replies: Vec::with_capacity(n),
        }
    }

    async fn round(&mut self) -> u64 {
        for task in &self.tasks {
            let (sender, reply) = oneshot::channel();
            task.try_send((1, sender)).expect("room in the mailbox");
            self.replies.push(reply);
        }
        let mut sum = 0;
        for reply in self.replies.drain(..) {
            sum += reply.await.expect("a reply");
        }
        sum
    }

    async fn stop(self) {
        drop(self.tasks);
        for handle in self.handles {
            handle.await.expect("a task without panic");
        }
    }
}
