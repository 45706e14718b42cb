//! Resource usage of the daemon's processes, from `/proc`.

use crate::trace_reader::TraceReader;
use latency_report::ProcessReport;
use message::ProcessKind;
use std::time::Instant;
use system_noise::ProcessCounters;

/// Process with its counters at the beginning of a measurement.
#[derive(Debug)]
pub(crate) struct ProcessUsage {
    process: ProcessKind,
    pid: u32,
    begun: Instant,
    before: ProcessCounters,
}

impl ProcessUsage {
    /// Starts measuring the processes that have sent traces.
    pub(crate) fn begin_all(trace_reader: &TraceReader) -> Vec<Self> {
        let processes = trace_reader.processes().into_iter();
        processes
            .filter_map(|(process, pid)| Self::begin(process, pid))
            .collect()
    }

    /// Starts measuring a process; `None` if it does not exist.
    fn begin(process: ProcessKind, pid: u32) -> Option<Self> {
        Some(Self {
            process,
            pid,
            begun: Instant::now(),
            before: ProcessCounters::read(pid)?,
        })
    }

    /// Usage since the start; `None` if the process has ended.
    pub(crate) fn report(&self) -> Option<ProcessReport> {
        let work = ProcessCounters::read(self.pid)?.since(&self.before);
        let seconds = self.begun.elapsed().as_secs_f64().max(1e-9);
        let per_second = rustix::param::clock_ticks_per_second() as f64;
        let page_bytes = rustix::param::page_size() as f64;
        Some(ProcessReport {
            process: self.process.word().to_owned(),
            pid: self.pid,
            cores: work.cpu_ticks as f64 / per_second / seconds,
            resident_mb: work.resident_pages as f64 * page_bytes / 1e6,
            open_files: n_open_files(self.pid),
            threads: work.n_threads,
            major_faults: work.major_faults,
            minor_faults: work.minor_faults,
            voluntary_switches: work.voluntary_switches,
            involuntary_switches: work.involuntary_switches,
        })
    }
}

fn n_open_files(pid: u32) -> u64 {
    let folder = std::fs::read_dir(format!("/proc/{pid}/fd"));
    folder.map_or(0, |entries| entries.count() as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn this_process_is_measured() {
        let usage = ProcessUsage::begin(ProcessKind::CAMERA, std::process::id()).unwrap();
        let report = usage.report().unwrap();
        assert!(report.open_files > 0 && report.threads > 0 && report.resident_mb > 0.1);
        assert!(ProcessUsage::begin(ProcessKind::CAMERA, u32::MAX).is_none());
    }
}
