//! ractor: unbounded mailboxes; nobody supervises these actors.

use crate::crew::Crew;
use ractor::concurrency::{JoinHandle, oneshot};
use ractor::{Actor, ActorProcessingErr, ActorRef, ActorRuntime, RpcReplyPort, SpawnErr};
use tokio::sync::oneshot::Receiver;

struct Adder;

struct Add(u64, RpcReplyPort<u64>);

impl Actor for Adder {
    type Msg = Add;
    type State = u64;
    type Arguments = u64;

    async fn pre_start(
        &self,
        _: ActorRef<Add>,
        total: u64,
    ) -> Result<Self::State, ActorProcessingErr> {
        Ok(total)
    }

    async fn handle(
        &self,
        _: ActorRef<Add>,
        Add(n, reply): Add,
        total: &mut u64,
    ) -> Result<(), ActorProcessingErr> {
        *total += n;
        let _ = reply.send(*total);
        Ok(())
    }
}

type Life = JoinHandle<Result<JoinHandle<()>, SpawnErr>>;

pub struct ByRactor {
    actors: Vec<ActorRef<Add>>,
    lives: Vec<Life>,
    answers: Vec<Receiver<u64>>,
}

impl Crew for ByRactor {
    const NAME: &'static str = "ractor";

    fn spawn(n: usize) -> Self {
        let (actors, lives) = (0..n)
            .map(|_| ActorRuntime::spawn_instant(None, Adder, 0).expect("no name can be taken"))
            .unzip();
        Self {
            actors,
            lives,
            answers: Vec::with_capacity(n),
        }
    }

    async fn round(&mut self) -> u64 {
        for actor in &self.actors {
            let (reply, answer) = oneshot();
            actor.send_message(Add(1, reply.into())).expect("it lives");
            self.answers.push(answer);
        }
        let mut sum = 0;
        for answer in self.answers.drain(..) {
            sum += answer.await.expect("it answers");
        }
        sum
    }

    async fn stop(self) {
        for actor in &self.actors {
            actor.stop(None);
        }
        for life in self.lives {
            let running = life.await.expect("it starts").expect("it starts");
            running.await.expect("it ends");
        }
    }
}
