//! ractor actors with unbounded mailboxes, without supervision.

use crate::adder_group::AdderGroup;
use ractor::concurrency::{JoinHandle, oneshot};
use ractor::{Actor, ActorProcessingErr, ActorRef, ActorRuntime, RpcReplyPort, SpawnErr};
use tokio::sync::oneshot::Receiver;

/// Actor without fields; its state is the running total.
struct Adder;

/// Message: number to add, and the port for the reply.
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

/// Handle of the start of an actor, which gives the handle of its run.
type StartHandle = JoinHandle<Result<JoinHandle<()>, SpawnErr>>;

/// Group of ractor adders.
pub struct RactorAdders {
    actors: Vec<ActorRef<Add>>,
    handles: Vec<StartHandle>,
    replies: Vec<Receiver<u64>>,
}

impl AdderGroup for RactorAdders {
    const NAME: &'static str = "ractor";

    fn spawn(n: usize) -> Self {
        let (actors, handles) = (0..n)
            .map(|_| ActorRuntime::spawn_instant(None, Adder, 0).expect("an actor without a name"))
            .unzip();
        Self {
            actors,
            handles,
            replies: Vec::with_capacity(n),
        }
    }

    async fn round(&mut self) -> u64 {
        for actor in &self.actors {
            let (sender, reply) = oneshot();
            actor
                .send_message(Add(1, sender.into()))
                .expect("a running actor");
            self.replies.push(reply);
        }
        let mut sum = 0;
        for reply in self.replies.drain(..) {
            sum += reply.await.expect("a reply");
        }
        sum
    }

    async fn stop(self) {
        for actor in &self.actors {
            actor.stop(None);
        }
        for handle in self.handles {
            let running = handle
                .await
                .expect("a task without panic")
                .expect("a started actor");
            running.await.expect("an actor without panic");
        }
    }
}
