//! Panic boundary: the only place of this crate that catches panics (`catch_unwind`).

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Runs user code and returns a panic as its message.
///
/// `AssertUnwindSafe` is right because no caller in this crate uses state that the
/// closure could have left half-changed: a broken actor is discarded and rebuilt from
/// a copy made before, a broken job's result never existed, and no lock is held
/// across the call.
pub(crate) fn catch_panic<T>(foreign: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(foreign)).map_err(message_of)
}

/// Drops a user value and swallows a panic of its `Drop`. The value is lost anyway,
/// and the panic hook has already reported the message.
pub(crate) fn drop_caught<T>(value: T) {
    let _ = catch_panic(|| drop(value));
}

/// Panic message of a caught panic.
fn message_of(payload: Box<dyn Any + Send>) -> String {
    let payload = match payload.downcast::<&'static str>() {
        Ok(text) => return (*text).to_owned(),
        Err(other) => other,
    };
    match payload.downcast::<String>() {
        Ok(text) => *text,
        Err(other) => {
            // A payload of unknown type may panic in its own `Drop`, outside this
            // boundary: leaking it is the lesser evil.
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
        assert_eq!(catch_panic(|| 7), Ok(7));
        assert_eq!(
            catch_panic(|| panic!("plain")),
            Err::<(), _>("plain".to_owned())
        );
        assert_eq!(
            catch_panic(|| panic!("frame {}", 3)),
            Err::<(), _>("frame 3".to_owned())
        );
        assert_eq!(
            catch_panic(|| std::panic::panic_any(Bomb)),
            Err::<(), _>("a panic without a text".to_owned())
        );
        drop_caught(Bomb);
    }
}
