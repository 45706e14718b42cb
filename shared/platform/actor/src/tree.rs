//! A supervisor of children that are known beforehand.
//!
//! The children start in their order, each when the one before is ready, and
//! stop in the reverse order. Which of them begin again after a failure is the
//! strategy's affair, how often and how fast the restart policy's: the limit
//! counts the restarts of all children together, the back-off those of the one
//! that failed, and begins with the failure. When the limit is exceeded, all
//! children are stopped and the tree itself has failed: for the tree above, or,
//! at the root, for the owner of the process.

use std::fmt;
use std::future::poll_fn;
use std::ops::Range;
use std::pin::Pin;
use std::task::Poll;
use std::time::Duration;

use tokio::sync::oneshot;
use tokio::task::JoinHandle;
use tokio::time::{Instant, sleep_until, timeout, timeout_at};

use crate::border::message_of;
use crate::config::Restart;
use crate::error::Error;
use crate::event::{Cause, Escalation, Event, StopReason};
use crate::life::Failure;
use crate::restart_policy::{RestartHistory, RestartPolicy, Verdict};

mod child_spec;
mod report;
mod strategy;
mod work;

pub use child_spec::{ActorConfig, ChildSpec};
pub use report::{ChildPath, Reports, reports};
pub use strategy::Strategy;
pub use work::Stop;

use work::{Birth, Origin};

/// An aborted task ends within this, unless it holds a thread of the reactor.
const ABORT: Duration = Duration::from_millis(100);

/// Children in their order, and how they are restarted.
pub struct Tree {
    strategy: Strategy,
    policy: RestartPolicy,
    children: Vec<Child>,
}

struct Child {
    spec: ChildSpec,
    state: State,
    history: RestartHistory,
    origin: Origin,
}

enum State {
    /// To be started at this instant.
    Due(Instant),
    Running(Running),
    /// Ended and needs no restart of its own; one that is not temporary begins
    /// again together with its siblings.
    Ended,
}

struct Running {
    /// `None` after it was told to stop, at `deadline`'s beginning.
    stop: Option<oneshot::Sender<()>>,
    /// When it will be left behind; set once it was told to stop.
    deadline: Option<Instant>,
    end: JoinHandle<Exit>,
}

/// How a child's life ended.
type Exit = Result<(), Failure>;

impl Tree {
    /// A tree of these children, which have not begun.
    ///
    /// # Errors
    /// [`Error::DuplicateChild`] when two have the same id.
    pub fn new(
        strategy: Strategy,
        policy: RestartPolicy,
        children: Vec<ChildSpec>,
    ) -> Result<Self, Error> {
        for (n, child) in children.iter().enumerate() {
            if children[..n].iter().any(|other| other.id == child.id) {
                return Err(Error::DuplicateChild { id: child.id });
            }
        }
        let child = |spec| Child {
            spec,
            state: State::Ended,
            history: RestartHistory::new(policy),
            origin: Origin::First,
        };
        Ok(Self {
            strategy,
            policy,
            children: children.into_iter().map(child).collect(),
        })
    }

    /// Starts the children and supervises them until told to stop, then stops
    /// them. Needs tokio's time driver. Dropping the future tells the children
    /// to stop without waiting for them.
    ///
    /// # Errors
    /// The [`Escalation`], after all children were stopped: the process should
    /// end with a failure.
    pub async fn run(
        mut self,
        reports: Reports,
        stop: impl Future<Output = ()>,
    ) -> Result<(), Escalation<ChildPath>> {
        self.live(reports, None, stop).await
    }

    /// One life of the tree, from the first state of all its children.
    async fn live(
        &mut self,
        reports: Reports,
        ready: Option<oneshot::Sender<()>>,
        stop: impl Future<Output = ()>,
    ) -> Result<(), Escalation<ChildPath>> {
        let now = Instant::now();
        for child in &mut self.children {
            child.state = State::Due(now);
            child.history = RestartHistory::new(self.policy);
            child.origin = Origin::First;
        }
        let outcome = tokio::select! {
            biased;
            () = stop => Ok(()),
            escalation = self.supervise(&reports, ready) => Err(escalation),
        };
        for child in self.children.iter_mut().rev() {
            child.stop(&reports).await;
            child.spec.work.retire();
        }
        if let Err(escalation) = &outcome {
            reports.report(Event::Escalated(escalation.clone()));
        }
        outcome
    }

    /// Returns when the restarts exceed the policy. Dropping it between two
    /// polls leaves each child as it is.
    async fn supervise(
        &mut self,
        reports: &Reports,
        mut ready: Option<oneshot::Sender<()>>,
    ) -> Escalation<ChildPath> {
        let mut history = RestartHistory::new(self.policy);
        loop {
            let (failed, exit) = match self.next_due() {
                Some((place, at)) if at <= Instant::now() => {
                    match self.children[place].start(reports).await {
                        None => continue,
                        Some(exit) => (place, exit),
                    }
                }
                due => {
                    if due.is_none()
                        && let Some(ready) = ready.take()
                    {
                        // The supervisor above waits for it.
                        let _ = ready.send(());
                    }
                    tokio::select! {
                        biased;
                        ended = next_end(&mut self.children) => ended,
                        () = until(due.map(|(_, at)| at)) => continue,
                    }
                }
            };
            let Some(failure) = self.children[failed].end(exit, reports) else {
                continue;
            };
            match history.on_failure(Instant::now().into_std()) {
                Verdict::Restart { .. } => self.restart(failed, failure, reports).await,
                Verdict::GiveUp => return self.give_up(failed, failure, reports),
            }
        }
    }

    /// The first of those who are due next.
    fn next_due(&self) -> Option<(usize, Instant)> {
        let due = |(place, child): (usize, &Child)| match child.state {
            State::Due(at) => Some((place, at)),
            _ => None,
        };
        let places = self.children.iter().enumerate();
        places.filter_map(due).min_by_key(|(_, at)| *at)
    }

    /// Stops those who depend on a failed child, and lets all of them be due
    /// after the back-off.
    async fn restart(&mut self, failed: usize, failure: Failure, reports: &Reports) {
        let now = Instant::now();
        let child = &mut self.children[failed];
        let after = match child.history.on_failure(now.into_std()) {
            Verdict::Restart { after } => after,
            // Not reached: all restarts together are at least one child's.
            Verdict::GiveUp => self.policy.backoff(usize::MAX),
        };
        reports.report(Event::Restarting {
            id: reports.path(child.spec.id),
            cause: failure.cause,
            tag: failure.tag,
            after,
        });
        child.state = State::Due(now + after);
        for place in self.affected(failed).rev() {
            let child = &mut self.children[place];
            child.stop(reports).await;
            if place == failed || child.spec.restart != Restart::Temporary {
                child.state = State::Due(now + after);
            }
        }
    }

    fn affected(&self, failed: usize) -> Range<usize> {
        self.strategy.affected(failed, self.children.len())
    }

    fn give_up(&self, failed: usize, failure: Failure, reports: &Reports) -> Escalation<ChildPath> {
        let Failure { cause, tag } = failure;
        let id = reports.path(self.children[failed].spec.id);
        reports.report(Event::Stopped {
            id: id.clone(),
            reason: StopReason::Failed {
                cause: cause.clone(),
                tag,
            },
        });
        Escalation {
            id,
            cause,
            tag,
            max_restarts: self.policy.max_restarts(),
            window: self.policy.window(),
        }
    }
}

impl Child {
    /// Begins a life and waits until it is ready; its exit if it ended before.
    async fn start(&mut self, reports: &Reports) -> Option<Exit> {
        let (stop, told) = oneshot::channel();
        let (ready, is_ready) = oneshot::channel();
        let life = self.spec.work.begin(Birth {
            origin: std::mem::replace(&mut self.origin, Origin::LastGood),
            stop: Stop(told),
            ready,
            reports: reports.clone(),
        });
        self.state = State::Running(Running {
            stop: Some(stop),
            deadline: None,
            end: tokio::spawn(life),
        });
        if is_ready.await.is_ok() {
            let id = reports.path(self.spec.id);
            reports.report(Event::Started { id });
            return None;
        }
        self.exit().await
    }

    /// How a running child ends.
    async fn exit(&mut self) -> Option<Exit> {
        match &mut self.state {
            State::Running(running) => Some(exit_of((&mut running.end).await)),
            _ => None,
        }
    }

    /// The failure that calls for a restart, if it is one.
    fn end(&mut self, exit: Exit, reports: &Reports) -> Option<Failure> {
        self.state = State::Ended;
        let failure = match (exit, self.spec.restart) {
            (Ok(()), Restart::Permanent) => Some(Failure {
                cause: Cause::Finished,
                tag: None,
            }),
            (Ok(()), _) => None,
            (Err(failure), Restart::Temporary) => {
                self.report_stop(Err(failure), StopReason::Finished, reports);
                self.spec.work.retire();
                return None;
            }
            (Err(failure), _) => Some(failure),
        };
        if failure.is_none() {
            self.report_stop(Ok(()), StopReason::Finished, reports);
            self.spec.work.retire();
        }
        failure
    }

    /// Tells it to stop and waits at most the shutdown time.
    async fn stop(&mut self, reports: &Reports) {
        let shutdown = self.spec.shutdown;
        let State::Running(running) = &mut self.state else {
            return;
        };
        if running.stop.take().is_some() {
            running.deadline = shutdown.and_then(|time| Instant::now().checked_add(time));
        }
        let ended = match running.deadline {
            Some(deadline) => timeout_at(deadline, &mut running.end).await.ok(),
            None => Some((&mut running.end).await),
        };
        if let Some(ended) = ended {
            self.report_stop(exit_of(ended), StopReason::Asked, reports);
        } else {
            running.end.abort();
            let _ = timeout(ABORT, &mut running.end).await;
            let id = reports.path(self.spec.id);
            reports.report(Event::Abandoned { id });
        }
        self.state = State::Ended;
        self.spec.work.retire();
    }

    fn report_stop(&self, exit: Exit, otherwise: StopReason, reports: &Reports) {
        let reason = match exit {
            Ok(()) => otherwise,
            Err(Failure { cause, tag }) => StopReason::Failed { cause, tag },
        };
        let id = reports.path(self.spec.id);
        reports.report(Event::Stopped { id, reason });
    }
}

/// The next child that ends by itself; of several, the first.
async fn next_end(children: &mut [Child]) -> (usize, Exit) {
    poll_fn(|context| {
        for (place, child) in children.iter_mut().enumerate() {
            if let State::Running(running) = &mut child.state
                && let Poll::Ready(ended) = Pin::new(&mut running.end).poll(context)
            {
                return Poll::Ready((place, exit_of(ended)));
            }
        }
        Poll::Pending
    })
    .await
}

fn exit_of(ended: Result<Exit, tokio::task::JoinError>) -> Exit {
    ended.unwrap_or_else(|error| {
        let cause = match error.try_into_panic() {
            Ok(payload) => Cause::Panicked(message_of(payload)),
            Err(cancelled) => Cause::Failed(std::sync::Arc::new(cancelled)),
        };
        Err(Failure { cause, tag: None })
    })
}

async fn until(instant: Option<Instant>) {
    match instant {
        Some(instant) => sleep_until(instant).await,
        None => std::future::pending().await,
    }
}

impl fmt::Debug for Tree {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ids = self.children.iter().map(|child| child.spec.id);
        f.debug_struct("Tree")
            .field("strategy", &self.strategy)
            .field("children", &ids.collect::<Vec<_>>())
            .finish_non_exhaustive()
    }
}
