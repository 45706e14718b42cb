//! Actor address: the handle that sends messages (tell and ask patterns).

use std::fmt;

use tokio::sync::oneshot;

use crate::actor::Actor;
use crate::mailbox::{Backpressure, Immediate, SendError, Sender};
use crate::reply::{PendingReply, reply_channel};

/// Envelope of a queued message: its tag and the channel for its answer.
pub(crate) struct Envelope<A: Actor> {
    pub(crate) message: A::Message,
    pub(crate) tag: u64,
    pub(crate) reply: Option<oneshot::Sender<A::Reply>>,
}

impl<A: Actor> Envelope<A> {
    fn new(tag: u64, message: A::Message, reply: Option<oneshot::Sender<A::Reply>>) -> Self {
        Self {
            message,
            tag,
            reply,
        }
    }
}

/// Handle for sending to one actor through all its restarts; cheap to clone.
///
/// Each message carries a tag, for instance the frame's sequence number, by which
/// events name the message on which an actor failed.
pub struct Address<A: Actor, P = <A as Actor>::Overflow>(Sender<Envelope<A>, P>);

impl<A: Actor, P> Address<A, P> {
    pub(crate) fn new(mailbox: Sender<Envelope<A>, P>) -> Self {
        Self(mailbox)
    }

    /// Number of messages displaced by newer ones.
    pub fn n_dropped(&self) -> u64 {
        self.0.dropped()
    }

    /// `true` after the actor was stopped: no further message reaches it.
    pub fn is_closed(&self) -> bool {
        self.0.is_closed()
    }

    pub(crate) fn close(&self) {
        self.0.close();
    }
}

impl<A: Actor, P: Immediate> Address<A, P> {
    /// Sends a message without asking for an answer (fire and forget).
    ///
    /// # Errors
    /// [`SendError`] when the mailbox refuses or the actor has stopped.
    pub fn tell(&self, tag: u64, message: A::Message) -> Result<(), SendError<A::Message>> {
        self.0
            .send(Envelope::new(tag, message, None))
            .map_err(returned)
    }

    /// Sends a message and returns the future of its answer.
    ///
    /// # Errors
    /// [`SendError`] when the mailbox refuses or the actor has stopped.
    pub fn ask(
        &self,
        tag: u64,
        message: A::Message,
    ) -> Result<PendingReply<A::Reply>, SendError<A::Message>> {
        let (reply, answer) = reply_channel();
        self.0
            .send(Envelope::new(tag, message, Some(reply)))
            .map_err(returned)?;
        Ok(answer)
    }
}

impl<A: Actor> Address<A, Backpressure> {
    /// Sends a message without asking for an answer; waits for room in the mailbox.
    ///
    /// # Errors
    /// [`SendError::Closed`] when the actor has stopped.
    pub async fn tell(&self, tag: u64, message: A::Message) -> Result<(), SendError<A::Message>> {
        self.0
            .send(Envelope::new(tag, message, None))
            .await
            .map_err(returned)
    }

    /// Waits for room in the mailbox, sends a message and returns the future of its
    /// answer.
    ///
    /// # Errors
    /// [`SendError::Closed`] when the actor has stopped.
    pub async fn ask(
        &self,
        tag: u64,
        message: A::Message,
    ) -> Result<PendingReply<A::Reply>, SendError<A::Message>> {
        let (reply, answer) = reply_channel();
        self.0
            .send(Envelope::new(tag, message, Some(reply)))
            .await
            .map_err(returned)?;
        Ok(answer)
    }
}

fn returned<A: Actor>(error: SendError<Envelope<A>>) -> SendError<A::Message> {
    error.map(|envelope| envelope.message)
}

impl<A: Actor, P> Clone for Address<A, P> {
    fn clone(&self) -> Self {
        Self(self.0.clone())
    }
}

impl<A: Actor, P> fmt::Debug for Address<A, P> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Address")
            .field("dropped", &self.n_dropped())
            .finish_non_exhaustive()
    }
}
