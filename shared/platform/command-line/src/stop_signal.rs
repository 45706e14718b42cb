//! Stop signal of a program without an async runtime.

use crate::reader_watch::watch_reader;
use parking_lot::{Condvar, Mutex};
use service::Failure;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use tokio::signal::unix::{SignalKind, signal};

/// Stop signal, raised by SIGINT, SIGTERM or SIGHUP; sleeping ends when it is raised.
#[derive(Debug, Clone)]
pub struct StopSignal(Arc<(Mutex<Raised>, Condvar)>);

/// Signals that came so far.
#[derive(Debug, Clone, Copy, Default)]
struct Raised {
    n_raised: u32,
    /// SIGTERM or SIGHUP was one of them.
    is_terminated: bool,
}

/// Note of received SIGHUPs, for a program that does not stop at them.
#[derive(Debug, Clone, Default)]
pub struct HangUps(Arc<AtomicBool>);

impl HangUps {
    /// Takes the note; true if a SIGHUP came since it was last taken.
    pub fn take(&self) -> bool {
        self.0.swap(false, Ordering::AcqRel)
    }
}

impl StopSignal {
    /// Installs the signal handlers, on a separate thread.
    ///
    /// # Errors
    /// When the signal handlers cannot be installed.
    pub fn install() -> Result<Self, Failure> {
        Self::listen(None)
    }

    /// As [`install`](Self::install), and also raised when the reader of standard output, a pipe
    /// or socket, has gone: for a command that prints until it is stopped.
    ///
    /// # Errors
    /// When the signal handlers cannot be installed, or standard output cannot be watched.
    pub fn install_for_reader() -> Result<Self, Failure> {
        let stop = Self::listen(None)?;
        let to_raise = stop.clone();
        watch_reader(move || to_raise.raise(false)).map_err(|error| {
            let sentence = format!("could not watch the reader of standard output: {error}");
            Failure::general(sentence)
        })?;
        Ok(stop)
    }

    /// As [`install`](Self::install), but SIGHUP is noted instead of stopping.
    ///
    /// # Errors
    /// When the signal handlers cannot be installed.
    pub fn install_beside_hang_ups() -> Result<(Self, HangUps), Failure> {
        let hang_ups = HangUps::default();
        Ok((Self::listen(Some(hang_ups.clone()))?, hang_ups))
    }

    fn listen(hang_ups: Option<HangUps>) -> Result<Self, Failure> {
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
                loop {
                    tokio::select! {
                        _ = interrupt.recv() => to_raise.raise(false),
                        _ = terminate.recv() => to_raise.raise(true),
                        _ = hang_up.recv() => match &hang_ups {
                            None => to_raise.raise(true),
                            Some(noted) => noted.0.store(true, Ordering::Release),
                        }
                    }
                }
            });
        });
        Ok(raised)
    }

    /// `true` after the stop signal was raised.
    pub fn is_raised(&self) -> bool {
        self.n_raised() > 0
    }

    /// Number of times that the stop signal was raised.
    pub fn n_raised(&self) -> u32 {
        self.0.0.lock().n_raised
    }

    /// `true` after a signal that no person has given with a key: SIGTERM or SIGHUP, after which a
    /// program is killed that does not end soon.
    pub fn is_terminated(&self) -> bool {
        self.0.0.lock().is_terminated
    }

    /// Sleeps for `time`, less when the signal is raised.
    pub fn sleep(&self, time: Duration) {
        let (raised, condition) = &*self.0;
        let mut guard = raised.lock();
        let _ = condition.wait_while_for(&mut guard, |raised| raised.n_raised == 0, time);
    }

    fn raise(&self, is_terminated: bool) {
        let mut raised = self.0.0.lock();
        raised.n_raised += 1;
        raised.is_terminated |= is_terminated;
        drop(raised);
        self.0.1.notify_all();
    }
}
