//! What one would write without an actor system.

use crate::crew::{Crew, MAILBOX};
use tokio::sync::{mpsc, oneshot};
use tokio::task::JoinHandle;

type Question = (u64, oneshot::Sender<u64>);

pub struct Bare {
    tasks: Vec<mpsc::Sender<Question>>,
    ends: Vec<JoinHandle<()>>,
    answers: Vec<oneshot::Receiver<u64>>,
}

async fn add_up(mut mailbox: mpsc::Receiver<Question>) {
    let mut total = 0;
    while let Some((n, reply)) = mailbox.recv().await {
        total += n;
        let _ = reply.send(total);
    }
}

impl Crew for Bare {
    const NAME: &'static str = "bare task";

    fn spawn(n: usize) -> Self {
        let (tasks, ends) = (0..n)
            .map(|_| {
                let (sender, receiver) = mpsc::channel(MAILBOX);
                (sender, tokio::spawn(add_up(receiver)))
            })
            .unzip();
        Self {
            tasks,
            ends,
            answers: Vec::with_capacity(n),
        }
    }

    async fn round(&mut self) -> u64 {
        for task in &self.tasks {
            let (reply, answer) = oneshot::channel();
            task.try_send((1, reply)).expect("there is room");
            self.answers.push(answer);
        }
        let mut sum = 0;
        for answer in self.answers.drain(..) {
            sum += answer.await.expect("it answers");
        }
        sum
    }

    async fn stop(self) {
        drop(self.tasks);
        for end in self.ends {
            end.await.expect("it ends");
        }
    }
}
