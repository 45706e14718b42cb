//! How a child of a tree is started, restarted and stopped.

use std::error::Error;
use std::fmt;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::Duration;

use super::work::{ActorWork, RosterWork, Stop, TaskWork, TreeWork, Work};
use super::{Tree, work};
use crate::actor::{Actor, Identity};
use crate::address::Address;
use crate::config::{Placement, Restart};
use crate::supervisor::Supervisor;

/// A child specification: what a child is, and how its supervisor treats it.
pub struct ChildSpec {
    pub(super) id: &'static str,
    pub(super) restart: Restart,
    /// Time to end in good order; `None` for supervisors, whose children have
    /// their own.
    pub(super) shutdown: Option<Duration>,
    pub(super) work: Box<dyn Work>,
}

/// How one actor of a tree is kept.
#[derive(Debug, Clone)]
pub struct ActorConfig {
    /// When it is restarted.
    pub restart: Restart,
    /// Where its handlers run.
    pub placement: Placement,
    /// Messages that wait for it.
    pub mailbox_capacity: NonZeroUsize,
    /// Time for the message at work and `stop` to finish, once told to stop.
    pub shutdown: Duration,
}

impl ChildSpec {
    /// An actor, and where to send to it through all its lives.
    ///
    /// Messages wait for it while it starts again after a failure of its own;
    /// those that wait when it is stopped are dropped and their senders told.
    /// After a failure, its own or a sibling's, it begins with its last good
    /// state; after an escalation, with the first.
    pub fn actor<A: Actor>(
        id: &'static str,
        config: ActorConfig,
        context: Arc<A::Context>,
        checkpoint: A::Checkpoint,
    ) -> (Self, Address<A>) {
        let placement = config.placement;
        let (work, address) =
            ActorWork::new(placement, config.mailbox_capacity, context, checkpoint);
        let spec = Self {
            id,
            restart: config.restart,
            shutdown: Some(config.shutdown),
            work: Box::new(work),
        };
        (spec, address)
    }

    /// A task: `body` makes the future of each of its lives, which should end
    /// when it is told to [`Stop`], and is dropped after the shutdown time.
    pub fn task<F, R, E>(
        id: &'static str,
        restart: Restart,
        shutdown: Duration,
        mut body: F,
    ) -> Self
    where
        F: FnMut(Stop) -> R + Send + 'static,
        R: Future<Output = Result<(), E>> + Send + 'static,
        E: Error + Send + Sync + 'static,
    {
        let body = move |stop| work::boxed(body(stop));
        Self {
            id,
            restart,
            shutdown: Some(shutdown),
            work: Box::new(TaskWork(body)),
        }
    }

    /// A supervisor of actors that come and go. When it escalates, that is a
    /// failure of this child; restarted, it is empty and spawns again. Its
    /// handle stays valid all the while.
    pub fn supervisor<I: Identity, A: Actor>(
        id: &'static str,
        restart: Restart,
        supervisor: &Supervisor<I, A>,
    ) -> Self {
        Self {
            id,
            restart,
            shutdown: None,
            work: Box::new(RosterWork(supervisor.roster())),
        }
    }

    /// A tree below this one. When it escalates, that is a failure of this
    /// child.
    pub fn tree(id: &'static str, restart: Restart, tree: Tree) -> Self {
        Self {
            id,
            restart,
            shutdown: None,
            work: Box::new(TreeWork::new(id, tree)),
        }
    }
}

impl fmt::Debug for ChildSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ChildSpec")
            .field("id", &self.id)
            .field("restart", &self.restart)
            .field("shutdown", &self.shutdown)
            .finish_non_exhaustive()
    }
}
