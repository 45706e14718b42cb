//! `shared/platform/actor`: supervised, with a committed copy of the state.

use crate::crew::{Crew, MAILBOX};
use actor::{
    Actor, Address, PendingReply, Config, Flow, DropOldest, Placement, Progress, Restart, RestartPolicy,
    Supervisor,
};
use std::convert::Infallible;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::Duration;
use tokio::runtime::Handle;

struct Adder(u64);

impl Actor for Adder {
    type Message = u64;
    type Reply = u64;
    type Checkpoint = u64;
    type Context = ();
    type Error = Infallible;
    type Overflow = DropOldest;

    fn start(_: &Arc<()>, total: u64) -> Result<Self, Infallible> {
        Ok(Self(total))
    }

    fn handle(&mut self, n: u64, _: &Progress) -> Result<Flow<u64>, Infallible> {
        self.0 += n;
        Ok(Flow::Continue(self.0))
    }

    fn checkpoint(&self) -> u64 {
        self.0
    }
}

pub struct Ours {
    supervisor: Supervisor<u64, Adder>,
    actors: Vec<Address<Adder>>,
    answers: Vec<PendingReply<u64>>,
}

fn config() -> Config {
    let policy = RestartPolicy::new(
        30,
        Duration::from_secs(60),
        Duration::from_millis(50),
        Duration::from_secs(2),
    );
    Config {
        restart: Restart::Permanent,
        policy: policy.expect("a valid policy"),
        placement: Placement::Inline,
        mailbox_capacity: NonZeroUsize::new(MAILBOX).expect("not empty"),
        shutdown: Duration::from_secs(5),
        event_capacity: NonZeroUsize::new(64).expect("not empty"),
    }
}

impl Crew for Ours {
    const NAME: &'static str = "ours";

    fn spawn(n: usize) -> Self {
        let (supervisor, _events) = Supervisor::new(config(), Arc::new(()), Handle::current());
        let spawn = |id| supervisor.spawn(id, 0).expect("a new id");
        let actors = (0..n as u64).map(spawn).collect();
        Self {
            supervisor,
            actors,
            answers: Vec::with_capacity(n),
        }
    }

    async fn round(&mut self) -> u64 {
        for actor in &self.actors {
            self.answers.push(actor.ask(0, 1).expect("it lives"));
        }
        let mut sum = 0;
        for answer in self.answers.drain(..) {
            sum += answer.await.expect("it answers");
        }
        sum
    }

    async fn stop(self) {
        assert_eq!(self.supervisor.stop_all().await, 0);
    }
}
