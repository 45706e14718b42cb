//! Camera watch: perception is degraded while frames stay away.

use crate::arrival_intervals::ArrivalIntervals;
use crate::log_once::LogOnce;
use message::ProcessState;
use service::HealthCounters;
use std::sync::Arc;
use std::time::Duration;

/// Period of [`CameraWatch::look`]. Chosen: a fraction of the shortest limit.
pub(crate) const LOOK_PERIOD: Duration = Duration::from_millis(250);

/// Watch of the arrival of frames.
pub(crate) struct CameraWatch {
    intervals: ArrivalIntervals,
    /// Time of the first look, monotonic clock, nanoseconds.
    began_ns: Option<u64>,
    is_lockstep: bool,
    is_degraded: bool,
    silence_log: LogOnce,
    health: Arc<HealthCounters>,
}

impl CameraWatch {
    pub(crate) fn new(health: Arc<HealthCounters>) -> Self {
        Self {
            intervals: ArrivalIntervals::default(),
            began_ns: None,
            is_lockstep: false,
            is_degraded: false,
            silence_log: LogOnce::default(),
            health,
        }
    }

    /// Notes a frame, received at a time of the monotonic clock; ends a silence.
    pub(crate) fn frame_received(&mut self, received_ns: u64, is_lockstep: bool) {
        let silence_ns = self.intervals.silence_ns(received_ns).unwrap_or(0);
        self.intervals.record(received_ns);
        self.is_lockstep = is_lockstep;
        if std::mem::take(&mut self.is_degraded) {
            self.health.set_state(ProcessState::Ready, "");
        }
        if self.silence_log.reset() {
            let silence_s = silence_ns as f64 * 1e-9;
            tracing::info!("frames come again, after {silence_s:.1} s without any");
        }
    }

    /// Age above which a scene is stale, nanoseconds.
    pub(crate) fn stale_after_ns(&self) -> u64 {
        self.intervals.stale_after_ns()
    }

    /// Degrades the health when no frame has come for too long. A source in lockstep may take
    /// any time.
    pub(crate) fn look(&mut self, now_ns: u64) {
        let began_ns = *self.began_ns.get_or_insert(now_ns);
        let since_last_ns = self.intervals.silence_ns(now_ns);
        let silence_ns = since_last_ns.unwrap_or(now_ns.saturating_sub(began_ns));
        if self.is_lockstep || silence_ns <= self.stale_after_ns() {
            return;
        }
        self.is_degraded = true;
        if since_last_ns.is_none() {
            // The camera may be starting, which is nothing for the log.
            self.health
                .set_state(ProcessState::Degraded, "no frame has come yet");
            return;
        }
        let sentence = format!("no frame for {} s", silence_ns / 1_000_000_000);
        if self.silence_log.is_first() {
            tracing::warn!(
                "{sentence}: the scene is stale until one comes; see the camera in `tabula status`"
            );
        }
        self.health.set_state(ProcessState::Degraded, &sentence);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: u64 = 1_000_000;

    fn note(health: &HealthCounters) -> (ProcessState, String) {
        let (state, note) = health.state();
        (state, note.as_str().unwrap().to_owned())
    }

    #[test]
    fn silence_degrades_health_until_a_frame_comes() {
        let health = Arc::new(HealthCounters::default());
        health.set_state(ProcessState::Ready, "");
        let mut watch = CameraWatch::new(health.clone());
        for frame in 0..10 {
            watch.frame_received((200_000 + 33 * frame) * MS, false);
        }
        let last_ns = (200_000 + 33 * 9) * MS;
        watch.look(last_ns + 999 * MS);
        assert_eq!(note(&health).0, ProcessState::Ready);
        for (silence_ms, seconds) in [(1_001, 1), (7_500, 7)] {
            watch.look(last_ns + silence_ms * MS);
            let expected = format!("no frame for {seconds} s");
            assert_eq!(note(&health), (ProcessState::Degraded, expected));
        }
        watch.frame_received(last_ns + 8_000 * MS, false);
        assert_eq!(note(&health), (ProcessState::Ready, String::new()));
    }

    #[test]
    fn camera_without_any_frame_degrades_health_until_the_first_one() {
        let health = Arc::new(HealthCounters::default());
        health.set_state(ProcessState::Ready, "");
        let mut watch = CameraWatch::new(health.clone());
        watch.look(5_000 * MS);
        watch.look(6_000 * MS);
        assert_eq!(note(&health).0, ProcessState::Ready);
        watch.look(6_250 * MS);
        let expected = (ProcessState::Degraded, "no frame has come yet".to_owned());
        assert_eq!(note(&health), expected);
        watch.frame_received(7_000 * MS, false);
        assert_eq!(note(&health), (ProcessState::Ready, String::new()));
    }

    #[test]
    fn pause_in_lockstep_is_no_silence() {
        let health = Arc::new(HealthCounters::default());
        let mut watch = CameraWatch::new(health.clone());
        watch.frame_received(0, true);
        watch.look(3_600_000 * MS);
        assert_eq!(note(&health).0, ProcessState::Starting);
    }
}
