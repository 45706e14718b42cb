//! kameo actors with bounded mailboxes and back-pressure, without supervision.

use crate::adder_group::{AdderGroup, MAILBOX_CAPACITY};
use kameo::Actor;
use kameo::actor::{ActorRef, Spawn};
use kameo::mailbox;
use kameo::message::{Context, Message};
use kameo::request::PendingReply;
use std::convert::Infallible;

/// Actor with its running total.
struct Adder(u64);

impl Actor for Adder {
    type Args = Self;
    type Error = Infallible;

    async fn on_start(adder: Self, _: ActorRef<Self>) -> Result<Self, Infallible> {
        Ok(adder)
    }
}

/// Message: number to add.
struct Add(u64);

impl Message<Add> for Adder {
    type Reply = u64;

    async fn handle(&mut self, Add(n): Add, _: &mut Context<Self, u64>) -> u64 {
        self.0 += n;
        self.0
    }
}

/// Group of kameo adders.
pub struct KameoAdders {
    actors: Vec<ActorRef<Adder>>,
    replies: Vec<PendingReply<Add, u64>>,
}

impl AdderGroup for KameoAdders {
    const NAME: &'static str = "kameo";

    fn spawn(n: usize) -> Self {
        let spawn = |_| Adder::spawn_with_mailbox(Adder(0), mailbox::bounded(MAILBOX_CAPACITY));
        Self {
            actors: (0..n).map(spawn).collect(),
            replies: Vec::with_capacity(n),
        }
    }

    async fn round(&mut self) -> u64 {
        for actor in &self.actors {
            let pending = actor.ask(Add(1)).try_enqueue();
            self.replies.push(pending.expect("room in the mailbox"));
        }
        let mut sum = 0;
        for reply in self.replies.drain(..) {
            sum += reply.await.expect("a reply");
        }
        sum
    }

    async fn stop(self) {
        for actor in &self.actors {
            actor.stop_gracefully().await.expect("a running actor");
        }
        for actor in &self.actors {
            actor.wait_for_shutdown().await;
        }
    }
}
