//! Resource usage of a stage: processor time, context switches, allocations, page faults.

use message::Span;
use serde::{Deserialize, Serialize};

/// Resource usage summed over all intervals of a stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct ResourceUsage {
    /// Number of intervals in which a measured thread worked.
    pub worked: u64,
    /// Processor time used, nanoseconds.
    pub cpu_ns: u64,
    /// Number of voluntary context switches.
    pub voluntary_switches: u64,
    /// Number of involuntary context switches.
    pub involuntary_switches: u64,
    /// Number of heap allocations.
    pub allocations: u64,
    /// Heap bytes requested by allocations.
    pub allocated_bytes: u64,
    /// Minor page faults (no disk access).
    pub minor_faults: u64,
    /// Major page faults (read from disk).
    pub major_faults: u64,
}

impl ResourceUsage {
    /// Adds the resource usage of one stage interval.
    pub fn add(&mut self, span: &Span) {
        let add = |sum: &mut u64, more: u64| *sum = sum.saturating_add(more);
        add(&mut self.worked, u64::from(span.thread_id != 0));
        add(&mut self.cpu_ns, span.cpu_ns);
        add(
            &mut self.voluntary_switches,
            span.n_voluntary_switches.into(),
        );
        add(
            &mut self.involuntary_switches,
            span.n_involuntary_switches.into(),
        );
        add(&mut self.allocations, span.n_allocations.into());
        add(&mut self.allocated_bytes, span.allocated_bytes);
        add(&mut self.minor_faults, span.n_minor_faults.into());
        add(&mut self.major_faults, span.n_major_faults.into());
    }
}
