//! Error of sending to a mailbox.

use std::fmt;

/// Error with the message that the mailbox did not accept.
#[derive(Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SendError<T> {
    /// Full mailbox whose policy is to refuse.
    #[error("The message was refused, because the mailbox is full; try again later or slow down.")]
    Full(T),
    /// Receiver of the mailbox is gone.
    #[error(
        "The message was not sent, because its receiver has stopped; \
         do not send to it again."
    )]
    Closed(T),
}

impl<T> SendError<T> {
    /// Returns the message that the mailbox did not accept.
    pub fn into_message(self) -> T {
        match self {
            Self::Full(message) | Self::Closed(message) => message,
        }
    }

    /// Converts the message of the error, keeping the reason.
    pub(crate) fn map<U>(self, unwrap: impl FnOnce(T) -> U) -> SendError<U> {
        match self {
            Self::Full(message) => SendError::Full(unwrap(message)),
            Self::Closed(message) => SendError::Closed(unwrap(message)),
        }
    }
}

/// `Debug` without the message, so that any message type can be sent and unwrapped.
impl<T> fmt::Debug for SendError<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Full(_) => "Full(..)",
            Self::Closed(_) => "Closed(..)",
        })
    }
}
