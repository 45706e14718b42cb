//! Restart loop of one supervised actor: run, fail, back off, run again.

use std::sync::Arc;
use std::time::Duration;

use tokio::time::sleep;

use crate::actor::{Actor, Identity};
use crate::actor_loop::{ActorFailure, ActorLoop, LoopExit, boxed_sleep};
use crate::actor_registry::{ActorRegistry, Registration};
use crate::config::Restart;
use crate::event::{Cause, LifecycleEvent, StopReason};

/// Task of one supervised actor, through all its restarts.
///
/// Fields are dropped in this order: queued messages are returned and their senders
/// notified before the end is reported.
pub(crate) struct SupervisedActor<I: Identity, A: Actor> {
    actor_loop: ActorLoop<A>,
    registration: Registration<I, A>,
}

impl<I: Identity, A: Actor> SupervisedActor<I, A> {
    pub(crate) fn new(registration: Registration<I, A>, actor_loop: ActorLoop<A>) -> Self {
        Self {
            actor_loop,
            registration,
        }
    }

    /// Runs the actor until its last stop. A block rather than an `async fn`, whose
    /// future would hold the actor twice.
    #[expect(
        clippy::manual_async_fn,
        reason = "a quarter less memory for each idle actor"
    )]
    pub(crate) fn run(mut self) -> impl Future<Output = ()> + Send {
        async move {
            loop {
                let registration = &self.registration;
                let exit = self.actor_loop.run(|| registration.started()).await;
                let Some(after) = self.next_restart(exit) else {
                    return;
                };
                tokio::select! {
                    biased;
                    () = self.actor_loop.mailbox.closed() => {
                        return self.registration.stopped(StopReason::Requested);
                    }
                    () = boxed_sleep(sleep(after)) => {}
                }
            }
        }
    }

    /// Back-off before the next restart; `None` when there is none.
    fn next_restart(&mut self, exit: LoopExit) -> Option<Duration> {
        let restart = self.registry().config.restart;
        let ActorFailure { cause, tag } = match exit {
            LoopExit::StopTimedOut => return None,
            LoopExit::StopRequested => return self.stop_for_good(StopReason::Requested),
            LoopExit::Finished if restart == Restart::Permanent => ActorFailure {
                cause: Cause::Finished,
                tag: None,
            },
            LoopExit::Finished => return self.stop_for_good(StopReason::Finished),
            LoopExit::Failed(failure) => failure,
        };
        if restart == Restart::Temporary || self.actor_loop.mailbox.is_closed() {
            return self.stop_for_good(StopReason::Failed { cause, tag });
        }
        let Some(after) = self
            .registry()
            .on_failure(&self.registration.id, &cause, tag)
        else {
            return self.stop_for_good(StopReason::Failed { cause, tag });
        };
        let id = self.registration.id.clone();
        self.registry().report(LifecycleEvent::Restarting {
            id,
            cause,
            tag,
            after,
        });
        Some(after)
    }

    fn stop_for_good(&mut self, reason: StopReason) -> Option<Duration> {
        self.registration.stopped(reason);
        None
    }

    fn registry(&self) -> &Arc<ActorRegistry<I, A>> {
        &self.registration.registry
    }
}
