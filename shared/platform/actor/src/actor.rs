//! What an actor is.

use std::fmt::Debug;
use std::sync::Arc;

use crate::mailbox::Overflow;
use crate::progress::Progress;

/// What names an actor, for instance a track-id.
pub trait Identity: Ord + Clone + Debug + Send + Sync + 'static {}

impl<T: Ord + Clone + Debug + Send + Sync + 'static> Identity for T {}

/// What the actor wants after a message, with the answer to it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flow<R = ()> {
    /// Wait for the next message.
    Continue(R),
    /// The work is done: stop.
    Stop(R),
}

/// State owned by one loop that handles one message at a time.
///
/// Everything here is synchronous and can be tested by calling it. An actor is
/// never told of its death: clean up in `Drop`, and in `stop` only what needs
/// an orderly end.
pub trait Actor: Sized + Send + 'static {
    /// What it is sent; one enum when there are several kinds.
    type Message: Send + 'static;
    /// What each handled message is answered with; `()` when nothing is.
    type Reply: Send + 'static;
    /// What a successor needs to carry on: the state, without caches.
    type Checkpoint: Clone + Send + 'static;
    /// What all actors of this kind share and none of them changes.
    type Context: Send + Sync + 'static;
    /// Why a message could not be handled.
    type Error: std::error::Error + Send + Sync + 'static;
    /// What a full mailbox does.
    type Overflow: Overflow;

    /// Builds the actor, for its first life as for any later one.
    ///
    /// # Errors
    /// Whatever makes this state unusable; counts as a failure like one in
    /// [`handle`](Self::handle).
    fn start(
        context: &Arc<Self::Context>,
        checkpoint: Self::Checkpoint,
    ) -> Result<Self, Self::Error>;

    /// Handles one message. The answer is sent after the state was committed.
    ///
    /// # Errors
    /// Whatever leaves the state in doubt: the actor is discarded and rebuilt
    /// from its last checkpoint. A message that is merely useless is not an
    /// error but an answer.
    fn handle(
        &mut self,
        message: Self::Message,
        progress: &Progress,
    ) -> Result<Flow<Self::Reply>, Self::Error>;

    /// The state to commit; called after each message handled with success.
    fn checkpoint(&self) -> Self::Checkpoint;

    /// Ends in good order: called once after the last message, not after a
    /// failure.
    fn stop(&mut self) {}
}
