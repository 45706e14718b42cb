//! What a child does in one life, whatever it is.

use std::error::Error as StdError;
use std::num::NonZeroUsize;
use std::pin::{Pin, pin};
use std::sync::Arc;
use std::task::{Context, Poll};

use tokio::sync::{Mutex, oneshot};

use super::Tree;
use super::report::Reports;
use crate::actor::{Actor, Identity};
use crate::address::Address;
use crate::border::guarded;
use crate::config::Placement;
use crate::error::Error;
use crate::event::Cause;
use crate::life::{Ending, Failure, Life, Terms};
use crate::mailbox::mailbox;
use crate::roster::Roster;

/// The order to end, which also comes when the supervisor is gone.
#[derive(Debug)]
pub struct Stop(pub(super) oneshot::Receiver<()>);

impl Future for Stop {
    type Output = ();

    fn poll(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<()> {
        Pin::new(&mut self.0).poll(context).map(|_| ())
    }
}

/// Which state a life begins with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Origin {
    /// The one the child was specified with.
    First,
    /// The last one it committed.
    LastGood,
}

/// What a life is given.
pub(super) struct Birth {
    pub(super) origin: Origin,
    pub(super) stop: Stop,
    /// Sent when the next child may start; dropped when this one failed before.
    pub(super) ready: oneshot::Sender<()>,
    pub(super) reports: Reports,
}

/// A life: ends well when it was told to stop or its work is done.
pub(super) type Lifetime = Pin<Box<dyn Future<Output = Result<(), Failure>> + Send>>;

/// Something that can live again and again, one life at a time.
pub(super) trait Work: Send {
    fn begin(&mut self, birth: Birth) -> Lifetime;

    /// Tells those who wait for an answer that there will be no further life
    /// for the time being.
    fn retire(&mut self) {}
}

fn failed(error: impl StdError + Send + Sync + 'static) -> Failure {
    let cause = Cause::Failed(Arc::new(error));
    Failure { cause, tag: None }
}

/// A user's future as a life.
pub(super) fn boxed<E: StdError + Send + Sync + 'static>(
    body: impl Future<Output = Result<(), E>> + Send + 'static,
) -> Lifetime {
    Box::pin(async { body.await.map_err(failed) })
}

pub(super) struct TaskWork<F>(pub(super) F);

impl<F: FnMut(Stop) -> Lifetime + Send> Work for TaskWork<F> {
    fn begin(&mut self, birth: Birth) -> Lifetime {
        let Birth { stop, ready, .. } = birth;
        match guarded(|| (self.0)(stop)) {
            Ok(life) => {
                // The receiver waits for it.
                let _ = ready.send(());
                life
            }
            Err(message) => {
                let cause = Cause::Panicked(message);
                Box::pin(async { Err(Failure { cause, tag: None }) })
            }
        }
    }
}

/// What the lives of an actor hand on. One that hangs on a thread of the reactor
/// and was left behind keeps it, for there must not be two at a time.
struct Estate<A: Actor> {
    life: Life<A>,
    first: A::Checkpoint,
}

pub(super) struct ActorWork<A: Actor> {
    estate: Arc<Mutex<Estate<A>>>,
    address: Address<A>,
}

impl<A: Actor> ActorWork<A> {
    pub(super) fn new(
        placement: Placement,
        capacity: NonZeroUsize,
        context: Arc<A::Context>,
        first: A::Checkpoint,
    ) -> (Self, Address<A>) {
        let (sender, mailbox) = mailbox(capacity);
        let address = Address::new(sender);
        let terms = Terms {
            context,
            placement,
            patience: None,
        };
        let life = Life::new(mailbox, first.clone(), Arc::new(terms));
        let work = Self {
            estate: Arc::new(Mutex::new(Estate { life, first })),
            address: address.clone(),
        };
        (work, address)
    }
}

impl<A: Actor> Work for ActorWork<A> {
    fn begin(&mut self, birth: Birth) -> Lifetime {
        let estate = Arc::clone(&self.estate).try_lock_owned();
        let address = self.address.clone();
        Box::pin(async move {
            let Ok(mut estate) = estate else {
                return Err(failed(Error::StillAtWork));
            };
            let Estate { life, first } = &mut *estate;
            life.mailbox.reopen();
            if birth.origin == Origin::First {
                life.committed = first.clone();
            }
            let on_started = || {
                // The supervisor waits for it.
                let _ = birth.ready.send(());
            };
            let mut living = pin!(life.live(on_started));
            let ending = tokio::select! {
                biased;
                ending = &mut living => ending,
                () = birth.stop => {
                    address.close();
                    living.await
                }
            };
            match ending {
                Ending::Failed(failure) => Err(failure),
                Ending::Asked | Ending::Finished | Ending::Overdue => Ok(()),
            }
        })
    }

    fn retire(&mut self) {
        self.address.close();
    }
}

pub(super) struct RosterWork<I: Identity, A: Actor>(pub(super) Arc<Roster<I, A>>);

impl<I: Identity, A: Actor> Work for RosterWork<I, A> {
    fn begin(&mut self, birth: Birth) -> Lifetime {
        let roster = Arc::clone(&self.0);
        Box::pin(async move {
            let escalation = roster.open();
            let _ = birth.ready.send(());
            tokio::select! {
                biased;
                () = birth.stop => {
                    let leaving = roster.dismiss_all();
                    roster.see_off(leaving).await;
                    Ok(())
                }
                Ok(escalation) = escalation => Err(failed(escalation)),
            }
        })
    }
}

pub(super) struct TreeWork {
    id: &'static str,
    tree: Arc<Mutex<Tree>>,
}

impl TreeWork {
    pub(super) fn new(id: &'static str, tree: Tree) -> Self {
        let tree = Arc::new(Mutex::new(tree));
        Self { id, tree }
    }
}

impl Work for TreeWork {
    fn begin(&mut self, birth: Birth) -> Lifetime {
        let tree = Arc::clone(&self.tree).try_lock_owned();
        let reports = birth.reports.below(self.id);
        Box::pin(async move {
            let Ok(mut tree) = tree else {
                return Err(failed(Error::StillAtWork));
            };
            let ended = tree.live(reports, Some(birth.ready), birth.stop).await;
            ended.map_err(failed)
        })
    }
}
