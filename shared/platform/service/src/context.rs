//! Process context: everything a process gets from its runtime.

use crate::{HealthCounters, Home, Shutdown};
use channel::Domain;
use message::ProcessKind;
use std::sync::Arc;

/// Context of a running daemon process.
#[derive(Debug, Clone)]
pub struct Context {
    /// Kind of the running process.
    pub process: ProcessKind,
    /// Membership of the process in its domain.
    pub domain: Domain,
    /// Folder of persistent data.
    pub home: Home,
    /// Shutdown request to the process.
    pub shutdown: Shutdown,
    /// Health counters of the process.
    pub health: Arc<HealthCounters>,
}
