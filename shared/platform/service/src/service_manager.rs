//! Notifications to systemd: readiness, state, watchdog, longer starts, and reloads.

use message::{ProcessState, Text};
use sd_notify::NotifyState;
use std::path::PathBuf;
use std::time::Duration;
use unicode_text::escape_unprintable;

/// Environment variable in which systemd names the socket for notifications.
const NOTIFY_SOCKET: &str = "NOTIFY_SOCKET";
/// Environment variable in which systemd names the folder of `RuntimeDirectory=`.
const RUNTIME_DIRECTORY: &str = "RUNTIME_DIRECTORY";
/// Name of the readiness marker in that folder.
const MARKER: &str = "has-been-ready";
/// Time that a starting process gets anew with each progress. Chosen: longer than two reports,
/// on a loaded machine as well.
const START_EXTENSION: Duration = Duration::from_secs(30);

/// Notifier of the service manager; does nothing in a process that systemd did not start.
pub(crate) struct ServiceManager {
    is_ready: bool,
    last_progress: u64,
    last_state: Option<(ProcessState, Text)>,
}

impl ServiceManager {
    pub(crate) fn new() -> Self {
        Self {
            is_ready: false,
            last_progress: 0,
            last_state: None,
        }
    }

    /// Notifies of what has changed since the last call: the state, readiness, once, and progress,
    /// which feeds the watchdog, or gives a starting process more time.
    pub(crate) fn update(&mut self, state: (ProcessState, Text), progress: u64) {
        let mut news = Vec::new();
        let status = status(&state);
        if self.last_state != Some(state) {
            self.last_state = Some(state);
            news.push(NotifyState::Status(&status));
        }
        if !self.is_ready && state.0 != ProcessState::Starting {
            self.is_ready = true;
            news.push(NotifyState::Ready);
            set_readiness_marker();
        }
        if progress != self.last_progress {
            self.last_progress = progress;
            news.push(if self.is_ready {
                NotifyState::Watchdog
            } else {
                NotifyState::ExtendTimeoutUsec(START_EXTENSION.as_micros() as u32)
            });
        }
        if !news.is_empty() {
            // Without systemd there is no socket, and nobody to tell.
            let _ = sd_notify::notify(&news);
        }
    }

    /// Notifies that the process is stopping.
    pub(crate) fn stopping() {
        let _ = sd_notify::notify(&[NotifyState::Stopping]);
    }
}

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

/// `true` in a process that systemd has started as a service: nobody looks at its start, and what is
/// missing, such as a disk, may come later.
pub fn is_service() -> bool {
    std::env::var_os(NOTIFY_SOCKET).is_some()
}

/// State and note as `systemctl status` shows them.
fn status((state, note): &(ProcessState, Text)) -> String {
    match note.as_str() {
        None | Some("") => state.word().to_owned(),
        Some(note) => format!("{}: {}", state.word(), escape_unprintable(note)),
    }
}

/// `true` when systemd has restarted this service after a failure, and it had been ready before:
/// systemd keeps the folder of the marker over restarts (`RuntimeDirectoryPreserve=restart`).
pub(crate) fn has_been_ready() -> bool {
    readiness_marker().is_some_and(|path| path.exists())
}

fn set_readiness_marker() {
    if let Some(path) = readiness_marker()
        && let Err(error) = std::fs::write(&path, "")
    {
        tracing::warn!(
            "{} could not be written ({error}): a wrong configuration will end this service for \
             good at its next restart",
            path.display()
        );
    }
}

/// Removes the marker when a person stops the service: its next start is a first one.
pub(crate) fn clear_readiness_marker() {
    if let Some(path) = readiness_marker() {
        let _ = std::fs::remove_file(path);
    }
}

fn readiness_marker() -> Option<PathBuf> {
    let folder = std::env::var_os(RUNTIME_DIRECTORY)?;
    Some(PathBuf::from(folder).join(MARKER))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn status_names_the_state_and_its_reason() {
        let text = |state, note| status(&(state, Text::truncated(note)));
        assert_eq!(text(ProcessState::Ready, ""), "ready");
        assert_eq!(
            text(ProcessState::Degraded, "no Kinect is connected"),
            "degraded: no Kinect is connected"
        );
    }
}
