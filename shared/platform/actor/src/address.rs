//! Where an actor is sent its messages.

use std::fmt;

use tokio::sync::oneshot;

use crate::actor::Actor;
use crate::mailbox::{Block, Immediate, SendError, Sender};
use crate::reply::{Answer, answer};

/// A message under way: what the mailbox of an actor holds.
pub(crate) struct Envelope<A: Actor> {
    pub(crate) message: A::Message,
    pub(crate) tag: u64,
    pub(crate) reply: Option<oneshot::Sender<A::Reply>>,
}

/// Sends to one actor, through all its restarts; cheap to clone.
///
/// Each message carries a tag, for instance the frame's sequence number, by
/// which events name the message an actor failed on.
pub struct Address<A: Actor, P = <A as Actor>::Overflow>(Sender<Envelope<A>, P>);

impl<A: Actor, P> Address<A, P> {
    pub(crate) fn new(mailbox: Sender<Envelope<A>, P>) -> Self {
        Self(mailbox)
    }

    /// How many messages were displaced by newer ones.
    pub fn dropped(&self) -> u64 {
        self.0.dropped()
    }

    /// Whether the actor was stopped, so that nothing reaches it any more.
    pub fn is_closed(&self) -> bool {
        self.0.is_closed()
    }

    pub(crate) fn close(&self) {
        self.0.close();
    }
}

impl<A: Actor, P: Immediate> Address<A, P> {
    /// Sends a message whose answer nobody needs.
    ///
    /// # Errors
    /// [`SendError`] when the mailbox refuses or the actor has stopped.
    pub fn tell(&self, tag: u64, message: A::Message) -> Result<(), SendError<A::Message>> {
        self.0
            .send(Envelope {
                message,
                tag,
                reply: None,
            })
            .map_err(returned)
    }

    /// Sends a message and promises its answer.
    ///
    /// # Errors
    /// [`SendError`] when the mailbox refuses or the actor has stopped.
    pub fn ask(
        &self,
        tag: u64,
        message: A::Message,
    ) -> Result<Answer<A::Reply>, SendError<A::Message>> {
        let (reply, answer) = answer();
        self.0
            .send(Envelope {
                message,
                tag,
                reply: Some(reply),
            })
            .map_err(returned)?;
        Ok(answer)
    }
}

impl<A: Actor> Address<A, Block> {
    /// Sends a message whose answer nobody needs, once there is room.
    ///
    /// # Errors
    /// [`SendError::Closed`] when the actor has stopped.
    pub async fn tell(&self, tag: u64, message: A::Message) -> Result<(), SendError<A::Message>> {
        self.0
            .send(Envelope {
                message,
                tag,
                reply: None,
            })
            .await
            .map_err(returned)
    }

    /// Sends a message, once there is room, and promises its answer.
    ///
    /// # Errors
    /// [`SendError::Closed`] when the actor has stopped.
    pub async fn ask(
        &self,
        tag: u64,
        message: A::Message,
    ) -> Result<Answer<A::Reply>, SendError<A::Message>> {
        let (reply, answer) = answer();
        self.0
            .send(Envelope {
                message,
                tag,
                reply: Some(reply),
            })
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
            .field("dropped", &self.dropped())
            .finish_non_exhaustive()
    }
}
