//! Supervisor of actors of one kind (OTP's `simple_one_for_one`).

use std::fmt;
use std::sync::Arc;

use tokio::runtime::Handle;

use crate::actor::{Actor, Identity};
use crate::actor_loop::ActorLoop;
use crate::actor_registry::{ActorRegistry, Spawned};
use crate::address::Address;
use crate::config::Config;
use crate::error::Error;
use crate::event::Events;
use crate::restart_policy::RestartPolicy;
use crate::supervised_actor::SupervisedActor;

/// Spawns actors by id, restarts those that fail independently of each other, and
/// stops them.
///
/// Dropping it requests all actors to stop, without waiting.
pub struct Supervisor<I: Identity, A: Actor>(Arc<ActorRegistry<I, A>>);

impl<I: Identity, A: Actor> Supervisor<I, A> {
    /// Creates a supervisor without actors, and its event stream. Tasks run on
    /// `runtime`, which needs tokio's time driver.
    pub fn new(config: Config, context: Arc<A::Context>, runtime: Handle) -> (Self, Events<I>) {
        let (registry, events) = ActorRegistry::new(config, context, runtime);
        (Self(Arc::new(registry)), events)
    }

    /// Spawns an actor with its first state. Returns before it has started; messages
    /// sent meanwhile wait in its mailbox.
    ///
    /// # Errors
    /// [`Error::AlreadyRunning`] while an actor with this id has not ended;
    /// [`Error::SupervisorEnded`] after an escalation or [`stop_all`](Self::stop_all).
    pub fn spawn(&self, id: I, checkpoint: A::Checkpoint) -> Result<Address<A>, Error> {
        let Spawned {
            registration,
            mailbox,
            address,
        } = self.0.register(id)?;
        let actor_loop = ActorLoop::new(mailbox, checkpoint, Arc::clone(&self.0.loop_config));
        let child = SupervisedActor::new(registration, actor_loop);
        self.0.runtime.spawn(child.run());
        Ok(address)
    }

    /// Address of an actor that has not ended.
    pub fn address(&self, id: &I) -> Option<Address<A>> {
        self.0.address(id)
    }

    /// Replaces the restart policy, from the next failure on. Earlier restarts count on.
    pub fn set_policy(&self, policy: RestartPolicy) {
        self.0.set_policy(policy);
    }

    /// Number of actors that have not ended.
    pub fn n_actors(&self) -> usize {
        self.0.n_actors()
    }

    /// Requests an actor to stop, without waiting: the message being handled is
    /// finished, queued messages are dropped now and their senders notified. `false`
    /// when there is no such actor.
    pub fn request_stop(&self, id: &I) -> bool {
        self.0.dismiss(id)
    }

    /// Requests an actor to stop as [`request_stop`](Self::request_stop) does, then waits for
    /// its end, at most the time limit. `true` when the actor has ended, or there was
    /// none; `false` when it was abandoned.
    pub async fn stop(&self, id: &I) -> bool {
        match self.0.begin_stop(id) {
            Some(pending) => self.0.await_stop(pending).await == 0,
            None => true,
        }
    }

    /// Requests all actors to stop, waits for them at most the time limit, and spawns
    /// no more. Returns the number of abandoned actors.
    pub async fn stop_all(&self) -> usize {
        let pending = self.0.begin_stop_all();
        self.0.await_stop(pending).await
    }
}

impl<I: Identity, A: Actor> Drop for Supervisor<I, A> {
    fn drop(&mut self) {
        drop(self.0.begin_stop_all());
    }
}

impl<I: Identity, A: Actor> fmt::Debug for Supervisor<I, A> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Supervisor")
            .field("n_actors", &self.n_actors())
            .finish_non_exhaustive()
    }
}
