//! A parallelism of threads that are started for each piece of work.

use crate::Crew;

/// So many threads.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ScopedThreads(pub(crate) usize);

impl Crew for ScopedThreads {
    fn together(&self, work: &(dyn Fn() + Sync)) {
        std::thread::scope(|scope| {
            for _ in 1..self.0 {
                scope.spawn(work);
            }
            work();
        });
    }
}
