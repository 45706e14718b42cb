//! ScopedThreads that take part in a search.

use std::sync::{Mutex, PoisonError};

/// Who takes part in a search.
///
/// What is found does not depend on it.
pub trait Crew {
    /// Calls `work` on the calling thread, and at the same time on others that have
    /// nothing else to do; returns when the last call is over.
    fn together(&self, work: &(dyn Fn() + Sync));
}

/// The calling thread, without help.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sequential;

impl Crew for Sequential {
    fn together(&self, work: &(dyn Fn() + Sync)) {
        work();
    }
}

/// Does `work` with each item: who is free takes the next one.
pub(crate) fn for_each<I>(parallelism: &dyn Crew, items: I, work: impl Fn(I::Item) + Sync)
where
    I: Iterator<Item: Send> + Send,
{
    let items = Mutex::new(items);
    parallelism.together(&|| {
        while let Some(item) = take_next(&items) {
            work(item);
        }
    });
}

/// Memory for those who work together, a piece for each. Reused from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct ScratchPool<D>(Mutex<Vec<D>>);

impl<D: Default + Send> ScratchPool<D> {
    /// Does `work` with each item, and with a scratch that nobody else has meanwhile.
    pub(crate) fn for_each<I>(
        &self,
        parallelism: &dyn Crew,
        items: I,
        work: impl Fn(&mut D, I::Item) + Sync,
    ) where
        I: Iterator<Item: Send> + Send,
    {
        let items = Mutex::new(items);
        parallelism.together(&|| {
            let mut scratch = None;
            while let Some(item) = take_next(&items) {
                work(scratch.get_or_insert_with(|| self.take()), item);
            }
            if let Some(scratch) = scratch {
                self.0
                    .lock()
                    .unwrap_or_else(PoisonError::into_inner)
                    .push(scratch);
            }
        });
    }

    /// All pool, when nobody works.
    pub(crate) fn all(&mut self) -> &mut [D] {
        self.0.get_mut().unwrap_or_else(PoisonError::into_inner)
    }

    fn take(&self) -> D {
        let mut pool = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        pool.pop().unwrap_or_default()
    }
}

impl<T: Send> ScratchPool<Vec<T>> {
    /// Empties all pool into a list, in no order.
    pub(crate) fn gather(&mut self, list: &mut Vec<T>) {
        for scratch in self.all() {
            list.append(scratch);
        }
    }
}

/// The lock is released before anybody works with the item.
fn take_next<I: Iterator>(items: &Mutex<I>) -> Option<I::Item> {
    items.lock().unwrap_or_else(PoisonError::into_inner).next()
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
    fn each_item_is_taken_once_and_no_desk_is_lost() {
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
