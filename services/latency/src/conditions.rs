//! Conditions of a measurement: warnings, process usage, shared memory, machine.

use crate::process_usage::ProcessUsage;
use crate::trace_reader::TraceReader;
use channel::topic::MAX_FRAME_POINTS;
use channel::{Domain, SharedMemory};
use latency_report::{Conditions, SharedMemoryReport};
use serde::Serialize;
use service::{wall_clock_ns, wall_clock_offset_ns};
use system_noise::{Disturbance, DisturbanceMonitor, Fingerprint};

/// Environment and disturbances of the computer, as stored in the report.
#[derive(Serialize)]
struct MachineConditions {
    fingerprint: Fingerprint,
    disturbance: Disturbance,
}

/// Monitor of the conditions during a measurement.
pub(crate) struct ConditionsMonitor {
    machine: DisturbanceMonitor,
    processes: Vec<ProcessUsage>,
    lost_before: u64,
    clock_offset_before_ns: i64,
}

/// Maximum drift of the wall clock against the monotonic clock without a warning. Clock
/// adjustment is no error, but matters to readers of both time stamps.
const CLOCK_DRIFT_MAX_NS: u64 = 5_000_000;

impl ConditionsMonitor {
    /// Starts monitoring with the processes that have sent traces.
    pub(crate) fn begin(trace_reader: &TraceReader) -> Self {
        Self {
            machine: Disturbance::begin(),
            processes: ProcessUsage::begin_all(trace_reader),
            lost_before: trace_reader.n_lost(),
            clock_offset_before_ns: wall_clock_offset_ns(),
        }
    }

    /// Measurement conditions from the start until now.
    pub(crate) fn end(
        self,
        source: String,
        domain: &Domain,
        trace_reader: &TraceReader,
    ) -> Conditions {
        let lost_messages = trace_reader.n_lost() - self.lost_before;
        let memory = shared_memory(domain);
        let mut warnings = self.warnings(trace_reader, lost_messages);
        let processes: Vec<_> = self
            .processes
            .iter()
            .filter_map(ProcessUsage::report)
            .collect();
        let own_pids: Vec<u32> = processes.iter().map(|process| process.pid).collect();
        let machine_conditions = machine_conditions(self.machine, own_pids, &mut warnings);
        Conditions {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            source,
            measured_at_s: (wall_clock_ns() / 1_000_000_000).max(0) as u64,
            warnings,
            processes,
            shared_memory: SharedMemoryReport {
                used_bytes: memory.map_or(0, |memory| memory.used_by_domain),
                reserved_bytes: memory.map_or(0, |memory| memory.needed),
                lost_messages,
            },
            machine: machine_conditions,
        }
    }

    fn warnings(&self, trace_reader: &TraceReader, lost_messages: u64) -> Vec<String> {
        let mut warnings = Vec::new();
        if lost_messages > 0 {
            warnings.push(format!(
                "{lost_messages} trace message(s) came faster than they were read, so frames \
                 count as dropped that were not; measure fewer objects, or a lower rate"
            ));
        }
        let left_out = trace_reader.assembler().n_left_out();
        if left_out > 0 {
            warnings.push(format!(
                "{left_out} span(s) found no place in their frames' messages: there are more \
                 objects than a trace holds, and their stages are incomplete"
            ));
        }
        let drift_ns = wall_clock_offset_ns().abs_diff(self.clock_offset_before_ns);
        if drift_ns > CLOCK_DRIFT_MAX_NS {
            warnings.push(format!(
                "the wall clock was set by {:.1} ms against the monotonic one meanwhile",
                drift_ns as f64 / 1e6
            ));
        }
        warnings.extend(self.ended_processes());
        warnings
    }

    /// Warning about ended processes: a restarted process adds its cold start to the figures.
    fn ended_processes(&self) -> Option<String> {
        let ended = self
            .processes
            .iter()
            .filter(|usage| usage.report().is_none());
        let n_ended = ended.count();
        (n_ended > 0).then(|| {
            format!("{n_ended} process(es) of the daemon have ended while they were measured")
        })
    }
}

/// Shared memory of a domain; `None` when it cannot be told.
pub(crate) fn shared_memory(domain: &Domain) -> Option<SharedMemory> {
    SharedMemory::of_domain(domain.name(), MAX_FRAME_POINTS, domain.guest_places())
}

/// Machine conditions as JSON; findings that invalidate figures become warnings. This process is
/// no disturbance: its cost is reported as measurement overhead.
fn machine_conditions(
    machine: DisturbanceMonitor,
    mut own_pids: Vec<u32>,
    warnings: &mut Vec<String>,
) -> serde_json::Value {
    own_pids.push(std::process::id());
    let machine_conditions = MachineConditions {
        fingerprint: Fingerprint::read(),
        disturbance: machine.end(&own_pids),
    };
    let findings = system_noise::warnings(
        &machine_conditions.fingerprint,
        &machine_conditions.disturbance,
    );
    warnings.extend(findings.iter().map(ToString::to_string));
    serde_json::to_value(machine_conditions).unwrap_or_default()
}
