//! Why a message was not accepted.

use std::fmt;

/// Why a message was not accepted; it comes back inside.
#[derive(Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum SendError<T> {
    /// The mailbox is full and its policy is to refuse.
    Full(T),
    /// Nobody will receive any more.
    Closed(T),
}

impl<T> SendError<T> {
    /// The message that was not accepted.
    pub fn into_message(self) -> T {
        match self {
            Self::Full(message) | Self::Closed(message) => message,
        }
    }

    /// The same reason with the message unwrapped from what carried it.
    pub(crate) fn map<U>(self, unwrap: impl FnOnce(T) -> U) -> SendError<U> {
        match self {
            Self::Full(message) => SendError::Full(unwrap(message)),
            Self::Closed(message) => SendError::Closed(unwrap(message)),
        }
    }
}

impl<T> fmt::Display for SendError<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Full(_) => {
                "The message was refused, because the mailbox is full; try again later or slow down."
            }
            Self::Closed(_) => {
                "The message was not sent, because its receiver has stopped; \
                 do not send to it again."
            }
        })
    }
}

/// Without the message, so that any message can be sent and unwrapped.
impl<T> fmt::Debug for SendError<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Full(_) => "Full(..)",
            Self::Closed(_) => "Closed(..)",
        })
    }
}

impl<T> std::error::Error for SendError<T> {}
