//! Whether the run is to end early, so that it ends in order.

use std::sync::atomic::{AtomicBool, Ordering};
use tokio::signal::unix::{SignalKind, signal};

static IS_ASKED: AtomicBool = AtomicBool::new(false);

pub fn is_asked() -> bool {
    IS_ASKED.load(Ordering::Relaxed)
}

/// From now on a signal to end is remembered and does nothing else.
pub fn watch() {
    std::thread::spawn(|| {
        crate::reactor::runtime().block_on(async {
            let signals = [SignalKind::interrupt(), SignalKind::terminate()].map(signal);
            let [Ok(mut interrupt), Ok(mut terminate)] = signals else {
                return;
            };
            tokio::select! {
                _ = interrupt.recv() => {}
                _ = terminate.recv() => {}
            }
            IS_ASKED.store(true, Ordering::Relaxed);
            // Who is asked twice still ends in order.
            std::future::pending::<()>().await;
        });
    });
}
