//! Notification of systemd about a reload (`sd_notify`, `Type=notify-reload`).

use sd_notify::NotifyState;

/// Reload that systemd knows of: `RELOADING=1` with the time when it begins, `READY=1` on drop.
#[derive(Debug)]
pub struct ReloadNotice(());

impl ReloadNotice {
    /// Begins a reload. Without a service manager nothing is sent.
    pub fn begin() -> Self {
        if let Ok(now) = NotifyState::monotonic_usec_now() {
            let _ = sd_notify::notify(&[NotifyState::Reloading, now]);
        }
        Self(())
    }
}

impl Drop for ReloadNotice {
    fn drop(&mut self) {
        let _ = sd_notify::notify(&[NotifyState::Ready]);
    }
}
