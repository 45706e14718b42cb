//! Threads that take part in a search.

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
pub struct Alone;

impl Crew for Alone {
    fn together(&self, work: &(dyn Fn() + Sync)) {
        work();
    }
}

/// Does `work` with each item: who is free takes the next one.
pub(crate) fn each<I>(crew: &dyn Crew, items: I, work: impl Fn(I::Item) + Sync)
where
    I: Iterator<Item: Send> + Send,
{
    let items = Mutex::new(items);
    crew.together(&|| {
        while let Some(item) = next_of(&items) {
            work(item);
        }
    });
}

/// Memory for those who work together, a piece for each. Reused from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct Desks<D>(Mutex<Vec<D>>);

impl<D: Default + Send> Desks<D> {
    /// Does `work` with each item, and with a desk that nobody else has meanwhile.
    pub(crate) fn each<I>(&self, crew: &dyn Crew, items: I, work: impl Fn(&mut D, I::Item) + Sync)
    where
        I: Iterator<Item: Send> + Send,
    {
        let items = Mutex::new(items);
        crew.together(&|| {
            let mut desk = None;
            while let Some(item) = next_of(&items) {
                work(desk.get_or_insert_with(|| self.take()), item);
            }
            if let Some(desk) = desk {
                self.0
                    .lock()
                    .unwrap_or_else(PoisonError::into_inner)
                    .push(desk);
            }
        });
    }

    /// All desks, when nobody works.
    pub(crate) fn all(&mut self) -> &mut [D] {
        self.0.get_mut().unwrap_or_else(PoisonError::into_inner)
    }

    fn take(&self) -> D {
        let mut desks = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        desks.pop().unwrap_or_default()
    }
}

impl<T: Send> Desks<Vec<T>> {
    /// Empties all desks into a list, in no order.
    pub(crate) fn gather(&mut self, list: &mut Vec<T>) {
        for desk in self.all() {
            list.append(desk);
        }
    }
}

/// The lock is released before anybody works with the item.
fn next_of<I: Iterator>(items: &Mutex<I>) -> Option<I::Item> {
    items.lock().unwrap_or_else(PoisonError::into_inner).next()
}

#[cfg(test)]
#[path = "../tests/synthetic/threads.rs"]
mod threads;
#[cfg(test)]
pub(crate) use threads::Threads;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_item_is_taken_once_and_no_desk_is_lost() {
        for n_threads in [1, 2, 4] {
            let crew = Threads(n_threads);
            let mut marks = vec![0; 500];
            each(&crew, marks.iter_mut(), |mark| *mark += 1);
            assert!(marks.iter().all(|mark| *mark == 1));
            let mut desks = Desks::<Vec<usize>>::default();
            for _ in 0..2 {
                desks.each(&crew, 0..500, Vec::push);
            }
            assert!((1..=2 * n_threads).contains(&desks.all().len()));
            let mut taken: Vec<usize> = desks.all().concat();
            taken.sort_unstable();
            assert!(taken.iter().copied().eq((0..500).flat_map(|i| [i, i])));
        }
    }
}
