//! Being asked to stop, for a program without a runtime.

use service::{Failure, exit_code};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;
use tokio::signal::unix::{SignalKind, signal};

/// Raised by SIGINT, SIGTERM or SIGHUP; sleeping ends when it is raised.
#[derive(Debug, Clone)]
pub struct StopSignal(Arc<(Mutex<bool>, Condvar)>);

impl StopSignal {
    /// Takes over the signals, on a thread of its own.
    ///
    /// # Errors
    /// When the signals can not be listened for.
    pub fn install() -> Result<Self, Failure> {
        let failed = |error| {
            Failure::new(
                exit_code::FAILURE,
                format!("could not listen for signals: {error}"),
            )
        };
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

    /// Whether the signal was raised.
    pub fn is_raised(&self) -> bool {
        *self.0.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Sleeps for a while, less when the signal is raised.
    pub fn sleep(&self, time: Duration) {
        let (raised, condition) = &*self.0;
        let guard = raised.lock().unwrap_or_else(PoisonError::into_inner);
        let _ = condition.wait_timeout_while(guard, time, |raised| !*raised);
    }

    fn raise(&self) {
        *self.0.0.lock().unwrap_or_else(PoisonError::into_inner) = true;
        self.0.1.notify_all();
    }
}
