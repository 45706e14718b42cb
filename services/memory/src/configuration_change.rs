//! Change of the configuration of the running memory.

use crate::config::Config;
use crate::working_memory::WorkingMemory;
use memory_requests::MemoryRequestHandler;
use perceptual_memory::StoreHandle;
use service::LiveConfig;
use std::sync::Arc;

/// Parts of the memory that take a new configuration. The scene follower and the daily purge take
/// theirs themselves.
pub(crate) struct ConfigurationChange {
    pub(crate) store: StoreHandle,
    pub(crate) handler: Arc<MemoryRequestHandler>,
    pub(crate) world: Arc<WorkingMemory>,
}

impl ConfigurationChange {
    /// Passes each new configuration on, until the future is dropped.
    pub(crate) async fn follow(self, mut live: LiveConfig<Config>) {
        loop {
            let config = live.change().await;
            self.store.set_limits(config.limits);
            self.handler.set_upload_limits(config.uploads);
            self.world.set_config(&config);
        }
    }
}
