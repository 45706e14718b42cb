//! Parallel execution of detection stages over shared work items.

use parking_lot::Mutex;

/// Parallelism: the threads on which detection stages run.
///
/// The result does not depend on the implementation.
pub trait Parallelism {
    /// Run `work` on the calling thread and, at the same time, on any idle threads; return
    /// after the last call ends. Each call takes work items until none is left.
    fn run_on_all(&self, work: &(dyn Fn() + Sync));
}

/// Sequential execution on the calling thread.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sequential;

impl Parallelism for Sequential {
    fn run_on_all(&self, work: &(dyn Fn() + Sync)) {
        work();
    }
}

/// Run `work` for each item on all threads; an idle thread takes the next item.
pub(crate) fn for_each<I>(parallelism: &dyn Parallelism, items: I, work: impl Fn(I::Item) + Sync)
where
    I: Iterator<Item: Send> + Send,
{
    let items = Mutex::new(items);
    parallelism.run_on_all(&|| {
        while let Some(item) = take_next(&items) {
            work(item);
        }
    });
}

/// Scratch pool: one buffer per working thread, reused from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct ScratchPool<D>(Mutex<Vec<D>>);

impl<D: Default + Send> ScratchPool<D> {
    /// Run `work` for each item on all threads, each with its own scratch buffer.
    pub(crate) fn for_each<I>(
        &self,
        parallelism: &dyn Parallelism,
        items: I,
        work: impl Fn(&mut D, I::Item) + Sync,
    ) where
        I: Iterator<Item: Send> + Send,
    {
        let items = Mutex::new(items);
        parallelism.run_on_all(&|| {
            let mut scratch = None;
            while let Some(item) = take_next(&items) {
                work(scratch.get_or_insert_with(|| self.take()), item);
            }
            if let Some(scratch) = scratch {
                self.0.lock().push(scratch);
            }
        });
    }

    /// All scratch buffers, while no work runs.
    pub(crate) fn all(&mut self) -> &mut [D] {
        self.0.get_mut()
    }

    fn take(&self) -> D {
        self.0.lock().pop().unwrap_or_default()
    }
}

impl<T: Send> ScratchPool<Vec<T>> {
    /// Move the contents of all scratch buffers into a list, in no particular order.
    pub(crate) fn gather(&mut self, list: &mut Vec<T>) {
        for scratch in self.all() {
            list.append(scratch);
        }
    }
}

/// Next work item; the lock is released before the work begins.
fn take_next<I: Iterator>(items: &Mutex<I>) -> Option<I::Item> {
    items.lock().next()
}

#[cfg(test)]
#[path = "../tests/synthetic/scoped_threads.rs"]
mod scoped_threads;
#[cfg(test)]
pub(crate) use scoped_threads::ScopedThreads;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_are_taken_once_and_no_scratch_is_lost() {
        for n_threads in [1, 2, 4] {
            let parallelism = ScopedThreads(n_threads);
            let mut marks = vec![0; 500];
            for_each(&parallelism, marks.iter_mut(), |mark| *mark += 1);
            assert!(marks.iter().all(|mark| *mark == 1));
            let mut pool = ScratchPool::<Vec<usize>>::default();
            for _ in 0..2 {
                pool.for_each(&parallelism, 0..500, Vec::push);
            }
            assert!((1..=2 * n_threads).contains(&pool.all().len()));
            let mut taken: Vec<usize> = pool.all().concat();
            taken.sort_unstable();
            assert!(taken.iter().copied().eq((0..500).flat_map(|i| [i, i])));
        }
    }
}
