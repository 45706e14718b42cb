//! Stop signal of a program without an async runtime.

use parking_lot::{Condvar, Mutex};
use service::Failure;
use std::sync::Arc;
use std::time::Duration;
use tokio::signal::unix::{SignalKind, signal};

/// Stop signal, raised by SIGINT, SIGTERM or SIGHUP; sleeping ends when it is raised.
#[derive(Debug, Clone)]
pub struct StopSignal(Arc<(Mutex<bool>, Condvar)>);

impl StopSignal {
    /// Installs the signal handlers, on a separate thread.
    ///
    /// # Errors
    /// When the signal handlers cannot be installed.
    pub fn install() -> Result<Self, Failure> {
        let failed = |error| Failure::general(format!("could not listen for signals: {error}"));
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_io()
            .build()
            .map_err(failed)?;
        let raised = Self(Arc::default());
        let entered = runtime.enter();
        let mut interrupt = signal(SignalKind::interrupt()).map_err(failed)?;
        let mut terminate = signal(SignalKind::terminate()).map_err(failed)?;
        let mut hang_up = signal(SignalKind::hangup()).map_err(failed)?;
        drop(entered);
        let to_raise = raised.clone();
        std::thread::spawn(move || {
            runtime.block_on(async {
                tokio::select! {
                    _ = interrupt.recv() => {}
                    _ = terminate.recv() => {}
                    _ = hang_up.recv() => {}
                }
            });
            to_raise.raise();
        });
        Ok(raised)
    }

    /// `true` after the stop signal was raised.
    pub fn is_raised(&self) -> bool {
        *self.0.0.lock()
    }

    /// Sleeps for `time`, less when the signal is raised.
    pub fn sleep(&self, time: Duration) {
        let (raised, condition) = &*self.0;
        let mut guard = raised.lock();
        let _ = condition.wait_while_for(&mut guard, |raised| !*raised, time);
    }

    fn raise(&self) {
        *self.0.0.lock() = true;
        self.0.1.notify_all();
    }
}
