//! The answer to one message.

use std::fmt;
use std::pin::Pin;
use std::task::{Context, Poll};

use tokio::sync::oneshot;

/// The answer to come. Resolves in every case: to [`Lost`] when the message was
/// displaced, its handler failed, or the actor stopped before reaching it.
#[derive(Debug)]
#[must_use = "an answer nobody awaits should be a `tell`"]
pub struct Answer<R>(oneshot::Receiver<R>);

/// No answer will come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Lost;

impl fmt::Display for Lost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            "The message was lost before it was answered; the actor's events say whether it \
             failed or stopped, and its mailbox counts what was displaced.",
        )
    }
}

impl std::error::Error for Lost {}

impl<R> Future for Answer<R> {
    type Output = Result<R, Lost>;

    fn poll(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Self::Output> {
        Pin::new(&mut self.0)
            .poll(context)
            .map(|answer| answer.map_err(|_| Lost))
    }
}

/// The two ends of one answer; dropping the sender loses it.
pub(crate) fn answer<R>() -> (oneshot::Sender<R>, Answer<R>) {
    let (sender, receiver) = oneshot::channel();
    (sender, Answer(receiver))
}
