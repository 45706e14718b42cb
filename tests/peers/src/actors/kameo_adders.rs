//! kameo: bounded mailboxes that let the sender wait; nobody supervises these
//! actors.

use crate::crew::{Crew, MAILBOX};
use kameo::Actor;
use kameo::actor::{ActorRef, Spawn};
use kameo::mailbox;
use kameo::message::{Context, Message};
use kameo::request::PendingReply;
use std::convert::Infallible;

struct Adder(u64);

impl Actor for Adder {
    type Args = Self;
    type Error = Infallible;

    async fn on_start(adder: Self, _: ActorRef<Self>) -> Result<Self, Infallible> {
        Ok(adder)
    }
}

struct Add(u64);

impl Message<Add> for Adder {
    type Reply = u64;

    async fn handle(&mut self, Add(n): Add, _: &mut Context<Self, u64>) -> u64 {
        self.0 += n;
        self.0
    }
}

pub struct ByKameo {
    actors: Vec<ActorRef<Adder>>,
    answers: Vec<PendingReply<Add, u64>>,
}

impl Crew for ByKameo {
    const NAME: &'static str = "kameo";

    fn spawn(n: usize) -> Self {
        let spawn = |_| Adder::spawn_with_mailbox(Adder(0), mailbox::bounded(MAILBOX));
        Self {
            actors: (0..n).map(spawn).collect(),
            answers: Vec::with_capacity(n),
        }
    }

    async fn round(&mut self) -> u64 {
        for actor in &self.actors {
            let asked = actor.ask(Add(1)).try_enqueue();
            self.answers.push(asked.expect("there is room"));
        }
        let mut sum = 0;
        for answer in self.answers.drain(..) {
            sum += answer.await.expect("it answers");
        }
        sum
    }

    async fn stop(self) {
        for actor in &self.actors {
            actor.stop_gracefully().await.expect("it lives");
        }
        for actor in &self.actors {
            actor.wait_for_shutdown().await;
        }
    }
}
