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
use crate::event::{Cause, Escalation, Event, Events, StopReason};
use crate::life::Terms;
use crate::mailbox::{KeepLatest, Receiver, Sender, mailbox};
use crate::restart_policy::{RestartHistory, RestartPolicy, Verdict};

pub(crate) struct Roster<I: Identity, A: Actor> {
    pub(crate) config: Config,
    pub(crate) terms: Arc<Terms<A>>,
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
    /// Who waits for an escalation: the supervisor above.
    parent: Option<oneshot::Sender<Escalation<I>>>,
}

struct Entry<A: Actor> {
    /// Tells an actor from a later one with the same id.
    serial: u64,
    address: Address<A>,
    /// The restarts of this actor alone: its back-off. Few ever have one.
    history: Option<Box<RestartHistory>>,
    /// Dropped when the actor has ended.
    waiters: Vec<Waiter>,
}

/// Somebody who waits until the last clone of it is dropped.
type Waiter = Arc<oneshot::Sender<()>>;

/// Actors told to stop, as the one who waits for their end knows them.
pub(crate) struct Leaving<I> {
    who: Who<I>,
    ended: oneshot::Receiver<()>,
}

enum Who<I> {
    One { id: I, serial: u64 },
    All,
}

impl<I: Identity, A: Actor> Roster<I, A> {
    pub(crate) fn new(
        config: Config,
        context: Arc<A::Context>,
        runtime: Handle,
    ) -> (Self, Events<I>) {
        let (events, reader) = mailbox(config.event_capacity);
        let table = Table {
            entries: BTreeMap::new(),
            history: RestartHistory::new(config.policy),
            n_spawned: 0,
            has_ended: false,
            parent: None,
        };
        let terms = Terms {
            context,
            placement: config.placement.clone(),
            patience: Some(config.shutdown),
        };
        let roster = Self {
            config,
            terms: Arc::new(terms),
            runtime,
            events,
            table: Mutex::new(table),
        };
        (roster, reader)
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

    /// Begins anew, as after [`new`](Self::new), and tells of the escalation.
    /// Actors that are there stay.
    pub(crate) fn open(&self) -> oneshot::Receiver<Escalation<I>> {
        let (parent, escalation) = oneshot::channel();
        let mut table = self.lock();
        table.has_ended = false;
        table.history = RestartHistory::new(self.config.policy);
        table.parent = Some(parent);
        escalation
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
            history: None,
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
        let (waiter, ended) = oneshot::channel();
        let (serial, address) = {
            let mut table = self.lock();
            let entry = table.entries.get_mut(id)?;
            entry.waiters.push(Arc::new(waiter));
            (entry.serial, entry.address.clone())
        };
        address.close();
        let id = id.clone();
        let who = Who::One { id, serial };
        Some(Leaving { who, ended })
    }

    /// Tells all actors to stop and lets no new one in.
    pub(crate) fn dismiss_all(&self) -> Leaving<I> {
        let (waiter, ended) = oneshot::channel();
        let waiter = Arc::new(waiter);
        let mut table = self.lock();
        table.has_ended = true;
        let mut addresses = Vec::with_capacity(table.entries.len());
        for entry in table.entries.values_mut() {
            entry.waiters.reserve_exact(1);
            entry.waiters.push(Arc::clone(&waiter));
            addresses.push(entry.address.clone());
        }
        drop(table);
        // Outside the lock, for closing drops foreign messages.
        addresses.iter().for_each(Address::close);
        let who = Who::All;
        Leaving { who, ended }
    }

    /// Waits at most the shutdown time for actors told to stop, and gives up
    /// those that have not ended then; returns how many.
    pub(crate) async fn see_off(&self, leaving: Leaving<I>) -> usize {
        let deadline = Instant::now() + self.config.shutdown;
        if timeout_at(deadline, leaving.ended).await.is_ok() {
            return 0;
        }
        let left_behind = match leaving.who {
            Who::One { id, serial } => vec![(id, serial)],
            Who::All => {
                let table = self.lock();
                let entries = table.entries.iter();
                entries.map(|(id, e)| (id.clone(), e.serial)).collect()
            }
        };
        let abandon = |(id, serial): (I, u64)| {
            let last_word = Event::Abandoned { id: id.clone() };
            usize::from(self.leave(&id, serial, last_word))
        };
        left_behind.into_iter().map(abandon).sum()
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
        let policy = self.config.policy;
        // A statement of its own, so that the lock is released before the match.
        let verdict = self.lock().judge(id, policy, Instant::now().into_std())?;
        match verdict {
            Verdict::Restart { after } => Some(after),
            Verdict::GiveUp => {
                self.escalate(Escalation {
                    id: id.clone(),
                    cause: cause.clone(),
                    tag,
                    max_restarts: policy.max_restarts(),
                    window: policy.window(),
                });
                None
            }
        }
    }

    /// Stops everybody, waits for them in a task of its own, then reports.
    fn escalate(self: &Arc<Self>, escalation: Escalation<I>) {
        let leaving = self.dismiss_all();
        // Now, while the one who failed is still here: nobody can have begun
        // anew.
        let parent = self.lock().parent.take();
        let roster = Arc::clone(self);
        self.runtime.spawn(async move {
            roster.see_off(leaving).await;
            roster.report(Event::Escalated(escalation.clone()));
            if let Some(parent) = parent {
                // Who was told to stop meanwhile does not listen any more.
                let _ = parent.send(escalation);
            }
        });
    }
}

impl<I: Identity, A: Actor> Table<I, A> {
    /// The limit counts all actors' restarts, the back-off only this one's.
    fn judge(&mut self, id: &I, policy: RestartPolicy, now: std::time::Instant) -> Option<Verdict> {
        if self.has_ended {
            return None;
        }
        let entry = self.entries.get_mut(id)?;
        let verdict = match self.history.on_failure(now) {
            Verdict::Restart { .. } => entry
                .history
                .get_or_insert_with(|| Box::new(RestartHistory::new(policy)))
                .on_failure(now),
            Verdict::GiveUp => Verdict::GiveUp,
        };
        // Ended in the same moment, so that nobody escalates twice.
        self.has_ended = verdict == Verdict::GiveUp;
        Some(verdict)
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
    /// On the heap, for it is needed once.
    last_word: Option<Box<StopReason>>,
}

impl<I: Identity, A: Actor> Membership<I, A> {
    pub(crate) fn started(&self) {
        let id = self.id.clone();
        self.roster.report(Event::Started { id });
    }

    pub(crate) fn stopped(&mut self, reason: StopReason) {
        self.last_word = Some(Box::new(reason));
    }
}

impl<I: Identity, A: Actor> Drop for Membership<I, A> {
    fn drop(&mut self) {
        let id = self.id.clone();
        let last_word = match self.last_word.take() {
            Some(reason) => Event::Stopped {
                id,
                reason: *reason,
            },
            None => Event::Abandoned { id },
        };
        self.roster.leave(&self.id, self.serial, last_word);
    }
}
