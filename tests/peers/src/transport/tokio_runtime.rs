//! Tokio runtime of the systems whose receiver sleeps in a task.

use tokio::runtime::{Builder, Runtime};

/// Current-thread runtime: the calling thread also handles the messages.
pub fn runtime() -> Runtime {
    let runtime = Builder::new_current_thread().enable_io().build();
    runtime.expect("a tokio runtime")
}
