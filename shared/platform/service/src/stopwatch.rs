//! Stopwatch for consecutive stages of a thread's work: time, processor time,
//! allocations, faults.

use crate::clock::monotonic_ns;
use crate::thread_usage::{ThreadUsage, thread_id};
use message::{Span, Stage};

/// Stopwatch of consecutive stages on one thread, without gaps: each begins at the
/// end of the previous one.
///
/// It must not be carried over an `await`, after which the thread may be another one.
#[derive(Debug, Clone, Copy)]
pub struct Stopwatch {
    begin_ns: u64,
    usage: ThreadUsage,
}

impl Stopwatch {
    /// Starts timing the first stage now.
    pub fn start() -> Self {
        Self::since(monotonic_ns())
    }

    /// Starts with a first stage that began at `begin_ns`, a moment ago, on this
    /// thread.
    pub fn since(begin_ns: u64) -> Self {
        Self {
            begin_ns,
            usage: ThreadUsage::now(),
        }
    }

    /// Begin of the current stage, monotonic, nanoseconds.
    pub fn begin_ns(&self) -> u64 {
        self.begin_ns
    }

    /// Ends the current stage and begins the next; `track_id` is 0 for a stage of the
    /// whole frame.
    pub fn lap(&mut self, stage: Stage, track_id: u64) -> Span {
        let begun = *self;
        self.usage = ThreadUsage::now();
        self.begin_ns = monotonic_ns();
        self.span_since(&begun, stage, track_id)
    }

    /// Span from the begin of `earlier` to the last lap: the sum of several laps.
    pub fn span_since(&self, earlier: &Self, stage: Stage, track_id: u64) -> Span {
        let (now, then) = (&self.usage, &earlier.usage);
        let more = |now: u64, then: u64| now.saturating_sub(then) as u32;
        Span {
            begin_ns: earlier.begin_ns,
            end_ns: self.begin_ns,
            track_id,
            cpu_ns: now.cpu_ns.saturating_sub(then.cpu_ns),
            allocated_bytes: now.allocated_bytes.saturating_sub(then.allocated_bytes),
            stage: stage.code(),
            thread_id: thread_id(),
            n_allocations: more(now.n_allocations, then.n_allocations),
            n_voluntary_switches: more(now.n_voluntary_switches, then.n_voluntary_switches),
            n_involuntary_switches: more(now.n_involuntary_switches, then.n_involuntary_switches),
            n_minor_faults: more(now.n_minor_faults, then.n_minor_faults),
            n_major_faults: more(now.n_major_faults, then.n_major_faults),
            reserved: 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn laps_follow_each_other_without_gaps_and_add_up() {
        let mut watch = Stopwatch::start();
        let begin = watch;
        let work = |n: u64| (0..n).fold(0_u64, |sum, i| std::hint::black_box(sum ^ i));
        work(100_000);
        let first = watch.lap(Stage::Samples, 0);
        work(100_000);
        let second = watch.lap(Stage::TablePlane, 7);
        let whole = watch.span_since(&begin, Stage::Detection, 0);
        assert_eq!(first.end_ns, second.begin_ns);
        assert_eq!(
            first.duration_ns() + second.duration_ns(),
            whole.duration_ns()
        );
        assert_eq!(first.cpu_ns + second.cpu_ns, whole.cpu_ns);
        assert!(first.cpu_ns > 0 && whole.thread_id != 0);
        assert_eq!((first.track_id, second.track_id), (0, 7));
    }

    #[test]
    fn sleeping_thread_uses_no_processor_time() {
        let mut watch = Stopwatch::start();
        std::thread::sleep(std::time::Duration::from_millis(30));
        let slept = watch.lap(Stage::ReleaseWait, 0);
        assert!(slept.duration_ns() >= 30_000_000);
        assert!(slept.cpu_ns < slept.duration_ns());
        assert!(slept.n_voluntary_switches >= 1);
    }
}
