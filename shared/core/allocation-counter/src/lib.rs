//! Global allocator that counts allocations, by process and by thread.
//!
//! The daemon's processes report the counters in their health; tests assert with
//! them that a kernel does not allocate in steady state.
//!
//! ```
//! use allocation_counter::CountingAllocator;
//!
//! #[global_allocator]
//! static ALLOCATOR: CountingAllocator = CountingAllocator;
//!
//! let (n_before, _) = CountingAllocator::counts_of_thread();
//! let buffer = Vec::<u8>::with_capacity(100);
//! let (n_after, _) = CountingAllocator::counts_of_thread();
//! assert_eq!(n_after - n_before, 1);
//! # drop(buffer);
//! ```
#![expect(unsafe_code, reason = "GlobalAlloc is an unsafe trait")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::atomic::{AtomicU64, Ordering};

static N_ALLOCATIONS: AtomicU64 = AtomicU64::new(0);
static N_BYTES: AtomicU64 = AtomicU64::new(0);

// Without a destructor and without lazy initialisation, so that counting never allocates.
thread_local! {
    /// Allocations and requested bytes of this thread.
    static OF_THREAD: Cell<(u64, u64)> = const { Cell::new((0, 0)) };
    /// Bytes requested less bytes freed by this thread.
    static LIVE_BYTES: Cell<i64> = const { Cell::new(0) };
}

/// System allocator with counters. Two relaxed additions cost less than the
/// allocation's own lock.
#[derive(Debug)]
pub struct CountingAllocator;

impl CountingAllocator {
    /// Number of allocations and requested bytes since the start of the process.
    pub fn counts() -> (u64, u64) {
        (
            N_ALLOCATIONS.load(Ordering::Relaxed),
            N_BYTES.load(Ordering::Relaxed),
        )
    }

    /// Number of allocations and requested bytes of this thread since its start.
    pub fn counts_of_thread() -> (u64, u64) {
        OF_THREAD.get()
    }

    /// Number of bytes that this thread requested less those that it freed, without the
    /// allocator's own overhead; negative when it frees the memory of other threads.
    pub fn live_bytes_of_thread() -> i64 {
        LIVE_BYTES.get()
    }
}

fn count(n_bytes: usize) {
    N_ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
    N_BYTES.fetch_add(n_bytes as u64, Ordering::Relaxed);
    let (n_allocations, n_thread_bytes) = OF_THREAD.get();
    OF_THREAD.set((n_allocations + 1, n_thread_bytes + n_bytes as u64));
    LIVE_BYTES.set(LIVE_BYTES.get() + n_bytes as i64);
}

fn discount(n_bytes: usize) {
    LIVE_BYTES.set(LIVE_BYTES.get() - n_bytes as i64);
}

// SAFETY: every method passes its arguments unchanged to the system's allocator,
// whose contract is the trait's own; counting touches no allocated memory.
unsafe impl GlobalAlloc for CountingAllocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size());
        // SAFETY: the caller keeps the trait's contract.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count(layout.size());
        // SAFETY: the caller keeps the trait's contract.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, new_size: usize) -> *mut u8 {
        discount(layout.size());
        count(new_size);
        // SAFETY: the caller keeps the trait's contract.
        unsafe { System.realloc(pointer, layout, new_size) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        discount(layout.size());
        // SAFETY: the caller keeps the trait's contract.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[cfg(test)]
mod tests {
    use super::CountingAllocator;

    #[global_allocator]
    static ALLOCATOR: CountingAllocator = CountingAllocator;

    #[test]
    fn allocation_growth_and_release_are_counted_in_their_thread() {
        let (n_before, bytes_before) = CountingAllocator::counts_of_thread();
        let live_before = CountingAllocator::live_bytes_of_thread();
        let mut buffer = Vec::<u8>::with_capacity(100);
        buffer.reserve_exact(300);
        let zeroed = vec![0_u8; 1000];
        let live = CountingAllocator::live_bytes_of_thread() - live_before;
        let (n, n_bytes) = CountingAllocator::counts_of_thread();
        assert_eq!((n - n_before, n_bytes - bytes_before), (3, 1400));
        assert_eq!(live, 1300);
        drop((buffer, zeroed));
        assert_eq!(CountingAllocator::live_bytes_of_thread(), live_before);
    }

    #[test]
    fn process_counters_include_other_threads() {
        let (_, before) = CountingAllocator::counts();
        let of_thread = std::thread::spawn(|| {
            drop(std::hint::black_box(vec![1_u8; 1 << 20]));
            CountingAllocator::counts_of_thread()
        });
        let (n_of_thread, bytes_of_thread) = of_thread.join().unwrap();
        let (n, after) = CountingAllocator::counts();
        assert!(n >= n_of_thread && bytes_of_thread >= 1 << 20);
        assert!(after - before >= 1 << 20);
    }
}
