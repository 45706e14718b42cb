//! One supervised actor: the task that lives its lives.

use std::pin::Pin;
use std::sync::Arc;
use std::time::Duration;

use tokio::time::{Instant, Sleep, sleep, sleep_until};

use crate::actor::{Actor, Flow, Identity};
use crate::address::Envelope;
use crate::border::{discard, guarded};
use crate::config::{Placement, Restart};
use crate::event::{Cause, Event, StopReason};
use crate::mailbox::Receiver;
use crate::progress::Progress;
use crate::roster::{Membership, Roster};
use crate::worker_pool::JobLost;

/// Fields are dropped in this order: messages are returned and their senders
/// told before the end is reported.
pub(crate) struct Child<I: Identity, A: Actor> {
    mailbox: Receiver<Envelope<A>, A::Overflow>,
    /// The last state that came out of a message handled with success.
    committed: A::Checkpoint,
    /// When the patience with a stopping actor ends; set once it was told to.
    deadline: Option<Instant>,
    membership: Membership<I, A>,
}

/// How one life of an actor ends.
enum Ending {
    Asked,
    Finished,
    Failed {
        cause: Cause,
        tag: Option<u64>,
    },
    /// Told to stop, and still at work after the shutdown time.
    Overdue,
}

/// What comes back from a message handled with success.
struct Handled<A: Actor> {
    actor: Box<A>,
    flow: Flow<A::Reply>,
    checkpoint: A::Checkpoint,
}

/// Work that was done on the spot, or is the pool's.
enum Begun<T, J> {
    Ended(T),
    Queued(J),
}

/// Why a piece of work on the pool gave nothing back.
enum Interruption {
    Lost(JobLost),
    Overdue,
}

impl<I: Identity, A: Actor> Child<I, A> {
    pub(crate) fn new(
        membership: Membership<I, A>,
        mailbox: Receiver<Envelope<A>, A::Overflow>,
        checkpoint: A::Checkpoint,
    ) -> Self {
        Self {
            mailbox,
            committed: checkpoint,
            deadline: None,
            membership,
        }
    }

    /// Lives until it need not live again. A block rather than an `async fn`,
    /// whose future would hold the child twice.
    #[expect(
        clippy::manual_async_fn,
        reason = "a quarter less memory for each idle actor"
    )]
    pub(crate) fn run(mut self) -> impl Future<Output = ()> + Send {
        async move {
            loop {
                let ending = self.live().await;
                let Some(after) = self.next_life(ending) else {
                    return;
                };
                tokio::select! {
                    biased;
                    () = self.mailbox.closed() => return self.membership.stopped(StopReason::Asked),
                    () = rare(sleep(after)) => {}
                }
            }
        }
    }

    /// One life: start, messages, stop.
    async fn live(&mut self) -> Ending {
        let mut actor = match self.start().await {
            Ok(actor) => actor,
            Err(ending) => return ending,
        };
        self.roster().report(Event::Started {
            id: self.membership.id.clone(),
        });
        let mut ending = Ending::Asked;
        while let Some(envelope) = self.mailbox.recv().await {
            let (healthy, flow) = match self.serve(actor, envelope).await {
                Ok(served) => served,
                Err(failure) => return failure,
            };
            actor = healthy;
            if flow == Flow::Stop(()) {
                ending = Ending::Finished;
                break;
            }
        }
        self.stop(actor).await.err().unwrap_or(ending)
    }

    /// The back-off before the next life; `None` when this was the last.
    fn next_life(&mut self, ending: Ending) -> Option<Duration> {
        let restart = self.roster().config.restart;
        let (cause, tag) = match ending {
            Ending::Overdue => return None,
            Ending::Asked => return self.last_life(StopReason::Asked),
            Ending::Finished if restart == Restart::Permanent => (Cause::Finished, None),
            Ending::Finished => return self.last_life(StopReason::Finished),
            Ending::Failed { cause, tag } => (cause, tag),
        };
        if restart == Restart::Temporary || self.mailbox.is_closed() {
            return self.last_life(StopReason::Failed { cause, tag });
        }
        let Some(after) = self.roster().on_failure(&self.membership.id, &cause, tag) else {
            return self.last_life(StopReason::Failed { cause, tag });
        };
        let id = self.membership.id.clone();
        self.roster().report(Event::Restarting {
            id,
            cause,
            tag,
            after,
        });
        Some(after)
    }

    fn last_life(&mut self, reason: StopReason) -> Option<Duration> {
        self.membership.stopped(reason);
        None
    }

    fn roster(&self) -> &Arc<Roster<I, A>> {
        &self.membership.roster
    }
}

/// The three steps of a life, each at the border to the actor's own code.
impl<I: Identity, A: Actor> Child<I, A> {
    async fn start(&mut self) -> Result<Box<A>, Ending> {
        let context = Arc::clone(&self.roster().context);
        let checkpoint = self.committed.clone();
        let started = self.execute(move |_| match guarded(|| A::start(&context, checkpoint)) {
            Ok(Ok(actor)) => Ok(Box::new(actor)),
            Ok(Err(error)) => Err(Cause::Failed(Arc::new(error))),
            Err(message) => Err(Cause::Panicked(message)),
        });
        Ending::or(started.await, None)
    }

    /// Handles one message and commits; on failure the answer is dropped here,
    /// which tells the sender.
    async fn serve(
        &mut self,
        actor: Box<A>,
        envelope: Envelope<A>,
    ) -> Result<(Box<A>, Flow), Ending> {
        let Envelope {
            message,
            tag,
            reply,
        } = envelope;
        let served = self
            .execute(move |progress| handle(actor, message, progress))
            .await;
        let Handled {
            actor,
            flow,
            checkpoint,
        } = Ending::or(served, Some(tag))?;
        self.committed = checkpoint;
        let (answer, flow) = match flow {
            Flow::Continue(answer) => (answer, Flow::Continue(())),
            Flow::Stop(answer) => (answer, Flow::Stop(())),
        };
        if let Some(reply) = reply {
            // Whoever asked may have stopped waiting.
            let _ = reply.send(answer);
        }
        Ok((actor, flow))
    }

    async fn stop(&mut self, mut actor: Box<A>) -> Result<(), Ending> {
        let stopped = self.execute(move |_| {
            let outcome = guarded(|| actor.stop());
            discard(actor);
            outcome.map_err(Cause::Panicked)
        });
        Ending::or(stopped.await, None)
    }

    /// Runs work where the configuration says; it is begun by the call itself.
    /// Work on the pool is waited for no longer than the shutdown time after
    /// the actor was told to stop.
    fn execute<T, F>(
        &mut self,
        work: F,
    ) -> impl Future<Output = Result<T, Interruption>> + Send + use<'_, I, A, T, F>
    where
        T: Send + 'static,
        F: FnOnce(&Progress) -> T + Send + 'static,
    {
        let begun = match &self.roster().config.placement {
            Placement::Inline => Begun::Ended(work(&Progress::default())),
            Placement::Pool(pool) => Begun::Queued(pool.run(work)),
        };
        async move {
            let job = match begun {
                Begun::Ended(value) => return Ok(value),
                Begun::Queued(job) => job,
            };
            tokio::select! {
                biased;
                outcome = job => outcome.map_err(Interruption::Lost),
                () = self.overdue() => Err(Interruption::Overdue),
            }
        }
    }

    async fn overdue(&mut self) {
        self.mailbox.closed().await;
        let patience = self.roster().config.shutdown;
        let deadline = *self
            .deadline
            .get_or_insert_with(|| Instant::now() + patience);
        rare(sleep_until(deadline)).await;
    }
}

/// On the heap, for a timer would be a third of the task of an actor that may
/// never fail nor hang.
fn rare(timer: Sleep) -> Pin<Box<Sleep>> {
    Box::pin(timer)
}

/// The actor stays outside the guarded call, so that its `Drop` runs after the
/// unwinding: a second panic during it would end the process.
fn handle<A: Actor>(
    mut actor: Box<A>,
    message: A::Message,
    progress: &Progress,
) -> Result<Handled<A>, Cause> {
    let outcome = guarded(|| {
        let flow = actor.handle(message, progress)?;
        Ok::<_, A::Error>((flow, actor.checkpoint()))
    });
    let cause = match outcome {
        Ok(Ok((flow, checkpoint))) => {
            return Ok(Handled {
                actor,
                flow,
                checkpoint,
            });
        }
        Ok(Err(error)) => Cause::Failed(Arc::new(error)),
        Err(message) => Cause::Panicked(message),
    };
    discard(actor);
    Err(cause)
}

impl Ending {
    /// The value of a step, or how the life ends because there is none.
    fn or<T>(outcome: Result<Result<T, Cause>, Interruption>, tag: Option<u64>) -> Result<T, Self> {
        match outcome {
            Ok(Ok(value)) => Ok(value),
            Ok(Err(cause)) => Err(Self::Failed { cause, tag }),
            Err(Interruption::Lost(lost)) => Err(Self::Failed {
                cause: Cause::Lost(lost),
                tag,
            }),
            Err(Interruption::Overdue) => Err(Self::Overdue),
        }
    }
}
