//! The owner of actors of one kind.

use std::fmt;
use std::sync::Arc;

use tokio::runtime::Handle;

use crate::actor::{Actor, Identity};
use crate::address::Address;
use crate::child::Child;
use crate::config::Config;
use crate::error::Error;
use crate::event::Events;
use crate::life::Life;
use crate::roster::{Newcomer, Roster};

/// Spawns actors by id, restarts those that fail, one for one, and stops them.
///
/// Dropping it tells all actors to stop, without waiting.
pub struct Supervisor<I: Identity, A: Actor>(Arc<Roster<I, A>>);

impl<I: Identity, A: Actor> Supervisor<I, A> {
    /// A supervisor without actors, and its reports. Tasks run on `runtime`,
    /// which needs tokio's time driver.
    pub fn new(config: Config, context: Arc<A::Context>, runtime: Handle) -> (Self, Events<I>) {
        let (roster, events) = Roster::new(config, context, runtime);
        (Self(Arc::new(roster)), events)
    }

    pub(crate) fn roster(&self) -> Arc<Roster<I, A>> {
        Arc::clone(&self.0)
    }

    /// Begins an actor from a first state. Returns before it has started;
    /// messages sent meanwhile wait in its mailbox.
    ///
    /// # Errors
    /// [`Error::AlreadyRunning`] while an actor with this id has not ended;
    /// [`Error::SupervisorEnded`] after an escalation or [`stop_all`](Self::stop_all).
    pub fn spawn(&self, id: I, checkpoint: A::Checkpoint) -> Result<Address<A>, Error> {
        let Newcomer {
            membership,
            mailbox,
            address,
        } = self.0.enter(id)?;
        let life = Life::new(mailbox, checkpoint, Arc::clone(&self.0.terms));
        let child = Child::new(membership, life);
        self.0.runtime.spawn(child.run());
        Ok(address)
    }

    /// Where to send to an actor that has not ended.
    pub fn address(&self, id: &I) -> Option<Address<A>> {
        self.0.address(id)
    }

    /// How many actors have not ended.
    pub fn n_actors(&self) -> usize {
        self.0.n_actors()
    }

    /// Tells an actor to stop, without waiting: the message at work is finished,
    /// those in its mailbox are dropped now and their senders told. False when
    /// there is no such actor.
    pub fn dismiss(&self, id: &I) -> bool {
        self.0.dismiss(id)
    }

    /// Like [`dismiss`](Self::dismiss), then waits for the end, at most the
    /// shutdown time. True when the actor has ended, or there was none; false
    /// when it was left behind.
    pub async fn stop(&self, id: &I) -> bool {
        match self.0.dismiss_awaited(id) {
            Some(leaving) => self.0.see_off(leaving).await == 0,
            None => true,
        }
    }

    /// Tells all actors to stop, waits for them at most the shutdown time, and
    /// spawns no more. Returns how many were left behind.
    pub async fn stop_all(&self) -> usize {
        let leaving = self.0.dismiss_all();
        self.0.see_off(leaving).await
    }
}

impl<I: Identity, A: Actor> Drop for Supervisor<I, A> {
    fn drop(&mut self) {
        drop(self.0.dismiss_all());
    }
}

impl<I: Identity, A: Actor> fmt::Debug for Supervisor<I, A> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Supervisor")
            .field("n_actors", &self.n_actors())
            .finish_non_exhaustive()
    }
}
