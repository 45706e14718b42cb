//! Supervised actors of `shared/platform/actor`, with a checkpoint after each message.

use crate::adder_group::{AdderGroup, MAILBOX_CAPACITY};
use actor::{
    Actor, Address, Config, DropOldest, Flow, PendingReply, Placement, Progress, Restart,
    RestartPolicy, Supervisor,
};
use std::convert::Infallible;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::Duration;
use tokio::runtime::Handle;

/// Actor with its running total.
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

/// Supervised group of adders.
pub struct TabulaAdders {
    supervisor: Supervisor<u64, Adder>,
    actors: Vec<Address<Adder>>,
    replies: Vec<PendingReply<u64>>,
}

/// Supervisor configuration: handlers run inline in the actor's task.
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
        mailbox_capacity: NonZeroUsize::new(MAILBOX_CAPACITY).expect("above zero"),
        shutdown: Duration::from_secs(5),
        event_capacity: NonZeroUsize::new(64).expect("above zero"),
    }
}

impl AdderGroup for TabulaAdders {
    const NAME: &'static str = "ours";

    fn spawn(n: usize) -> Self {
        let (supervisor, _events) = Supervisor::new(config(), Arc::new(()), Handle::current());
        let spawn = |id| supervisor.spawn(id, 0).expect("an unused id");
        let actors = (0..n as u64).map(spawn).collect();
        Self {
            supervisor,
            actors,
            replies: Vec::with_capacity(n),
        }
    }

    async fn round(&mut self) -> u64 {
        for actor in &self.actors {
            self.replies.push(actor.ask(0, 1).expect("a running actor"));
        }
        let mut sum = 0;
        for reply in self.replies.drain(..) {
            sum += reply.await.expect("a reply");
        }
        sum
    }

    async fn stop(self) {
        assert_eq!(self.supervisor.stop_all().await, 0);
    }
}
