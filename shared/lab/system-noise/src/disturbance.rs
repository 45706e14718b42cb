//! Disturbances during a measurement: steal time, other load, page faults, frequency changes.

mod kernel_counters;

use crate::fingerprint::{frequencies_khz, n_frequency_changes};
use crate::process_counters::ProcessCounters;
use crate::system_files::SystemFiles;
use kernel_counters::CpuTime;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::time::Instant;

/// Disturbances during a measurement; `None` if this computer does not report a value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Disturbance {
    /// Duration of the disturbance observation, seconds.
    pub duration_s: f64,
    /// Steal time: share of the time of all cores that the hypervisor took, 0 to 1.
    pub steal_share: Option<f64>,
    /// CPU load of other processes and of interrupts, in cores: 1 is one busy core.
    pub other_load_cores: Option<f64>,
    /// CPU pressure (PSI, 10 s average): share of time in which some thread waited for a core, 0
    /// to 1. Own threads are included.
    pub waiting_share: Option<f64>,
    /// Major page faults (disk access) of own processes.
    pub major_faults: Option<u64>,
    /// Involuntary context switches of own processes.
    pub involuntary_switches: Option<u64>,
    /// Number of CPU frequency changes, summed over all cores.
    pub frequency_changes: Option<u64>,
    /// Largest relative change of a core's frequency between beginning and end.
    pub frequency_drift_share: Option<f64>,
    /// Own processes that had ended before the end; their work counts as other load.
    pub ended_pids: Vec<u32>,
}

/// Monitor of disturbances: the kernel's counters at the start of a measurement.
#[derive(Debug)]
pub struct DisturbanceMonitor {
    files: SystemFiles,
    began: Instant,
    cpu_time: Option<CpuTime>,
    processes: BTreeMap<u32, ProcessCounters>,
    n_frequency_changes: Option<u64>,
    frequencies_khz: Vec<u64>,
}

impl Disturbance {
    /// Starts monitoring the kernel's disturbance counters.
    pub fn begin() -> DisturbanceMonitor {
        DisturbanceMonitor::begin(SystemFiles::real())
    }
}

impl DisturbanceMonitor {
    fn begin(files: SystemFiles) -> Self {
        let names = files.names_in("proc").into_iter();
        let pids = names.filter_map(|name| name.parse().ok());
        Self {
            processes: pids
                .filter_map(|pid| Some((pid, ProcessCounters::read_from(&files, pid)?)))
                .collect(),
            cpu_time: cpu_time(&files),
            n_frequency_changes: n_frequency_changes(&files),
            frequencies_khz: present_frequencies_khz(&files),
            began: Instant::now(),
            files,
        }
    }

    /// Disturbances since the start, excluding the work of `own_pids`.
    pub fn end(self, own_pids: &[u32]) -> Disturbance {
        let duration_s = self.began.elapsed().as_secs_f64();
        let mut pids = own_pids.to_vec();
        pids.sort_unstable();
        pids.dedup();
        let own: Vec<(u32, Option<ProcessCounters>)> = pids
            .iter()
            .map(|&pid| (pid, self.work_since(pid)))
            .collect();
        let known = || own.iter().filter_map(|(_, work)| *work);
        let own_ticks = known().map(|work| work.busy_ticks()).sum();
        let spent = self.cpu_time.zip(cpu_time(&self.files)).map(spent);
        let is_any_known = known().next().is_some();
        let sum = |of: fn(ProcessCounters) -> u64| is_any_known.then(|| known().map(of).sum());
        Disturbance {
            duration_s,
            steal_share: spent.and_then(steal_share),
            other_load_cores: spent.map(|spent| other_load(spent, own_ticks, duration_s)),
            waiting_share: self
                .files
                .text("proc/pressure/cpu")
                .and_then(|pressure| kernel_counters::pressure_share(&pressure)),
            major_faults: sum(|work| work.major_faults),
            involuntary_switches: sum(|work| work.involuntary_switches),
            frequency_changes: n_frequency_changes(&self.files)
                .zip(self.n_frequency_changes)
                .map(|(now, before)| now.saturating_sub(before)),
            frequency_drift_share: drift_share(
                &self.frequencies_khz,
                &present_frequencies_khz(&self.files),
            ),
            ended_pids: own
                .iter()
                .filter(|(_, work)| work.is_none())
                .map(|(pid, _)| *pid)
                .collect(),
        }
    }

    /// Counters of a process since the start of monitoring, or since its own start.
    fn work_since(&self, pid: u32) -> Option<ProcessCounters> {
        let now = ProcessCounters::read_from(&self.files, pid)?;
        let before = self.processes.get(&pid);
        let before = before.filter(|before| before.start == now.start);
        Some(before.map_or(now, |before| now.since(before)))
    }
}

fn cpu_time(files: &SystemFiles) -> Option<CpuTime> {
    kernel_counters::cpu_time(&files.text("proc/stat")?)
}

fn present_frequencies_khz(files: &SystemFiles) -> Vec<u64> {
    frequencies_khz(files, &files.text("proc/cpuinfo").unwrap_or_default())
}

fn spent((before, now): (CpuTime, CpuTime)) -> CpuTime {
    CpuTime {
        busy: now.busy.saturating_sub(before.busy),
        // The kernel's idle time may decrease slightly.
        idle: now.idle.saturating_sub(before.idle),
        steal: now.steal.saturating_sub(before.steal),
    }
}

fn steal_share(spent: CpuTime) -> Option<f64> {
    let total = spent.total();
    (total > 0).then(|| spent.steal as f64 / total as f64)
}

fn other_load(spent: CpuTime, own_ticks: u64, duration_s: f64) -> f64 {
    let other_ticks = spent.busy.saturating_sub(own_ticks) as f64;
    let other_s = other_ticks / rustix::param::clock_ticks_per_second() as f64;
    if duration_s > 0.0 {
        other_s / duration_s
    } else {
        0.0
    }
}

fn drift_share(before_khz: &[u64], now_khz: &[u64]) -> Option<f64> {
    let pairs = before_khz.iter().zip(now_khz);
    let drifts = pairs
        .filter(|(before, _)| **before > 0)
        .map(|(before, now)| now.abs_diff(*before) as f64 / *before as f64);
    drifts.max_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn write(root: &Path, path: &str, text: &str) {
        let path = root.join(path);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }

    fn write_process(root: &Path, pid: u32, start: u64, busy: u64) {
        let stat = format!("{pid} (x) S 1 1 1 0 -1 0 0 0 3 0 {busy} 0 0 0 20 0 1 0 {start} 1 1");
        write(root, &format!("proc/{pid}/stat"), &stat);
        let status = "nonvoluntary_ctxt_switches:\t5\n";
        write(root, &format!("proc/{pid}/task/{pid}/status"), status);
    }

    #[test]
    fn own_work_is_no_disturbance() {
        let root = tempfile::tempdir().unwrap();
        let root = root.path();
        write(root, "proc/stat", "cpu 1000 0 0 5000 0 0 0 100\n");
        write_process(root, 7, 50, 200);
        write_process(root, 8, 60, 500);
        let watch = DisturbanceMonitor::begin(SystemFiles::below(root));
        // Process 7 worked 30 ticks; another process took the id 8 and worked 4; process 9 does
        // not exist; others worked 16; 10 of 100 ticks were stolen.
        write(root, "proc/stat", "cpu 1050 0 0 5040 0 0 0 110\n");
        write_process(root, 7, 50, 230);
        write_process(root, 8, 90, 4);
        let own_ticks: u64 = [7, 8]
            .iter()
            .map(|pid| watch.work_since(*pid).unwrap().busy_ticks())
            .sum();
        assert_eq!(own_ticks, 34);
        let found = watch.end(&[8, 7, 7, 9]);
        assert_eq!(found.steal_share, Some(0.1));
        let ticks = found.other_load_cores.unwrap()
            * found.duration_s
            * rustix::param::clock_ticks_per_second() as f64;
        assert!((ticks - 16.0).abs() < 1e-6, "{ticks}");
        assert_eq!(found.ended_pids, [9]);
        // All work of process 8 counts, because it was started during the observation.
        assert_eq!(
            (found.major_faults, found.involuntary_switches),
            (Some(3), Some(5))
        );
    }

    #[test]
    fn unreported_values_are_none() {
        let root = tempfile::tempdir().unwrap();
        let found = DisturbanceMonitor::begin(SystemFiles::below(root.path())).end(&[1]);
        assert_eq!(
            (
                found.steal_share,
                found.other_load_cores,
                found.major_faults
            ),
            (None, None, None)
        );
        assert_eq!(
            (found.frequency_changes, found.frequency_drift_share),
            (None, None)
        );
        assert_eq!(found.ended_pids, [1]);
    }

    #[test]
    fn frequency_drift_is_that_of_the_worst_core() {
        assert_eq!(drift_share(&[1000, 2000], &[1000, 1500]), Some(0.25));
        assert_eq!(drift_share(&[], &[1]), None);
        assert_eq!(drift_share(&[0], &[1]), None);
    }

    #[test]
    fn this_computer_can_be_monitored() {
        let found = Disturbance::begin().end(&[std::process::id()]);
        assert!(found.ended_pids.is_empty());
        let text = serde_json::to_string(&found).unwrap();
        assert!(serde_json::from_str::<Disturbance>(&text).is_ok());
    }
}
