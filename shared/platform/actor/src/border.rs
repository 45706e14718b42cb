//! The one place where a panic is caught.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Runs foreign code; a panic comes back as its message.
///
/// `AssertUnwindSafe` is right because no caller in this crate uses what the
/// closure could have left half-changed: a broken actor is discarded and
/// rebuilt from a copy made before, a broken job's result never existed, and
/// no lock is held across the call.
pub(crate) fn guarded<T>(foreign: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(foreign)).map_err(message_of)
}

/// Drops a foreign value; a panic in its `Drop` goes no further. The value is
/// lost anyway and the panic hook has already told its message.
pub(crate) fn discard<T>(value: T) {
    let _ = guarded(|| drop(value));
}

/// What a caught panic said.
pub(crate) fn message_of(payload: Box<dyn Any + Send>) -> String {
    let payload = match payload.downcast::<&'static str>() {
        Ok(text) => return (*text).to_owned(),
        Err(other) => other,
    };
    match payload.downcast::<String>() {
        Ok(text) => *text,
        Err(other) => {
            // A payload of unknown type may panic in its own `Drop`, outside
            // this border: leaking it is the lesser evil.
            std::mem::forget(other);
            "a panic without a text".to_owned()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_of_panic_becomes_a_text() {
        struct Bomb;
        impl Drop for Bomb {
            fn drop(&mut self) {
                panic!("in drop");
            }
        }
        assert_eq!(guarded(|| 7), Ok(7));
        assert_eq!(
            guarded(|| panic!("plain")),
            Err::<(), _>("plain".to_owned())
        );
        assert_eq!(
            guarded(|| panic!("frame {}", 3)),
            Err::<(), _>("frame 3".to_owned())
        );
        assert_eq!(
            guarded(|| std::panic::panic_any(Bomb)),
            Err::<(), _>("a panic without a text".to_owned())
        );
        discard(Bomb);
    }
}
