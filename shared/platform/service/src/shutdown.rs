//! Shutdown request of a process, raised by SIGTERM or SIGINT.

use crate::service_manager::ServiceManager;
use tokio::signal::unix::{SignalKind, signal};
use tokio::sync::watch;

/// Shutdown request, visible to all holders of a clone.
#[derive(Debug, Clone)]
pub struct Shutdown(watch::Receiver<bool>);

/// Sender of the shutdown request.
#[derive(Debug, Clone)]
pub struct ShutdownTrigger(watch::Sender<bool>);

impl Shutdown {
    /// Creates a shutdown request and its sender.
    pub fn new() -> (ShutdownTrigger, Self) {
        let (sender, receiver) = watch::channel(false);
        (ShutdownTrigger(sender), Self(receiver))
    }

    /// Waits for the shutdown request.
    pub async fn requested(&self) {
        // An error means that the sender is gone: the process is ending.
        let _ = self.0.clone().wait_for(|requested| *requested).await;
    }

    /// `true` after shutdown was requested.
    pub fn is_requested(&self) -> bool {
        *self.0.borrow()
    }
}

impl ShutdownTrigger {
    /// `true` after shutdown was requested.
    pub(crate) fn is_requested(&self) -> bool {
        *self.0.borrow()
    }

    /// Requests shutdown.
    pub fn request(&self) {
        let _ = self.0.send(true);
    }
}

/// Requests shutdown at the first SIGTERM or SIGINT.
pub(crate) fn on_signals(trigger: ShutdownTrigger) -> std::io::Result<()> {
    let mut terminate = signal(SignalKind::terminate())?;
    let mut interrupt = signal(SignalKind::interrupt())?;
    tokio::spawn(async move {
        let name = tokio::select! {
            _ = terminate.recv() => "SIGTERM",
            _ = interrupt.recv() => "SIGINT",
        };
        tracing::info!("stopping: received {name}");
        ServiceManager::stopping();
        trigger.request();
    });
    Ok(())
}
