//! Pending reply to one message (ask pattern).

use std::pin::Pin;
use std::task::{Context, Poll};

use tokio::sync::oneshot;

/// Future of an answer. Always resolves: to [`ReplyLost`] when the message was displaced,
/// its handler failed, or the actor stopped before reaching it.
#[derive(Debug)]
#[must_use = "an answer nobody awaits should be a `tell`"]
pub struct PendingReply<R>(oneshot::Receiver<R>);

/// Error of a message that was lost before it was answered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "The message was lost before it was answered; the actor's events say whether it \
     failed or stopped, and its mailbox counts what was displaced."
)]
pub struct ReplyLost;

impl<R> Future for PendingReply<R> {
    type Output = Result<R, ReplyLost>;

    fn poll(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Self::Output> {
        Pin::new(&mut self.0)
            .poll(context)
            .map(|answer| answer.map_err(|_| ReplyLost))
    }
}

/// One-shot channel for one answer; dropping the sender resolves the future to
/// [`ReplyLost`].
pub(crate) fn reply_channel<R>() -> (oneshot::Sender<R>, PendingReply<R>) {
    let (sender, receiver) = oneshot::channel();
    (sender, PendingReply(receiver))
}
