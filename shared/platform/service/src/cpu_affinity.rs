//! CPU affinity of threads.

use rustix::io::Result;
use rustix::thread::{CpuSet, Pid, sched_getaffinity, sched_getcpu, sched_setaffinity};

/// CPU set of the process.
#[derive(Debug, Clone)]
pub struct CpuAffinity(CpuSet);

impl CpuAffinity {
    /// CPU set of the calling thread; it stands for the process before any thread was
    /// excluded from a core.
    ///
    /// # Errors
    /// Error of the system.
    pub fn of_process() -> Result<Self> {
        sched_getaffinity(None).map(Self)
    }

    /// Core on which the calling thread runs.
    pub fn current() -> usize {
        sched_getcpu()
    }

    /// Excludes a core from a thread of this process, named by its
    /// [id](crate::thread_id). Without effect where that is the only core.
    ///
    /// # Errors
    /// Error of the system; when the thread has ended, for example.
    pub fn exclude(&self, thread_id: u32, core: usize) -> Result<()> {
        let mut others = self.0;
        others.unset(core);
        if others.count() == 0 {
            return Ok(());
        }
        allow(thread_id, &others)
    }

    /// Allows a thread all cores again.
    ///
    /// # Errors
    /// As for [`exclude`](Self::exclude).
    pub fn restore(&self, thread_id: u32) -> Result<()> {
        allow(thread_id, &self.0)
    }
}

fn allow(thread_id: u32, cores: &CpuSet) -> Result<()> {
    match Pid::from_raw(thread_id.cast_signed()) {
        Some(thread) => sched_setaffinity(Some(thread), cores),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::thread_id;

    #[test]
    fn thread_leaves_an_excluded_core_and_returns() {
        let cores = CpuAffinity::of_process().unwrap();
        let own = thread_id();
        let first = CpuAffinity::current();
        cores.exclude(own, first).unwrap();
        let n_cores = cores.0.count();
        assert_eq!(CpuAffinity::current() == first, n_cores == 1);
        let mut allowed = sched_getaffinity(None).unwrap().count();
        assert_eq!(allowed, (n_cores - 1).max(1));
        cores.restore(own).unwrap();
        allowed = sched_getaffinity(None).unwrap().count();
        assert_eq!(allowed, n_cores);
        assert!(cores.exclude(u32::MAX >> 1, first).is_err() || n_cores == 1);
    }
}
