//! Who is alive: the table of the actors, and the decisions about all of them.
//!
//! There is no supervisor task: a failing child brings its failure here, under
//! one lock, and acts on the verdict itself. An actor at rest costs its entry,
//! its mailbox and its task.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tokio::runtime::Handle;
use tokio::sync::oneshot;
use tokio::time::{Instant, timeout_at};

use crate::actor::{Actor, Identity};
use crate::address::{Address, Envelope};
use crate::config::Config;
use crate::error::Error;
use crate::event::{Cause, Event, Events, StopReason};
use crate::mailbox::{KeepLatest, Receiver, Sender, mailbox};
use crate::restart_policy::{RestartHistory, Verdict};

pub(crate) struct Roster<I: Identity, A: Actor> {
    pub(crate) config: Config,
    pub(crate) context: Arc<A::Context>,
    pub(crate) runtime: Handle,
    events: Sender<Event<I>, KeepLatest>,
    table: Mutex<Table<I, A>>,
}

struct Table<I, A: Actor> {
    entries: BTreeMap<I, Entry<A>>,
    /// The restarts of all actors together.
    history: RestartHistory,
    n_spawned: u64,
    /// Nothing is spawned or restarted any more.
    has_ended: bool,
}

struct Entry<A: Actor> {
    /// Tells an actor from a later one with the same id.
    serial: u64,
    address: Address<A>,
    /// The restarts of this actor alone: its back-off.
    history: RestartHistory,
    /// Dropped, and thereby resolved, when the actor has ended.
    waiters: Vec<oneshot::Sender<()>>,
}

/// An actor told to stop, as the one who waits for its end knows it.
pub(crate) struct Leaving<I> {
    id: I,
    serial: u64,
    ended: oneshot::Receiver<()>,
}

impl<I: Identity, A: Actor> Roster<I, A> {
    pub(crate) fn new(
        config: Config,
        context: Arc<A::Context>,
        runtime: Handle,
    ) -> (Self, Events<I>) {
        let (events, reader) = mailbox(config.event_capacity);
        let history = RestartHistory::new(config.policy);
        let table = Table {
            entries: BTreeMap::new(),
            history,
            n_spawned: 0,
            has_ended: false,
        };
        (
            Self {
                config,
                context,
                runtime,
                events,
                table: Mutex::new(table),
            },
            reader,
        )
    }

    /// No foreign code but `Ord` and `Clone` of ids runs under the lock, and it
    /// changes nothing by halves.
    fn lock(&self) -> MutexGuard<'_, Table<I, A>> {
        self.table.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(crate) fn report(&self, event: Event<I>) {
        // Nobody needs to listen.
        let _ = self.events.send(event);
    }

    pub(crate) fn n_actors(&self) -> usize {
        self.lock().entries.len()
    }

    pub(crate) fn address(&self, id: &I) -> Option<Address<A>> {
        self.lock()
            .entries
            .get(id)
            .map(|entry| entry.address.clone())
    }
}

/// Coming and going.
impl<I: Identity, A: Actor> Roster<I, A> {
    pub(crate) fn enter(self: &Arc<Self>, id: I) -> Result<Newcomer<I, A>, Error> {
        let (sender, mailbox) = mailbox(self.config.mailbox_capacity);
        let address = Address::new(sender);
        let mut table = self.lock();
        if table.has_ended {
            return Err(Error::SupervisorEnded {
                id: format!("{id:?}"),
            });
        }
        if table.entries.contains_key(&id) {
            return Err(Error::AlreadyRunning {
                id: format!("{id:?}"),
            });
        }
        table.n_spawned += 1;
        let entry = Entry {
            serial: table.n_spawned,
            address: address.clone(),
            history: RestartHistory::new(self.config.policy),
            waiters: Vec::new(),
        };
        let serial = entry.serial;
        table.entries.insert(id.clone(), entry);
        drop(table);
        let membership = Membership {
            roster: Arc::clone(self),
            id,
            serial,
            last_word: None,
        };
        Ok(Newcomer {
            membership,
            mailbox,
            address,
        })
    }

    /// Takes an actor out and reports its end; false when it was out already,
    /// so that each end is reported once.
    fn leave(&self, id: &I, serial: u64, last_word: Event<I>) -> bool {
        let entry = {
            let mut table = self.lock();
            if table
                .entries
                .get(id)
                .is_none_or(|entry| entry.serial != serial)
            {
                return false;
            }
            table.entries.remove(id)
        };
        self.report(last_word);
        // Wakes those who wait, after the report.
        drop(entry);
        true
    }

    /// Tells one actor to stop; false when there is none.
    pub(crate) fn dismiss(&self, id: &I) -> bool {
        let address = self.address(id);
        address.inspect(Address::close).is_some()
    }

    /// Tells one actor to stop, for somebody who will wait for it.
    pub(crate) fn dismiss_awaited(&self, id: &I) -> Option<Leaving<I>> {
        let (leaving, address) = {
            let mut table = self.lock();
            let entry = table.entries.get_mut(id)?;
            (entry.leaving(id), entry.address.clone())
        };
        address.close();
        Some(leaving)
    }

    /// Tells all actors to stop and lets no new one in.
    pub(crate) fn dismiss_all(&self) -> Vec<Leaving<I>> {
        let mut table = self.lock();
        table.has_ended = true;
        let (leaving, addresses): (Vec<_>, Vec<_>) = table
            .entries
            .iter_mut()
            .map(|(id, entry)| (entry.leaving(id), entry.address.clone()))
            .unzip();
        drop(table);
        // Outside the lock, for closing drops foreign messages.
        addresses.iter().for_each(Address::close);
        leaving
    }

    /// Waits at most the shutdown time for actors told to stop, and gives up
    /// those that have not ended then; returns how many.
    pub(crate) async fn see_off(&self, leaving: Vec<Leaving<I>>) -> usize {
        let deadline = Instant::now() + self.config.shutdown;
        let mut n_abandoned = 0;
        for Leaving { id, serial, ended } in leaving {
            if timeout_at(deadline, ended).await.is_err() {
                let is_left_behind = self.leave(&id, serial, Event::Abandoned { id: id.clone() });
                n_abandoned += usize::from(is_left_behind);
            }
        }
        n_abandoned
    }
}

/// Failing.
impl<I: Identity, A: Actor> Roster<I, A> {
    /// The back-off before the next life of a failed actor; `None` when there
    /// is none, because the policy or the supervisor has ended. The failure
    /// that exceeds the policy stops everybody.
    pub(crate) fn on_failure(
        self: &Arc<Self>,
        id: &I,
        cause: &Cause,
        tag: Option<u64>,
    ) -> Option<Duration> {
        // A statement of its own, so that the lock is released before the match.
        let verdict = self.lock().judge(id, Instant::now().into_std())?;
        match verdict {
            Verdict::Restart { after } => Some(after),
            Verdict::GiveUp => {
                self.escalate(Event::Escalated {
                    id: id.clone(),
                    cause: cause.clone(),
                    tag,
                    max_restarts: self.config.policy.max_restarts(),
                    window: self.config.policy.window(),
                });
                None
            }
        }
    }

    /// Stops everybody, waits for them in a task of its own, then reports.
    fn escalate(self: &Arc<Self>, reason: Event<I>) {
        let leaving = self.dismiss_all();
        let roster = Arc::clone(self);
        self.runtime.spawn(async move {
            roster.see_off(leaving).await;
            roster.report(reason);
        });
    }
}

impl<I: Identity, A: Actor> Table<I, A> {
    /// The limit counts all actors' restarts, the back-off only this one's.
    fn judge(&mut self, id: &I, now: std::time::Instant) -> Option<Verdict> {
        if self.has_ended {
            return None;
        }
        let entry = self.entries.get_mut(id)?;
        let verdict = match self.history.on_failure(now) {
            Verdict::Restart { .. } => entry.history.on_failure(now),
            Verdict::GiveUp => Verdict::GiveUp,
        };
        // Ended in the same moment, so that nobody escalates twice.
        self.has_ended = verdict == Verdict::GiveUp;
        Some(verdict)
    }
}

impl<A: Actor> Entry<A> {
    fn leaving<I: Clone>(&mut self, id: &I) -> Leaving<I> {
        let (waiter, ended) = oneshot::channel();
        self.waiters.push(waiter);
        Leaving {
            id: id.clone(),
            serial: self.serial,
            ended,
        }
    }
}

/// What a new actor's task and its spawner get.
pub(crate) struct Newcomer<I: Identity, A: Actor> {
    pub(crate) membership: Membership<I, A>,
    pub(crate) mailbox: Receiver<Envelope<A>, A::Overflow>,
    pub(crate) address: Address<A>,
}

/// An actor's place in the table; dropping it gives the place up and reports
/// the end, even when the task was dropped with its runtime.
pub(crate) struct Membership<I: Identity, A: Actor> {
    pub(crate) roster: Arc<Roster<I, A>>,
    pub(crate) id: I,
    serial: u64,
    last_word: Option<Event<I>>,
}

impl<I: Identity, A: Actor> Membership<I, A> {
    pub(crate) fn stopped(&mut self, reason: StopReason) {
        self.last_word = Some(Event::Stopped {
            id: self.id.clone(),
            reason,
        });
    }
}

impl<I: Identity, A: Actor> Drop for Membership<I, A> {
    fn drop(&mut self) {
        let last_word = self.last_word.take();
        let last_word = last_word.unwrap_or_else(|| Event::Abandoned {
            id: self.id.clone(),
        });
        self.roster.leave(&self.id, self.serial, last_word);
    }
}
