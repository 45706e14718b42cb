//! Log messages of the C library, kept for the caller.
//!
//! The library's log callback carries no user pointer. It is only called from inside a library
//! function, on the calling thread, and a [`crate::Kinect`] never leaves its thread: so the
//! messages are kept in a thread-local queue.

#![expect(unsafe_code, reason = "text arrives from C as a pointer")]

use crate::raw::Context;
use std::cell::RefCell;
use std::collections::VecDeque;
use std::ffi::{CStr, c_char, c_int};

/// Capacity of the queue. The oldest messages are dropped first: a faulty stream can complain
/// about every packet.
const MAX_MESSAGES: usize = 64;

thread_local! {
    static MESSAGES: RefCell<VecDeque<LogMessage>> = const { RefCell::new(VecDeque::new()) };
}

/// Severity of a log message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LogLevel {
    /// Log level of a failed operation (levels fatal and error).
    Error,
    /// Log level of a continued operation with a loss (level warning).
    Warning,
}

/// Log message of the library.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LogMessage {
    /// Severity of the log message.
    pub level: LogLevel,
    /// Text of the log message without the end of line.
    pub text: String,
}

/// Log callback of the library. Contains nothing that panics; a panic would abort the process
/// rather than unwind into C.
pub(crate) extern "C" fn on_message(_context: *mut Context, level: c_int, text: *const c_char) {
    if text.is_null() {
        return;
    }
    // SAFETY: the library passes a null-terminated buffer that lives during the call.
    let text = unsafe { CStr::from_ptr(text) };
    let level = if level <= 1 {
        LogLevel::Error
    } else {
        LogLevel::Warning
    };
    let text = text.to_string_lossy().trim_end().to_owned();
    // A message during thread exit has no reader.
    let _ = MESSAGES.try_with(|messages| {
        if let Ok(mut messages) = messages.try_borrow_mut() {
            if messages.len() == MAX_MESSAGES {
                messages.pop_front();
            }
            messages.push_back(LogMessage { level, text });
        }
    });
}

/// Takes all messages of this thread, oldest first.
pub(crate) fn take() -> Vec<LogMessage> {
    MESSAGES.with_borrow_mut(|messages| messages.drain(..).collect())
}

/// Takes all messages of this thread as one clause of an error.
pub(crate) fn take_as_clause() -> String {
    let texts: Vec<String> = take().into_iter().map(|message| message.text).collect();
    texts.join("; ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn say(level: c_int, text: &CStr) {
        on_message(std::ptr::null_mut(), level, text.as_ptr());
    }

    #[test]
    fn messages_are_kept_in_order_and_taken_once() {
        say(1, c"Could not open camera: -3\n");
        say(2, c"Lost packets\n");
        let expected = [
            (LogLevel::Error, "Could not open camera: -3"),
            (LogLevel::Warning, "Lost packets"),
        ];
        let taken = take();
        assert_eq!(taken.len(), 2);
        for (message, (level, text)) in taken.iter().zip(expected) {
            assert_eq!((message.level, message.text.as_str()), (level, text));
        }
        assert!(take().is_empty());
    }

    #[test]
    fn queue_overflow_drops_the_oldest() {
        for _ in 0..MAX_MESSAGES {
            say(2, c"old");
        }
        say(2, c"\xff new");
        on_message(std::ptr::null_mut(), 0, std::ptr::null());
        let taken = take();
        assert_eq!(taken.len(), MAX_MESSAGES);
        assert_eq!(taken[MAX_MESSAGES - 1].text, "\u{fffd} new");
    }
}
