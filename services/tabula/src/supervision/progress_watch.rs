//! Progress watch of one process (software watchdog): the time since its progress counter
//! last changed. Pure functions of passed-in instants.
//!
//! The counter counts, not the reports that carry it: a starved process whose counter
//! changes now and then is well, and one that goes on reporting an unchanged counter hangs.

use std::time::Duration;

/// Instant as time since boot, time of suspend included.
pub(crate) type BootTime = Duration;

/// Gap between two polls after which the watching process itself has been stopped, starved
/// or suspended, in all likelihood with the watched one. Chosen: a hundred times the polling
/// period.
const WATCHER_GAP: Duration = Duration::from_secs(2);

/// Limits of the time without progress.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ProgressLimits {
    /// Limit of a process that is starting: opening a large store takes minutes.
    pub(crate) starting: Duration,
    /// Limit of a process that has become ready.
    pub(crate) ready: Duration,
}

/// Content of a health report that concerns the watch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ProgressReport {
    /// Progress counter of the process.
    pub(crate) counter: u64,
    /// `true` until the process is ready.
    pub(crate) is_starting: bool,
}

/// Watch of one process, from its start to its end.
#[derive(Debug, Clone)]
pub(crate) struct ProgressWatch {
    limits: ProgressLimits,
    /// Last report; `None` until the first one.
    last: Option<ProgressReport>,
    /// Beginning of the running period without progress.
    period_began: BootTime,
    /// Last change of the counter.
    progressed: BootTime,
    polled: BootTime,
}

impl ProgressWatch {
    /// Begins to watch a process that starts now.
    pub(crate) fn new(limits: ProgressLimits, now: BootTime) -> Self {
        Self {
            limits,
            last: None,
            period_began: now,
            progressed: now,
            polled: now,
        }
    }

    /// Replaces the limits.
    pub(crate) fn set_limits(&mut self, limits: ProgressLimits) {
        self.limits = limits;
    }

    /// Takes the newest report of the process. A counter that is smaller than before is
    /// progress as well: the process has replaced its program.
    pub(crate) fn observe(&mut self, report: ProgressReport, now: BootTime) {
        if self.last != Some(report) {
            self.period_began = now;
            self.progressed = now;
        }
        self.last = Some(report);
    }

    /// Gives the process a new period, because it could not be observed.
    pub(crate) fn excuse(&mut self, now: BootTime) {
        self.period_began = now;
        self.polled = now;
    }

    /// Time without progress when it exceeds the limit; to be called in each round of
    /// polling. A gap between two calls begins a new period.
    pub(crate) fn poll(&mut self, now: BootTime) -> Option<Duration> {
        if now.saturating_sub(self.polled) > WATCHER_GAP {
            self.excuse(now);
        }
        self.polled = now;
        let silence = self.silence(now);
        (silence > self.limit()).then_some(silence)
    }

    /// Time since the beginning of the period without progress.
    pub(crate) fn silence(&self, now: BootTime) -> Duration {
        now.saturating_sub(self.period_began)
    }

    /// Instant of the last progress; that of the start before any.
    pub(crate) fn progressed(&self) -> BootTime {
        self.progressed
    }

    /// `true` until the process has reported that it is ready.
    pub(crate) fn is_starting(&self) -> bool {
        self.last.is_none_or(|report| report.is_starting)
    }

    fn limit(&self) -> Duration {
        if self.is_starting() {
            self.limits.starting
        } else {
            self.limits.ready
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: ProgressLimits = ProgressLimits {
        starting: Duration::from_secs(60),
        ready: Duration::from_secs(10),
    };
    const POLL: Duration = Duration::from_millis(20);

    fn seconds(s: f64) -> BootTime {
        BootTime::from_secs_f64(s)
    }

    fn report(counter: u64) -> ProgressReport {
        ProgressReport {
            counter,
            is_starting: false,
        }
    }

    /// Polls without any report until the verdict, or until `end`.
    fn silent_until(watch: &mut ProgressWatch, from: BootTime, end: BootTime) -> Option<BootTime> {
        let mut now = from;
        while now < end {
            if watch.poll(now).is_some() {
                return Some(now);
            }
            now += POLL;
        }
        None
    }

    fn ready_watch() -> ProgressWatch {
        let mut watch = ProgressWatch::new(LIMITS, seconds(0.0));
        watch.observe(report(1), seconds(0.0));
        watch
    }

    #[test]
    fn silent_process_is_found_after_the_limit_and_not_before() {
        let found = silent_until(&mut ready_watch(), seconds(0.0), seconds(100.0)).unwrap();
        assert!(
            found > seconds(10.0) && found <= seconds(10.0) + POLL,
            "{found:?}"
        );
    }

    #[test]
    fn starting_process_has_the_longer_limit_even_without_any_report() {
        let mut watch = ProgressWatch::new(LIMITS, seconds(0.0));
        let found = silent_until(&mut watch, seconds(0.0), seconds(100.0)).unwrap();
        assert!(
            found > seconds(60.0) && found <= seconds(60.0) + POLL,
            "{found:?}"
        );

        let mut watch = ProgressWatch::new(LIMITS, seconds(0.0));
        let starting = ProgressReport {
            counter: 0,
            is_starting: true,
        };
        watch.observe(starting, seconds(0.5));
        assert_eq!(silent_until(&mut watch, seconds(0.5), seconds(60.0)), None);
        // Readiness alone is progress, and the shorter limit begins with it.
        watch.observe(report(0), seconds(60.0));
        let found = silent_until(&mut watch, seconds(60.0), seconds(200.0)).unwrap();
        assert!(
            found > seconds(70.0) && found <= seconds(70.0) + POLL,
            "{found:?}"
        );
    }

    #[test]
    fn reports_with_an_unchanged_counter_are_no_progress() {
        let mut watch = ready_watch();
        let mut now = seconds(0.0);
        let mut found = None;
        while found.is_none() && now < seconds(100.0) {
            watch.observe(report(1), now);
            found = watch.poll(now);
            now += POLL;
        }
        assert!(now <= seconds(10.1), "{now:?}");
    }

    #[test]
    fn starved_process_with_some_progress_is_never_found() {
        let mut watch = ready_watch();
        for step in 1..100_u32 {
            // A step every 9.9 s, and a report of it only just in time.
            let before = seconds(9.9 * f64::from(step - 1));
            let now = seconds(9.9 * f64::from(step));
            assert_eq!(silent_until(&mut watch, before, now), None);
            watch.observe(report(1 + u64::from(step)), now);
        }
    }

    #[test]
    fn counter_that_begins_again_is_progress() {
        let mut watch = ready_watch();
        watch.observe(report(500), seconds(1.0));
        watch.observe(report(0), seconds(9.0));
        assert_eq!(watch.silence(seconds(9.5)), seconds(0.5));
        assert_eq!(watch.progressed(), seconds(9.0));
    }

    #[test]
    fn suspend_of_the_machine_gives_a_new_period() {
        let mut watch = ready_watch();
        assert_eq!(silent_until(&mut watch, seconds(0.0), seconds(9.0)), None);
        // Eight hours of suspend: nobody polls.
        let resumed = seconds(8.0 * 3600.0);
        assert_eq!(watch.poll(resumed), None);
        let found = silent_until(&mut watch, resumed, resumed + seconds(100.0)).unwrap();
        assert!(found > resumed + seconds(10.0), "{found:?}");
        // What happened to the watcher is no progress of the process.
        assert_eq!(watch.progressed(), seconds(0.0));
    }

    #[test]
    fn excused_process_gets_a_new_period() {
        let mut watch = ready_watch();
        let end = seconds(9.0);
        assert_eq!(silent_until(&mut watch, seconds(0.0), end), None);
        watch.excuse(end);
        let found = silent_until(&mut watch, end, seconds(100.0)).unwrap();
        assert!(found > end + seconds(10.0), "{found:?}");
    }
}
