//! Actor registry: the table of running actors, and the supervisor's decisions about
//! them.
//!
//! There is no supervisor task: a failing actor reports its failure here, under one
//! lock, and acts on the decision itself. An idle actor costs its entry, its mailbox
//! and its task.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use parking_lot::{Mutex, MutexGuard};
use tokio::runtime::Handle;
use tokio::sync::oneshot;
use tokio::time::{Instant, timeout_at};

use crate::actor::{Actor, Identity};
use crate::actor_loop::LoopConfig;
use crate::address::{Address, Envelope};
use crate::config::Config;
use crate::error::Error;
use crate::event::{Cause, Escalation, Events, LifecycleEvent, StopReason};
use crate::mailbox::{DropOldest, Receiver, Sender, mailbox};
use crate::restart_policy::{RestartDecision, RestartHistory, RestartPolicy};

pub(crate) struct ActorRegistry<I: Identity, A: Actor> {
    pub(crate) config: Config,
    pub(crate) loop_config: Arc<LoopConfig<A>>,
    pub(crate) runtime: Handle,
    events: Sender<LifecycleEvent<I>, DropOldest>,
    table: Mutex<RegistryTable<I, A>>,
}

struct RegistryTable<I, A: Actor> {
    entries: BTreeMap<I, ActorEntry<A>>,
    /// Restarts of all actors together (restart intensity).
    history: RestartHistory,
    n_spawned: u64,
    /// `true` after escalation or a stop of all: no actor is spawned or restarted.
    has_ended: bool,
}

struct ActorEntry<A: Actor> {
    /// Serial number; distinguishes an actor from a later one with the same id.
    serial: u64,
    address: Address<A>,
    /// Restarts of this actor alone, for its back-off. Rarely present.
    history: Option<Box<RestartHistory>>,
    /// Waiters for the actor's end; dropped when it has ended.
    waiters: Vec<Waiter>,
}

/// Completion signal: resolves when its last clone is dropped.
type Waiter = Arc<oneshot::Sender<()>>;

/// Requested stop of one or all actors, to be awaited.
pub(crate) struct PendingStop<I> {
    target: StopTarget<I>,
    ended: oneshot::Receiver<()>,
}

enum StopTarget<I> {
    One { id: I, serial: u64 },
    All,
}

impl<I: Identity, A: Actor> ActorRegistry<I, A> {
    pub(crate) fn new(
        config: Config,
        context: Arc<A::Context>,
        runtime: Handle,
    ) -> (Self, Events<I>) {
        let (events, reader) = mailbox(config.event_capacity);
        let table = RegistryTable {
            entries: BTreeMap::new(),
            history: RestartHistory::new(config.policy),
            n_spawned: 0,
            has_ended: false,
        };
        let loop_config = LoopConfig {
            context,
            placement: config.placement.clone(),
            stop_timeout: config.shutdown,
        };
        let registry = Self {
            config,
            loop_config: Arc::new(loop_config),
            runtime,
            events,
            table: Mutex::new(table),
        };
        (registry, reader)
    }

    /// No user code but `Ord` and `Clone` of ids runs under the lock, and it leaves
    /// nothing half-changed.
    fn lock(&self) -> MutexGuard<'_, RegistryTable<I, A>> {
        self.table.lock()
    }

    pub(crate) fn report(&self, event: LifecycleEvent<I>) {
        // The reader of events may be gone.
        let _ = self.events.send(event);
    }

    /// Replaces the restart policy of all actors together and of each.
    pub(crate) fn set_policy(&self, policy: RestartPolicy) {
        let mut table = self.lock();
        table.history.set_policy(policy);
        let histories = table.entries.values_mut();
        for history in histories.filter_map(|entry| entry.history.as_mut()) {
            history.set_policy(policy);
        }
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

/// Registration and stopping of actors.
impl<I: Identity, A: Actor> ActorRegistry<I, A> {
    pub(crate) fn register(self: &Arc<Self>, id: I) -> Result<Spawned<I, A>, Error> {
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
        let entry = ActorEntry {
            serial: table.n_spawned,
            address: address.clone(),
            history: None,
            waiters: Vec::new(),
        };
        let serial = entry.serial;
        table.entries.insert(id.clone(), entry);
        drop(table);
        let registration = Registration {
            registry: Arc::clone(self),
            id,
            serial,
            stop_reason: None,
        };
        Ok(Spawned {
            registration,
            mailbox,
            address,
        })
    }

    /// Removes an actor and reports its end; `false` when it was removed already, so
    /// that each end is reported once.
    fn deregister(&self, id: &I, serial: u64, final_event: LifecycleEvent<I>) -> bool {
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
        self.report(final_event);
        // Wakes the waiters, after the report.
        drop(entry);
        true
    }

    /// Requests one actor to stop; `false` when there is none.
    pub(crate) fn dismiss(&self, id: &I) -> bool {
        let address = self.address(id);
        address.inspect(Address::close).is_some()
    }

    /// Requests one actor to stop, and returns its completion.
    pub(crate) fn begin_stop(&self, id: &I) -> Option<PendingStop<I>> {
        let (waiter, ended) = oneshot::channel();
        let (serial, address) = {
            let mut table = self.lock();
            let entry = table.entries.get_mut(id)?;
            entry.waiters.push(Arc::new(waiter));
            (entry.serial, entry.address.clone())
        };
        address.close();
        let id = id.clone();
        let target = StopTarget::One { id, serial };
        Some(PendingStop { target, ended })
    }

    /// Requests all actors to stop and refuses new ones.
    pub(crate) fn begin_stop_all(&self) -> PendingStop<I> {
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
        // Outside the lock: closing drops user messages.
        addresses.iter().for_each(Address::close);
        let target = StopTarget::All;
        PendingStop { target, ended }
    }

    /// Waits for a requested stop, at most the time limit, and abandons the actors
    /// that have not ended then. Returns their number.
    pub(crate) async fn await_stop(&self, pending: PendingStop<I>) -> usize {
        let deadline = Instant::now() + self.config.shutdown;
        if timeout_at(deadline, pending.ended).await.is_ok() {
            return 0;
        }
        let late = match pending.target {
            StopTarget::One { id, serial } => vec![(id, serial)],
            StopTarget::All => {
                let table = self.lock();
                let entries = table.entries.iter();
                entries.map(|(id, e)| (id.clone(), e.serial)).collect()
            }
        };
        let abandon = |(id, serial): (I, u64)| {
            let final_event = LifecycleEvent::Abandoned { id: id.clone() };
            usize::from(self.deregister(&id, serial, final_event))
        };
        late.into_iter().map(abandon).sum()
    }
}

/// Restart of failed actors and escalation of repeated failures.
impl<I: Identity, A: Actor> ActorRegistry<I, A> {
    /// Back-off before the restart of a failed actor; `None` when the restart policy
    /// or the supervisor has ended it. The failure that exceeds the policy stops all
    /// actors.
    pub(crate) fn on_failure(
        self: &Arc<Self>,
        id: &I,
        cause: &Cause,
        tag: Option<u64>,
    ) -> Option<Duration> {
        // A block, so that the lock is released before the match.
        let (verdict, policy) = {
            let mut table = self.lock();
            let verdict = table.decide_restart(id, Instant::now().into_std())?;
            (verdict, table.history.policy())
        };
        match verdict {
            RestartDecision::Restart { after } => Some(after),
            RestartDecision::Escalate => {
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

    /// Escalates: stops all actors, waits for them in a separate task, then reports.
    fn escalate(self: &Arc<Self>, escalation: Escalation<I>) {
        let pending = self.begin_stop_all();
        let registry = Arc::clone(self);
        self.runtime.spawn(async move {
            registry.await_stop(pending).await;
            registry.report(LifecycleEvent::Escalated(escalation));
        });
    }
}

impl<I: Identity, A: Actor> RegistryTable<I, A> {
    /// Restart decision: the limit counts the restarts of all actors, the back-off
    /// only this actor's.
    fn decide_restart(&mut self, id: &I, now: std::time::Instant) -> Option<RestartDecision> {
        if self.has_ended {
            return None;
        }
        let policy = self.history.policy();
        let entry = self.entries.get_mut(id)?;
        let verdict = match self.history.on_failure(now) {
            RestartDecision::Restart { .. } => entry
                .history
                .get_or_insert_with(|| Box::new(RestartHistory::new(policy)))
                .on_failure(now),
            RestartDecision::Escalate => RestartDecision::Escalate,
        };
        // Ended under the same lock, so that only one failure escalates.
        self.has_ended = verdict == RestartDecision::Escalate;
        Some(verdict)
    }
}

/// Parts of a newly spawned actor: for its task and for its spawner.
pub(crate) struct Spawned<I: Identity, A: Actor> {
    pub(crate) registration: Registration<I, A>,
    pub(crate) mailbox: Receiver<Envelope<A>, A::Overflow>,
    pub(crate) address: Address<A>,
}

/// Registration of an actor; dropping it removes the actor and reports its end, also
/// when the task was dropped with its runtime.
pub(crate) struct Registration<I: Identity, A: Actor> {
    pub(crate) registry: Arc<ActorRegistry<I, A>>,
    pub(crate) id: I,
    serial: u64,
    /// On the heap because it is needed once.
    stop_reason: Option<Box<StopReason>>,
}

impl<I: Identity, A: Actor> Registration<I, A> {
    pub(crate) fn started(&self) {
        let id = self.id.clone();
        self.registry.report(LifecycleEvent::Started { id });
    }

    pub(crate) fn stopped(&mut self, reason: StopReason) {
        self.stop_reason = Some(Box::new(reason));
    }
}

impl<I: Identity, A: Actor> Drop for Registration<I, A> {
    fn drop(&mut self) {
        let id = self.id.clone();
        let final_event = match self.stop_reason.take() {
            Some(reason) => LifecycleEvent::Stopped {
                id,
                reason: *reason,
            },
            None => LifecycleEvent::Abandoned { id },
        };
        self.registry.deregister(&self.id, self.serial, final_event);
    }
}
