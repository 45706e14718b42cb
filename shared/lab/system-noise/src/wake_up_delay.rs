//! Wake-up delay: how much later than asked a sleeping thread runs.

use serde::{Deserialize, Serialize};
use statistics::percentiles::nearest_rank;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Time for which the thread sleeps each time.
const SLEEP: Duration = Duration::from_millis(1);

/// Delays of a thread of ordinary priority that sleeps a millisecond at a time.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct WakeUpDelay {
    /// Median of the delay, milliseconds.
    pub p50_ms: f64,
    /// 99th percentile of the delay, milliseconds.
    pub p99_ms: f64,
    /// Longest delay, milliseconds.
    pub max_ms: f64,
}

/// Monitor that measures the wake-up delay until its end; [`WakeUpDelay`] is its result.
#[derive(Debug)]
pub struct WakeUpDelayMonitor {
    is_over: Arc<AtomicBool>,
    thread: Option<JoinHandle<Vec<u64>>>,
}

impl WakeUpDelayMonitor {
    /// Begins to measure on a thread of its own.
    pub fn begin() -> Self {
        let is_over = Arc::new(AtomicBool::new(false));
        let over = Arc::clone(&is_over);
        let watched = std::thread::Builder::new()
            .name("noise".into())
            .spawn(move || watch(&over));
        Self {
            is_over,
            thread: watched.ok(),
        }
    }

    /// Delays until now; all 0 when no thread could be started.
    pub fn end(mut self) -> WakeUpDelay {
        let mut delays_ns = self.stop();
        delays_ns.sort_unstable();
        let at_ms = |share| nearest_rank(&delays_ns, share).unwrap_or(0) as f64 * 1e-6;
        WakeUpDelay {
            p50_ms: at_ms(0.5),
            p99_ms: at_ms(0.99),
            max_ms: at_ms(1.0),
        }
    }

    fn stop(&mut self) -> Vec<u64> {
        self.is_over.store(true, Ordering::Relaxed);
        let ended = self.thread.take().map(JoinHandle::join);
        ended.and_then(Result::ok).unwrap_or_default()
    }
}

impl Drop for WakeUpDelayMonitor {
    fn drop(&mut self) {
        self.stop();
    }
}

/// Delays of all sleeps, nanoseconds.
fn watch(is_over: &AtomicBool) -> Vec<u64> {
    let mut delays_ns = Vec::new();
    while !is_over.load(Ordering::Relaxed) {
        let begun = Instant::now();
        std::thread::sleep(SLEEP);
        let delay = begun.elapsed().saturating_sub(SLEEP);
        delays_ns.push(u64::try_from(delay.as_nanos()).unwrap_or(u64::MAX));
    }
    delays_ns
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn delays_are_ordered_and_the_thread_ends() {
        let monitor = WakeUpDelayMonitor::begin();
        std::thread::sleep(Duration::from_millis(50));
        let delay = monitor.end();
        assert!(delay.max_ms > 0.0);
        assert!(delay.p50_ms <= delay.p99_ms && delay.p99_ms <= delay.max_ms);
    }
}
