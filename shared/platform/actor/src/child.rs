//! One supervised actor: the task that lives its lives.

use std::sync::Arc;
use std::time::Duration;

use tokio::time::sleep;

use crate::actor::{Actor, Identity};
use crate::config::Restart;
use crate::event::{Cause, Event, StopReason};
use crate::life::{Ending, Failure, Life, rare};
use crate::roster::{Membership, Roster};

/// Fields are dropped in this order: messages are returned and their senders
/// told before the end is reported.
pub(crate) struct Child<I: Identity, A: Actor> {
    life: Life<A>,
    membership: Membership<I, A>,
}

impl<I: Identity, A: Actor> Child<I, A> {
    pub(crate) fn new(membership: Membership<I, A>, life: Life<A>) -> Self {
        Self { life, membership }
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
                let membership = &self.membership;
                let ending = self.life.live(|| membership.started()).await;
                let Some(after) = self.next_life(ending) else {
                    return;
                };
                tokio::select! {
                    biased;
                    () = self.life.mailbox.closed() => {
                        return self.membership.stopped(StopReason::Asked);
                    }
                    () = rare(sleep(after)) => {}
                }
            }
        }
    }

    /// The back-off before the next life; `None` when this was the last.
    fn next_life(&mut self, ending: Ending) -> Option<Duration> {
        let restart = self.roster().config.restart;
        let Failure { cause, tag } = match ending {
            Ending::Overdue => return None,
            Ending::Asked => return self.last_life(StopReason::Asked),
            Ending::Finished if restart == Restart::Permanent => Failure {
                cause: Cause::Finished,
                tag: None,
            },
            Ending::Finished => return self.last_life(StopReason::Finished),
            Ending::Failed(failure) => failure,
        };
        if restart == Restart::Temporary || self.life.mailbox.is_closed() {
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
