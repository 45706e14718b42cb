//! One life of an actor: start, messages, stop; each step at the border to the
//! actor's own code.

use std::pin::Pin;
use std::sync::Arc;
use std::time::Duration;

use tokio::sync::oneshot;
use tokio::time::{Instant, Sleep, sleep_until};

use crate::actor::{Actor, Flow};
use crate::address::Envelope;
use crate::border::{discard, guarded};
use crate::config::Placement;
use crate::event::Cause;
use crate::mailbox::Receiver;
use crate::progress::Progress;
use crate::worker_pool::JobLost;

/// What all lives of an actor, and its siblings', have in common.
pub(crate) struct Terms<A: Actor> {
    pub(crate) context: Arc<A::Context>,
    pub(crate) placement: Placement,
    /// How long work on the pool may go on after the actor was told to stop;
    /// `None` when somebody else ends it then.
    pub(crate) patience: Option<Duration>,
}

/// What outlasts a life: who lives again begins with it.
pub(crate) struct Life<A: Actor> {
    pub(crate) mailbox: Receiver<Envelope<A>, A::Overflow>,
    /// The last state that came out of a message handled with success.
    pub(crate) committed: A::Checkpoint,
    /// When the patience with a stopping actor ends; set once it was told to.
    deadline: Option<Instant>,
    terms: Arc<Terms<A>>,
}

/// How one life ends.
pub(crate) enum Ending {
    /// It was told to stop, by closing the mailbox.
    Asked,
    Finished,
    Failed(Failure),
    /// Told to stop, and still at work after the patience.
    Overdue,
}

/// The patience with work on the pool is over.
struct Overdue;

/// Why a life ended that should have gone on.
#[derive(Debug, Clone)]
pub(crate) struct Failure {
    pub(crate) cause: Cause,
    /// The tag of the message at work; `None` outside `handle`.
    pub(crate) tag: Option<u64>,
}

/// What comes back from a message handled with success.
struct Handled<A: Actor> {
    actor: Box<A>,
    flow: Flow<A::Reply>,
    checkpoint: A::Checkpoint,
}

impl<A: Actor> Life<A> {
    pub(crate) fn new(
        mailbox: Receiver<Envelope<A>, A::Overflow>,
        checkpoint: A::Checkpoint,
        terms: Arc<Terms<A>>,
    ) -> Self {
        Self {
            mailbox,
            committed: checkpoint,
            deadline: None,
            terms,
        }
    }

    /// Lives until the mailbox is closed or the actor ends by itself;
    /// `on_started` is called when it is ready for messages.
    pub(crate) async fn live(&mut self, on_started: impl FnOnce() + Send) -> Ending {
        let mut actor = match self.start().await {
            Ok(actor) => actor,
            Err(ending) => return ending,
        };
        on_started();
        let mut ending = Ending::Asked;
        while let Some(Envelope {
            message,
            tag,
            reply,
        }) = self.mailbox.recv().await
        {
            // Inline work leaves no trace in the future of this function, which
            // would be memory to touch for each message.
            let handled = match &self.terms.placement {
                Placement::Inline => handle(actor, message, &Progress::default()),
                Placement::Pool(pool) => {
                    let job = pool.run(move |progress| handle(actor, message, progress));
                    match self.patiently(job).await {
                        Ok(handled) => handled,
                        Err(Overdue) => return Ending::Overdue,
                    }
                }
            };
            let flow = match handled {
                Ok(handled) => {
                    actor = handled.actor;
                    self.commit(handled.checkpoint, handled.flow, reply)
                }
                // The answer is dropped here, which tells the sender.
                Err(cause) => return failed(cause, Some(tag)),
            };
            if flow == Flow::Stop(()) {
                ending = Ending::Finished;
                break;
            }
        }
        match self.stop(actor).await {
            Ok(()) => ending,
            Err(failure) => failure,
        }
    }

    async fn start(&mut self) -> Result<Box<A>, Ending> {
        let context = Arc::clone(&self.terms.context);
        let checkpoint = self.committed.clone();
        let started = match &self.terms.placement {
            Placement::Inline => start(&context, checkpoint),
            Placement::Pool(pool) => {
                let job = pool.run(move |_| start(&context, checkpoint));
                self.patiently(job).await?
            }
        };
        started.map_err(|cause| failed(cause, None))
    }

    async fn stop(&mut self, actor: Box<A>) -> Result<(), Ending> {
        let stopped = match &self.terms.placement {
            Placement::Inline => stop(actor),
            Placement::Pool(pool) => {
                let job = pool.run(move |_| stop(actor));
                self.patiently(job).await?
            }
        };
        stopped.map_err(|cause| failed(cause, None))
    }

    /// Commits the state, then answers.
    fn commit(
        &mut self,
        checkpoint: A::Checkpoint,
        flow: Flow<A::Reply>,
        reply: Option<oneshot::Sender<A::Reply>>,
    ) -> Flow {
        self.committed = checkpoint;
        let (answer, flow) = match flow {
            Flow::Continue(answer) => (answer, Flow::Continue(())),
            Flow::Stop(answer) => (answer, Flow::Stop(())),
        };
        if let Some(reply) = reply {
            // Whoever asked may have stopped waiting.
            let _ = reply.send(answer);
        }
        flow
    }

    /// Awaits work on the pool, no longer than the patience with an actor told
    /// to stop.
    async fn patiently<T>(
        &mut self,
        job: impl Future<Output = Result<Result<T, Cause>, JobLost>>,
    ) -> Result<Result<T, Cause>, Overdue> {
        tokio::select! {
            biased;
            outcome = job => Ok(outcome.unwrap_or_else(|lost| Err(Cause::Lost(lost)))),
            () = self.overdue() => Err(Overdue),
        }
    }

    /// Returns when the patience with an actor told to stop is over.
    async fn overdue(&mut self) {
        self.mailbox.closed().await;
        let Some(patience) = self.terms.patience else {
            return std::future::pending().await;
        };
        let deadline = *self
            .deadline
            .get_or_insert_with(|| Instant::now() + patience);
        rare(sleep_until(deadline)).await;
    }
}

/// On the heap, for a timer would be a third of the task of an actor that may
/// never fail nor hang.
pub(crate) fn rare(timer: Sleep) -> Pin<Box<Sleep>> {
    Box::pin(timer)
}

fn start<A: Actor>(context: &Arc<A::Context>, checkpoint: A::Checkpoint) -> Result<Box<A>, Cause> {
    match guarded(|| A::start(context, checkpoint)) {
        Ok(Ok(actor)) => Ok(Box::new(actor)),
        Ok(Err(error)) => Err(Cause::Failed(Arc::new(error))),
        Err(message) => Err(Cause::Panicked(message)),
    }
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

fn stop<A: Actor>(mut actor: Box<A>) -> Result<(), Cause> {
    let outcome = guarded(|| actor.stop());
    discard(actor);
    outcome.map_err(Cause::Panicked)
}

fn failed(cause: Cause, tag: Option<u64>) -> Ending {
    Ending::Failed(Failure { cause, tag })
}

impl From<Overdue> for Ending {
    fn from(Overdue: Overdue) -> Self {
        Self::Overdue
    }
}
