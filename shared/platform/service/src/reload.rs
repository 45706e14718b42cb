//! Reload of the configuration by a running process, at SIGHUP.
//!
//! A reload is atomic: the whole configuration is read and checked first, and then either all
//! changes of live keys are applied together, or none. Keys that need a restart keep the values
//! that the process was started with, and are named.

mod live_config;
mod reload_plan;
mod reload_record;
mod reload_request;
mod reloader;

pub use live_config::LiveConfig;
pub use reload_plan::ReloadPlan;
pub use reload_record::{ReloadRecordPublisher, last_reloads};
pub use reload_request::reload_processes;
pub(crate) use reloader::{ConfigPlace, Reloader};

use control_protocol::ReloadReport;

/// Logs the outcome of a reload.
pub fn log_reload(report: &ReloadReport) {
    let process = &report.process;
    if let Some(sentence) = &report.refused {
        tracing::error!(
            "the configuration is not reloaded by {process}, and nothing has changed: {sentence}"
        );
        return;
    }
    for change in &report.applied {
        tracing::info!("configuration applied by {process}: {change}");
    }
    for change in &report.needs_restart {
        tracing::warn!("configuration needs restart of {process}: {change}");
    }
    if report.applied.is_empty() {
        tracing::info!("configuration read again by {process}; nothing is to be applied");
    }
}
