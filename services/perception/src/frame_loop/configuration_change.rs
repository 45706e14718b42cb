//! Change of the configuration of a running frame loop, between two frames.

use super::FrameLoop;
use crate::config::Config;
use message::Text;

impl FrameLoop {
    /// Applies a new configuration, if there is one. To be called between two frames.
    pub(super) async fn take_configuration_change(&mut self) {
        if let Some(config) = self.settings.take_change() {
            self.apply(&config).await;
        }
    }

    /// Applies a configuration as a whole: the next frame has all of it, and the one before had
    /// nothing of it.
    pub(super) async fn apply(&mut self, config: &Config) {
        let policy = match config.restart_policy() {
            Ok(policy) => policy,
            Err(error) => {
                tracing::error!("the configuration is not applied: {error}");
                return;
            }
        };
        self.live.detector.set_config(config.detection.clone());
        self.live.actors.set_restart_policy(policy);
        self.live.actor_deadline = config.actor_deadline;
        self.pool.set_stall_after(config.worker_stall);
        self.set_pipeline_config(config.pipeline);
        self.rule = Text::truncated(&config.detection.rule().to_string());
        self.relabel_scene().await;
    }
}
