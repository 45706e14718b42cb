//! Resource usage of a thread (`getrusage`).
#![expect(unsafe_code, reason = "rustix does not wrap getrusage(RUSAGE_THREAD)")]

use crate::CountingAllocator;
use rustix::thread::gettid;
use rustix::time::{ClockId, clock_gettime};
use std::cell::Cell;
use std::mem::MaybeUninit;

thread_local! {
    /// Cached thread id: reading it is a system call.
    static THREAD_ID: Cell<u32> = const { Cell::new(0) };
}

/// Resources used by the calling thread since its start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ThreadUsage {
    /// Processor time of the thread, nanoseconds.
    pub cpu_ns: u64,
    /// Number of heap allocations, where [`CountingAllocator`] is the process's
    /// allocator.
    pub n_allocations: u64,
    /// Heap bytes requested by the thread, under the same condition.
    pub allocated_bytes: u64,
    /// Number of voluntary context switches.
    pub n_voluntary_switches: u64,
    /// Number of involuntary context switches.
    pub n_involuntary_switches: u64,
    /// Number of page faults without disk access.
    pub n_minor_faults: u64,
    /// Number of page faults with disk access.
    pub n_major_faults: u64,
}

impl ThreadUsage {
    /// Usage of the calling thread, now. Two system calls.
    pub fn now() -> Self {
        let cpu = clock_gettime(ClockId::ThreadCPUTime);
        let (n_allocations, allocated_bytes) = CountingAllocator::counts_of_thread();
        let counted = resource_usage();
        let number = |value: libc::c_long| u64::try_from(value).unwrap_or(0);
        Self {
            cpu_ns: (cpu.tv_sec * 1_000_000_000 + cpu.tv_nsec) as u64,
            n_allocations,
            allocated_bytes,
            n_voluntary_switches: number(counted.ru_nvcsw),
            n_involuntary_switches: number(counted.ru_nivcsw),
            n_minor_faults: number(counted.ru_minflt),
            n_major_faults: number(counted.ru_majflt),
        }
    }
}

fn resource_usage() -> libc::rusage {
    let mut usage = MaybeUninit::<libc::rusage>::zeroed();
    // SAFETY: the pointer is to a whole structure of the kind that the call fills.
    let _ = unsafe { libc::getrusage(libc::RUSAGE_THREAD, usage.as_mut_ptr()) };
    // SAFETY: the structure consists of plain numbers and was zeroed, so it is valid
    // even when the call has failed.
    unsafe { usage.assume_init() }
}

/// Kernel's id of the calling thread.
pub fn thread_id() -> u32 {
    let known = THREAD_ID.get();
    if known != 0 {
        return known;
    }
    let thread_id = gettid().as_raw_nonzero().get().cast_unsigned();
    THREAD_ID.set(thread_id);
    thread_id
}
