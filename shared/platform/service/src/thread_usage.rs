//! What a thread has used so far.
#![expect(
    unsafe_code,
    reason = "the system tells of one thread only through a C structure"
)]

use crate::CountingAllocator;
use rustix::thread::gettid;
use rustix::time::{ClockId, clock_gettime};
use std::cell::Cell;
use std::mem::MaybeUninit;

thread_local! {
    /// Asked once: it costs a call of the system.
    static THREAD_ID: Cell<u32> = const { Cell::new(0) };
}

/// What the calling thread has used since its start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ThreadUsage {
    /// Processor time.
    pub cpu_ns: u64,
    /// Heap allocations, where [`CountingAllocator`] is the process's allocator.
    pub n_allocations: u64,
    /// Heap bytes requested, likewise.
    pub allocated_bytes: u64,
    /// How often it gave up its processor.
    pub n_voluntary_switches: u64,
    /// How often its processor was taken from it.
    pub n_involuntary_switches: u64,
    /// Page faults without disk.
    pub n_minor_faults: u64,
    /// Page faults that read from disk.
    pub n_major_faults: u64,
}

impl ThreadUsage {
    /// Of the calling thread, now. Two calls of the system.
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
    // SAFETY: the structure is of plain numbers and was zeroed, so it is one even
    // when the call has failed.
    unsafe { usage.assume_init() }
}

/// The kernel's number of the calling thread.
pub fn thread_id() -> u32 {
    let known = THREAD_ID.get();
    if known != 0 {
        return known;
    }
    let asked = gettid().as_raw_nonzero().get().cast_unsigned();
    THREAD_ID.set(asked);
    asked
}
