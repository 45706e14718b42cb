//! Being asked to stop.

use tokio::signal::unix::{SignalKind, signal};
use tokio::sync::watch;

/// A request to stop, seen by everybody who holds a clone.
#[derive(Debug, Clone)]
pub struct Shutdown(watch::Receiver<bool>);

/// Makes the request.
#[derive(Debug, Clone)]
pub(crate) struct Trigger(watch::Sender<bool>);

impl Shutdown {
    /// A request not yet made, and who makes it.
    pub(crate) fn new() -> (Trigger, Self) {
        let (sender, receiver) = watch::channel(false);
        (Trigger(sender), Self(receiver))
    }

    /// Returns when the request has been made.
    pub async fn requested(&self) {
        // An error means that whoever could ask is gone: the process is ending.
        let _ = self.0.clone().wait_for(|asked| *asked).await;
    }

    /// Whether the request has been made.
    pub fn is_requested(&self) -> bool {
        *self.0.borrow()
    }
}

impl Trigger {
    pub(crate) fn ask(&self) {
        let _ = self.0.send(true);
    }
}

/// Asks for shutdown at the first SIGTERM or SIGINT.
pub(crate) fn on_signals(trigger: Trigger) -> std::io::Result<()> {
    let mut terminate = signal(SignalKind::terminate())?;
    let mut interrupt = signal(SignalKind::interrupt())?;
    tokio::spawn(async move {
        let name = tokio::select! {
            _ = terminate.recv() => "SIGTERM",
            _ = interrupt.recv() => "SIGINT",
        };
        tracing::info!("stopping: received {name}");
        trigger.ask();
    });
    Ok(())
}
