//! What a process is given.

use crate::{ConfigFile, HealthBoard, Home, Shutdown};
use channel::Domain;
use std::sync::Arc;

/// Everything a process needs from its surroundings.
#[derive(Debug, Clone)]
pub struct Context {
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
