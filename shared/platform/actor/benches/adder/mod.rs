//! Benchmark actor that adds numbers.

use std::convert::Infallible;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::Duration;

use actor::{Actor, DropOldest, Flow, PoolConfig, Progress, WorkerPool};

/// Actor that adds each message to its total and answers with the total.
pub(crate) struct Adder(u64);

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

pub(crate) fn count(n: usize) -> NonZeroUsize {
    NonZeroUsize::new(n).expect("at least one")
}

/// Worker pool of two threads.
pub(crate) fn pool() -> WorkerPool {
    WorkerPool::start(PoolConfig {
        name: "bench".to_owned(),
        n_workers: count(2),
        stall_after: Duration::from_secs(60),
        max_abandoned: count(1),
    })
    .expect("threads")
}
