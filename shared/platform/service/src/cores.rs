//! On which cores threads may run.

use rustix::io::Result;
use rustix::thread::{CpuSet, Pid, sched_getaffinity, sched_getcpu, sched_setaffinity};

/// The cores that the process was given.
#[derive(Debug, Clone)]
pub struct Cores(CpuSet);

impl Cores {
    /// What the calling thread may use now; it stands for the process before any
    /// thread was kept off a core.
    ///
    /// # Errors
    /// That of the system.
    pub fn of_process() -> Result<Self> {
        sched_getaffinity(None).map(Self)
    }

    /// The core on which the calling thread runs.
    pub fn current() -> usize {
        sched_getcpu()
    }

    /// Keeps a thread of this process, by its [id](crate::thread_id), off a core. Nothing
    /// happens where that is the only one.
    ///
    /// # Errors
    /// That of the system; when the thread has ended, for example.
    pub fn keep_off(&self, thread_id: u32, core: usize) -> Result<()> {
        let mut others = self.0;
        others.unset(core);
        if others.count() == 0 {
            return Ok(());
        }
        allow(thread_id, &others)
    }

    /// Gives a thread all cores again.
    ///
    /// # Errors
    /// As for [`keep_off`](Self::keep_off).
    pub fn give_back(&self, thread_id: u32) -> Result<()> {
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
    fn a_thread_leaves_the_core_it_is_kept_off_and_comes_back() {
        let cores = Cores::of_process().unwrap();
        let own = thread_id();
        let first = Cores::current();
        cores.keep_off(own, first).unwrap();
        let n_cores = cores.0.count();
        assert_eq!(Cores::current() == first, n_cores == 1);
        let mut allowed = sched_getaffinity(None).unwrap().count();
        assert_eq!(allowed, (n_cores - 1).max(1));
        cores.give_back(own).unwrap();
        allowed = sched_getaffinity(None).unwrap().count();
        assert_eq!(allowed, n_cores);
        assert!(cores.keep_off(u32::MAX >> 1, first).is_err() || n_cores == 1);
    }
}
