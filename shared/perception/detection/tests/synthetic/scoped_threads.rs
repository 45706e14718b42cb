//! Parallelism by scoped threads, started for each stage.

use crate::Parallelism;

/// Parallelism by this number of scoped threads.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ScopedThreads(pub(crate) usize);

impl Parallelism for ScopedThreads {
    fn run_on_all(&self, work: &(dyn Fn() + Sync)) {
        std::thread::scope(|scope| {
            for _ in 1..self.0 {
                scope.spawn(work);
            }
            work();
        });
    }
}
