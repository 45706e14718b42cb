//! Global allocator that counts allocations.
#![expect(unsafe_code, reason = "GlobalAlloc is an unsafe trait")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::atomic::{AtomicU64, Ordering};

static N_ALLOCATIONS: AtomicU64 = AtomicU64::new(0);
static N_BYTES: AtomicU64 = AtomicU64::new(0);

thread_local! {
    /// Allocations and bytes of this thread. Without a destructor and without lazy
    /// initialisation, so that counting never allocates.
    static OF_THREAD: Cell<(u64, u64)> = const { Cell::new((0, 0)) };
}

/// System allocator with counters, which every process reports in its health: steady
/// state must not allocate per frame, and the field must see it when it does. Two
/// relaxed additions cost less than the allocation's own lock.
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
}

fn count(n_bytes: usize) {
    N_ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
    N_BYTES.fetch_add(n_bytes as u64, Ordering::Relaxed);
    let (n_allocations, n_thread_bytes) = OF_THREAD.get();
    OF_THREAD.set((n_allocations + 1, n_thread_bytes + n_bytes as u64));
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
        count(new_size);
        // SAFETY: the caller keeps the trait's contract.
        unsafe { System.realloc(pointer, layout, new_size) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller keeps the trait's contract.
        unsafe { System.dealloc(pointer, layout) }
    }
}
