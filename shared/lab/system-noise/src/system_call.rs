//! System calls without a safe wrapper.
#![expect(
    unsafe_code,
    reason = "the C library and rustix take pointers for scheduling, usage and advice on memory"
)]

use rustix::mm::{Advice, madvise};
use std::io;
use std::mem::MaybeUninit;

/// Scheduling policy and priority of a thread, as numbered by the kernel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Scheduling {
    pub(crate) policy: i32,
    pub(crate) priority: i32,
}

impl Scheduling {
    /// `SCHED_FIFO` at a real-time priority from 1 to 99.
    pub(crate) fn fifo(priority: i32) -> Self {
        Self {
            policy: libc::SCHED_FIFO,
            priority,
        }
    }
}

fn checked(result: i32) -> io::Result<i32> {
    if result < 0 {
        Err(io::Error::last_os_error())
    } else {
        Ok(result)
    }
}

/// Scheduling policy of the calling thread.
pub(crate) fn scheduling() -> io::Result<Scheduling> {
    // SAFETY: the call takes a number; 0 is the calling thread.
    let policy = checked(unsafe { libc::sched_getscheduler(0) })?;
    let mut parameters = MaybeUninit::<libc::sched_param>::zeroed();
    // SAFETY: the pointer is to a whole structure that outlives the call.
    checked(unsafe { libc::sched_getparam(0, parameters.as_mut_ptr()) })?;
    // SAFETY: all zeros are a valid value of its integers, and the kernel has filled it.
    let parameters = unsafe { parameters.assume_init() };
    Ok(Scheduling {
        policy,
        priority: parameters.sched_priority,
    })
}

/// Sets the scheduling policy of the calling thread.
pub(crate) fn set_scheduling(scheduling: Scheduling) -> io::Result<()> {
    let mut parameters = MaybeUninit::<libc::sched_param>::zeroed();
    // SAFETY: all zeros are a valid value of its integers.
    let parameters = unsafe { parameters.assume_init_mut() };
    parameters.sched_priority = scheduling.priority;
    // SAFETY: the pointer is to a whole structure that outlives the call; 0 is the
    // calling thread.
    checked(unsafe { libc::sched_setscheduler(0, scheduling.policy, parameters) })?;
    Ok(())
}

/// Reads the resource usage of the calling thread and discards it (`getrusage`).
pub(crate) fn read_thread_usage() -> io::Result<()> {
    let mut usage = MaybeUninit::<libc::rusage>::uninit();
    // SAFETY: the kernel writes one whole structure to a place of its size.
    checked(unsafe { libc::getrusage(libc::RUSAGE_THREAD, usage.as_mut_ptr()) })?;
    Ok(())
}

/// Advises huge pages for the whole pages of a buffer (`madvise`).
pub(crate) fn advise_huge_pages(words: &mut [MaybeUninit<u64>]) -> io::Result<()> {
    let page = rustix::param::page_size();
    let bytes = words.as_mut_ptr_range();
    let first = bytes.start.addr().next_multiple_of(page);
    let Some(length) = (bytes.end.addr() - bytes.end.addr() % page).checked_sub(first) else {
        return Ok(());
    };
    let start = bytes.start.with_addr(first).cast();
    // SAFETY: the range lies in the buffer, and this advice changes no contents.
    unsafe { madvise(start, length, Advice::LinuxHugepage) }?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn advice_takes_buffers_of_any_size() {
        for n_words in [0, 1, 511, 512, 4096, 1 << 20] {
            let mut words = Vec::<u64>::with_capacity(n_words);
            let spare = &mut words.spare_capacity_mut()[..n_words];
            let advised = advise_huge_pages(spare);
            // A kernel without huge pages rejects the advice.
            assert!(
                advised.is_ok() || advised.is_err_and(|e| e.raw_os_error() == Some(libc::EINVAL))
            );
        }
    }

    #[test]
    fn the_calling_thread_has_a_policy_and_usage() {
        assert!(scheduling().is_ok());
        assert!(read_thread_usage().is_ok());
    }
}
