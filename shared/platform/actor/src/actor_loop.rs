//! Actor loop: start, handle messages, stop. Each call of user code goes through the
//! panic boundary.

use std::pin::Pin;
use std::sync::Arc;
use std::time::Duration;

use tokio::sync::oneshot;
use tokio::time::{Instant, Sleep, sleep_until};

use crate::actor::{Actor, Flow};
use crate::address::Envelope;
use crate::config::Placement;
use crate::event::Cause;
use crate::mailbox::Receiver;
use crate::panic_boundary::{catch_panic, drop_caught};
use crate::progress::Progress;
use crate::worker_pool::JobLost;

/// Settings shared by the loops of all actors of a supervisor.
pub(crate) struct LoopConfig<A: Actor> {
    pub(crate) context: Arc<A::Context>,
    pub(crate) placement: Placement,
    /// Longest time that work on the pool may take after the request to stop.
    pub(crate) stop_timeout: Duration,
}

/// Message loop of one actor. Mailbox and committed state survive restarts.
pub(crate) struct ActorLoop<A: Actor> {
    pub(crate) mailbox: Receiver<Envelope<A>, A::Overflow>,
    /// Checkpoint of the last successfully handled message.
    committed: A::Checkpoint,
    /// Deadline of an orderly stop; set when the stop is requested.
    deadline: Option<Instant>,
    config: Arc<LoopConfig<A>>,
}

/// Exit of one run of the loop.
pub(crate) enum LoopExit {
    /// Stop requested by closing the mailbox.
    StopRequested,
    Finished,
    Failed(ActorFailure),
    /// Stop requested, and the handler exceeded the time limit.
    StopTimedOut,
}

/// Time limit of an orderly stop exceeded.
struct StopTimedOut;

/// Failure of an actor: cause and message.
#[derive(Debug, Clone)]
pub(crate) struct ActorFailure {
    pub(crate) cause: Cause,
    /// Tag of the message being handled; `None` outside `handle`.
    pub(crate) tag: Option<u64>,
}

/// Result of a successfully handled message.
struct Handled<A: Actor> {
    actor: Box<A>,
    flow: Flow<A::Reply>,
    checkpoint: A::Checkpoint,
}

impl<A: Actor> ActorLoop<A> {
    pub(crate) fn new(
        mailbox: Receiver<Envelope<A>, A::Overflow>,
        checkpoint: A::Checkpoint,
        config: Arc<LoopConfig<A>>,
    ) -> Self {
        Self {
            mailbox,
            committed: checkpoint,
            deadline: None,
            config,
        }
    }

    /// Runs the actor until the mailbox is closed or the actor stops itself;
    /// `on_started` is called when it is ready for messages.
    pub(crate) async fn run(&mut self, on_started: impl FnOnce() + Send) -> LoopExit {
        let mut actor = match self.start().await {
            Ok(actor) => actor,
            Err(exit) => return exit,
        };
        on_started();
        let mut exit = LoopExit::StopRequested;
        while let Some(Envelope {
            message,
            tag,
            reply,
        }) = self.mailbox.recv().await
        {
            // Inline work leaves no trace in the future of this function, which would
            // be memory to touch for each message.
            let handled = match &self.config.placement {
                Placement::Inline => handle(actor, message, &Progress::default()),
                Placement::Pool(pool) => {
                    let job = pool.run(move |progress| handle(actor, message, progress));
                    match self.with_stop_timeout(job).await {
                        Ok(handled) => handled,
                        Err(StopTimedOut) => return LoopExit::StopTimedOut,
                    }
                }
            };
            let flow = match handled {
                Ok(handled) => {
                    actor = handled.actor;
                    self.commit(handled.checkpoint, handled.flow, reply)
                }
                // Dropping the answer's channel notifies the sender.
                Err(cause) => return failed(cause, Some(tag)),
            };
            if flow == Flow::Stop(()) {
                exit = LoopExit::Finished;
                break;
            }
        }
        match self.stop(actor).await {
            Ok(()) => exit,
            Err(failure) => failure,
        }
    }

    async fn start(&mut self) -> Result<Box<A>, LoopExit> {
        let context = Arc::clone(&self.config.context);
        let checkpoint = self.committed.clone();
        let started = match &self.config.placement {
            Placement::Inline => start(&context, checkpoint),
            Placement::Pool(pool) => {
                let job = pool.run(move |_| start(&context, checkpoint));
                self.with_stop_timeout(job).await?
            }
        };
        started.map_err(|cause| failed(cause, None))
    }

    async fn stop(&mut self, actor: Box<A>) -> Result<(), LoopExit> {
        let stopped = match &self.config.placement {
            Placement::Inline => stop(actor),
            Placement::Pool(pool) => {
                let job = pool.run(move |_| stop(actor));
                self.with_stop_timeout(job).await?
            }
        };
        stopped.map_err(|cause| failed(cause, None))
    }

    /// Commits the actor's state, then answers the message.
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
            // The sender may have stopped waiting.
            let _ = reply.send(answer);
        }
        flow
    }

    /// Awaits work on the pool, after a stop request no longer than the time limit.
    async fn with_stop_timeout<T>(
        &mut self,
        job: impl Future<Output = Result<Result<T, Cause>, JobLost>>,
    ) -> Result<Result<T, Cause>, StopTimedOut> {
        tokio::select! {
            biased;
            outcome = job => Ok(outcome.unwrap_or_else(|lost| Err(Cause::ReplyLost(lost)))),
            () = self.stop_timed_out() => Err(StopTimedOut),
        }
    }

    /// Returns when the time limit of a requested stop has passed.
    async fn stop_timed_out(&mut self) {
        self.mailbox.closed().await;
        let deadline = *self
            .deadline
            .get_or_insert_with(|| Instant::now() + self.config.stop_timeout);
        boxed_sleep(sleep_until(deadline)).await;
    }
}

/// Timer on the heap: inline it would be a third of the task of an actor that may
/// never fail nor hang.
pub(crate) fn boxed_sleep(timer: Sleep) -> Pin<Box<Sleep>> {
    Box::pin(timer)
}

fn start<A: Actor>(context: &Arc<A::Context>, checkpoint: A::Checkpoint) -> Result<Box<A>, Cause> {
    match catch_panic(|| A::start(context, checkpoint)) {
        Ok(Ok(actor)) => Ok(Box::new(actor)),
        Ok(Err(error)) => Err(Cause::Failed(Arc::new(error))),
        Err(message) => Err(Cause::Panicked(message)),
    }
}

/// Handles one message behind the panic boundary. The actor stays outside the guarded
/// call, so that its `Drop` runs after the unwinding: a second panic during it would
/// end the process.
fn handle<A: Actor>(
    mut actor: Box<A>,
    message: A::Message,
    progress: &Progress,
) -> Result<Handled<A>, Cause> {
    let outcome = catch_panic(|| {
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
    drop_caught(actor);
    Err(cause)
}

fn stop<A: Actor>(mut actor: Box<A>) -> Result<(), Cause> {
    let outcome = catch_panic(|| actor.stop());
    drop_caught(actor);
    outcome.map_err(Cause::Panicked)
}

fn failed(cause: Cause, tag: Option<u64>) -> LoopExit {
    LoopExit::Failed(ActorFailure { cause, tag })
}

impl From<StopTimedOut> for LoopExit {
    fn from(StopTimedOut: StopTimedOut) -> Self {
        Self::StopTimedOut
    }
}
