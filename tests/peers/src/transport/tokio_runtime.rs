//! Where those wait who wait with tokio.

use tokio::runtime::{Builder, Runtime};

/// One thread, which is also the one that works with what comes.
pub fn runtime() -> Runtime {
    let runtime = Builder::new_current_thread().enable_io().build();
    runtime.expect("a runtime")
}
