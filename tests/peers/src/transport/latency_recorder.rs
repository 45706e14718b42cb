//! Latency recorder of the receiver: time, page touching and loss of each message.

use crate::benchmark_case::BenchmarkCase;
use crate::child_report::ChildReport;
use crate::{clock, payload};

/// Latencies and losses of the messages after the warm-up.
#[derive(Debug)]
pub struct LatencyRecorder {
    case: BenchmarkCase,
    latency_ns: Vec<u64>,
    touch_ns: Vec<u64>,
    /// Expected number of the next message.
    next: u64,
    n_lost: u64,
    /// Processor time of the process at the end of the warm-up, nanoseconds.
    cpu_begin_ns: u64,
    /// Processor time of the process at the last message, nanoseconds.
    cpu_end_ns: u64,
}

impl LatencyRecorder {
    /// Empty recorder of a case.
    pub fn new(case: BenchmarkCase) -> Self {
        let series = || Vec::with_capacity(case.n_messages as usize);
        Self {
            latency_ns: series(),
            touch_ns: series(),
            next: 0,
            n_lost: 0,
            cpu_begin_ns: clock::process_ns(),
            cpu_end_ns: 0,
            case,
        }
    }

    /// Records a message as soon as it is readable; `true` if it was the last.
    ///
    /// # Panics
    /// If the payload is another message's or has a wrong length.
    pub fn record(&mut self, number: u64, sent_ns: u64, payload: &[u8]) -> bool {
        let received_ns = clock::now_ns();
        payload::touch(number, payload);
        let touched_ns = clock::now_ns();
        assert_eq!(payload.len(), self.case.payload_bytes);
        if number >= self.case.n_warm_up {
            self.latency_ns.push(received_ns - sent_ns);
            self.touch_ns.push(touched_ns - received_ns);
            self.n_lost += number - self.next.max(self.case.n_warm_up);
        } else {
            self.cpu_begin_ns = clock::process_ns();
        }
        self.next = number + 1;
        let is_last = self.next == self.case.n_all();
        if is_last {
            self.cpu_end_ns = clock::process_ns();
        }
        is_last
    }

    /// Report for the parent process.
    pub fn into_report(self) -> ChildReport {
        ChildReport::default()
            .with("cpu_ns", [self.cpu_end_ns - self.cpu_begin_ns])
            .with("lost", [self.n_lost])
            .with("latency_ns", self.latency_ns)
            .with("touch_ns", self.touch_ns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::benchmark_case::{ReceiveMode, System};

    #[test]
    fn losses_are_counted_after_the_warm_up() {
        let mut case = BenchmarkCase::new(System::Iceoryx2, ReceiveMode::Polled, 64, 1);
        (case.n_warm_up, case.n_messages) = (3, 5);
        let mut recorder = LatencyRecorder::new(case);
        for number in [0, 2, 4, 7] {
            let is_last = recorder.record(number, clock::now_ns(), &[number as u8; 64]);
            assert_eq!(is_last, number == 7);
        }
        let report = recorder.into_report();
        assert_eq!(report.figure("lost"), Ok(3), "3, 5 and 6");
        assert_eq!(report.series("latency_ns").unwrap().len(), 2);
    }
}
