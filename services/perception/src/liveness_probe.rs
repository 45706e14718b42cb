//! Liveness probe: an empty job through the worker pool, recorded as progress when answered.

use actor::WorkerPool;
use service::HealthCounters;
use std::sync::Arc;
use std::time::Duration;
use tokio::time::Instant;

/// Period of the probe while no frame is finished.
pub(crate) const PROBE_PERIOD: Duration = Duration::from_millis(500);

/// Probe of the caller's loop and of the workers.
#[derive(Clone)]
pub(crate) struct LivenessProbe {
    pool: WorkerPool,
    health: Arc<HealthCounters>,
}

impl LivenessProbe {
    pub(crate) fn new(pool: WorkerPool, health: Arc<HealthCounters>) -> Self {
        Self { pool, health }
    }

    /// Probes once.
    pub(crate) async fn probe(&self) {
        if self.pool.run(|_| ()).await.is_ok() {
            self.health.record_progress();
        }
    }

    /// Probes while waiting for another process, which may take any time: the wait is not
    /// a stall of this one.
    pub(crate) async fn while_waiting<T>(&self, wait: impl Future<Output = T>) -> T {
        tokio::pin!(wait);
        let mut period = tokio::time::interval_at(Instant::now() + PROBE_PERIOD, PROBE_PERIOD);
        loop {
            tokio::select! {
                biased;
                output = &mut wait => return output,
                _ = period.tick() => self.probe().await,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use actor::PoolConfig;
    use std::num::NonZeroUsize;

    #[tokio::test]
    async fn wait_for_another_process_records_progress() {
        let one = NonZeroUsize::MIN;
        let pool = WorkerPool::start(PoolConfig {
            name: "probed".into(),
            n_workers: one,
            stall_after: Duration::from_secs(60),
            max_abandoned: one,
        })
        .unwrap();
        let health = Arc::new(HealthCounters::default());
        let probe = LivenessProbe::new(pool, health.clone());
        assert_eq!(probe.while_waiting(async { 7 }).await, 7);
        let before = health.progress();
        let wait = async {
            while health.progress() < before + 2 {
                tokio::time::sleep(Duration::from_millis(10)).await;
            }
        };
        let watched = tokio::time::timeout(Duration::from_secs(60), probe.while_waiting(wait));
        watched.await.expect("the waiting records progress");
    }
}
