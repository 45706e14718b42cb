//! What a process is given.

use crate::{ConfigFile, HealthBoard, Home, Shutdown};
use channel::Domain;
use message::ProcessKind;
use std::sync::Arc;

/// Everything a process needs from its surroundings.
#[derive(Debug, Clone)]
pub struct Context {
    /// Which process it is.
    pub process: ProcessKind,
    /// Membership in the domain.
    pub domain: Domain,
    /// Folder of lasting data.
    pub home: Home,
    /// The configuration file.
    pub config: ConfigFile,
    /// The request to stop.
    pub shutdown: Shutdown,
    /// Where the process writes how it is.
    pub health: Arc<HealthBoard>,
}
