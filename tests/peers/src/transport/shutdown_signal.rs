//! Graceful shutdown on SIGINT and SIGTERM.

use std::sync::atomic::{AtomicBool, Ordering};
use tokio::signal::unix::{SignalKind, signal};

/// Flag set by the first signal.
static IS_REQUESTED: AtomicBool = AtomicBool::new(false);

/// `true` after a termination signal.
pub fn is_requested() -> bool {
    IS_REQUESTED.load(Ordering::Relaxed)
}

/// Starts a thread that turns termination signals into the flag, instead of ending the process.
pub fn watch() {
    std::thread::spawn(|| {
        crate::tokio_runtime::runtime().block_on(async {
            let signals = [SignalKind::interrupt(), SignalKind::terminate()].map(signal);
            let [Ok(mut interrupt), Ok(mut terminate)] = signals else {
                return;
            };
            tokio::select! {
                _ = interrupt.recv() => {}
                _ = terminate.recv() => {}
            }
            IS_REQUESTED.store(true, Ordering::Relaxed);
            // Keeps the handlers installed, so that a second signal does not end the process either.
            std::future::pending::<()>().await;
        });
    });
}
