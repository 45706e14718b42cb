//! Actor trait: state with a synchronous message handler.

use std::fmt::Debug;
use std::sync::Arc;

use crate::mailbox::Overflow;
use crate::progress::Progress;

/// Key of an actor within its supervisor, for instance a track-id.
pub trait Identity: Ord + Clone + Debug + Send + Sync + 'static {}

impl<T: Ord + Clone + Debug + Send + Sync + 'static> Identity for T {}

/// Control flow after a handled message, with the answer to it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flow<R = ()> {
    /// Keep running and wait for the next message.
    Continue(R),
    /// Stop the actor because its work is done.
    Stop(R),
}

/// State owned by one loop that handles one message at a time.
///
/// Everything here is synchronous and can be tested by calling it. An actor is not
/// notified before it is discarded after a failure: clean up in `Drop`, and in `stop`
/// only what needs an orderly end.
pub trait Actor: Sized + Send + 'static {
    /// Message type of the actor; one enum when there are several kinds.
    type Message: Send + 'static;
    /// Type of the answer to each handled message; `()` for none.
    type Reply: Send + 'static;
    /// State from which a restart continues, without caches.
    type Checkpoint: Clone + Send + 'static;
    /// Read-only data shared by all actors of this kind.
    type Context: Send + Sync + 'static;
    /// Error type of the message handler.
    type Error: std::error::Error + Send + Sync + 'static;
    /// Overflow policy of the actor's mailbox.
    type Overflow: Overflow;

    /// Builds the actor from a state, at its first start and at each restart.
    ///
    /// # Errors
    /// Any error that makes this state unusable; counts as a failure like one in
    /// [`handle`](Self::handle).
    fn start(
        context: &Arc<Self::Context>,
        checkpoint: Self::Checkpoint,
    ) -> Result<Self, Self::Error>;

    /// Handles one message; the answer is sent after the state was committed.
    ///
    /// # Errors
    /// Any error that leaves the state in doubt: the actor is discarded and rebuilt
    /// from its last checkpoint. A message that is merely useless is not an error but
    /// an answer.
    fn handle(
        &mut self,
        message: Self::Message,
        progress: &Progress,
    ) -> Result<Flow<Self::Reply>, Self::Error>;

    /// State to commit; called after each successfully handled message.
    fn checkpoint(&self) -> Self::Checkpoint;

    /// Orderly clean-up, called once after the last message. Not called after a
    /// failure.
    fn stop(&mut self) {}
}
