//! Resource usage of the daemon's processes, from `/proc`.

use latency_report::ProcessReport;
use message::ProcessKind;
use std::path::Path;
use std::time::Instant;

/// Resource counters of a process since its start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct ProcessCounters {
    cpu_ticks: u64,
    minor_faults: u64,
    major_faults: u64,
    voluntary_switches: u64,
    involuntary_switches: u64,
    n_threads: u64,
    resident_pages: u64,
}

/// Process with its counters at the beginning of a measurement.
#[derive(Debug)]
pub(crate) struct ProcessUsage {
    process: ProcessKind,
    pid: u32,
    begun: Instant,
    before: ProcessCounters,
}

impl ProcessUsage {
    /// Starts measuring a process; `None` if it does not exist.
    pub(crate) fn begin(process: ProcessKind, pid: u32) -> Option<Self> {
        Some(Self {
            process,
            pid,
            begun: Instant::now(),
            before: counters(pid)?,
        })
    }

    /// Usage since the start; `None` if the process has ended.
    pub(crate) fn report(&self) -> Option<ProcessReport> {
        let now = counters(self.pid)?;
        let seconds = self.begun.elapsed().as_secs_f64().max(1e-9);
        let since =
            |count: fn(&ProcessCounters) -> u64| count(&now).saturating_sub(count(&self.before));
        let per_second = rustix::param::clock_ticks_per_second() as f64;
        let page_bytes = rustix::param::page_size() as f64;
        Some(ProcessReport {
            process: self.process.word().to_owned(),
            pid: self.pid,
            cores: since(|c| c.cpu_ticks) as f64 / per_second / seconds,
            resident_mb: now.resident_pages as f64 * page_bytes / 1e6,
            open_files: n_open_files(self.pid),
            threads: now.n_threads,
            major_faults: since(|c| c.major_faults),
            minor_faults: since(|c| c.minor_faults),
            voluntary_switches: since(|c| c.voluntary_switches),
            involuntary_switches: since(|c| c.involuntary_switches),
        })
    }
}

fn counters(pid: u32) -> Option<ProcessCounters> {
    let folder = Path::new("/proc").join(pid.to_string());
    let stat = std::fs::read_to_string(folder.join("stat")).ok()?;
    let mut counters = parse_stat(&stat)?;
    // The process's own file covers its first thread only.
    for thread in std::fs::read_dir(folder.join("task")).ok()?.flatten() {
        let status = std::fs::read_to_string(thread.path().join("status")).unwrap_or_default();
        let (voluntary, involuntary) = parse_switches(&status);
        counters.voluntary_switches += voluntary;
        counters.involuntary_switches += involuntary;
    }
    Some(counters)
}

fn n_open_files(pid: u32) -> u64 {
    let folder = std::fs::read_dir(format!("/proc/{pid}/fd"));
    folder.map_or(0, |entries| entries.count() as u64)
}

/// Parses `/proc/PID/stat` (proc(5)). The name in parentheses may contain anything.
fn parse_stat(line: &str) -> Option<ProcessCounters> {
    let (_, behind_name) = line.rsplit_once(')')?;
    let words: Vec<&str> = behind_name.split_ascii_whitespace().collect();
    // The first word after the name is field 3.
    let field = |number: usize| words.get(number - 3)?.parse::<u64>().ok();
    Some(ProcessCounters {
        minor_faults: field(10)?,
        major_faults: field(12)?,
        cpu_ticks: field(14)? + field(15)?,
        n_threads: field(20)?,
        resident_pages: field(24)?,
        ..ProcessCounters::default()
    })
}

fn parse_switches(status: &str) -> (u64, u64) {
    let of = |name: &str| {
        let line = status.lines().find_map(|line| line.strip_prefix(name))?;
        line.trim().parse().ok()
    };
    (
        of("voluntary_ctxt_switches:").unwrap_or(0),
        of("nonvoluntary_ctxt_switches:").unwrap_or(0),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stat_line_is_parsed_with_any_process_name() {
        let line = "77 (a) b (c)) S 1 77 77 0 -1 4194304 1000 0 20 0 300 50 0 0 20 0 9 0 12345 \
                    99999999 2560 18446744073709551615";
        let counters = parse_stat(line).unwrap();
        assert_eq!((counters.minor_faults, counters.major_faults), (1000, 20));
        assert_eq!((counters.cpu_ticks, counters.n_threads), (350, 9));
        assert_eq!(counters.resident_pages, 2560);
        assert_eq!(parse_stat("rubbish"), None);
        assert_eq!(parse_stat("1 (x) S 1"), None);
    }

    #[test]
    fn context_switches_are_parsed() {
        let status = "Name:\tx\nvoluntary_ctxt_switches:\t12\nnonvoluntary_ctxt_switches:\t3\n";
        assert_eq!(parse_switches(status), (12, 3));
        assert_eq!(parse_switches(""), (0, 0));
    }

    #[test]
    fn this_process_is_measured() {
        let usage = ProcessUsage::begin(ProcessKind::CAMERA, std::process::id()).unwrap();
        let report = usage.report().unwrap();
        assert!(report.open_files > 0 && report.threads > 0 && report.resident_mb > 0.1);
        assert!(ProcessUsage::begin(ProcessKind::CAMERA, u32::MAX).is_none());
    }
}
