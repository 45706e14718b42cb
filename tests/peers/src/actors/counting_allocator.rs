//! Counting global allocator: heap bytes in use, per thread.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

/// System allocator that counts allocated minus freed bytes of each thread.
pub struct CountingAllocator;

thread_local! {
    static IN_USE: Cell<isize> = const { Cell::new(0) };
}

/// Heap bytes that this thread has allocated and not freed, without the allocator's own
/// overhead.
pub fn in_use() -> isize {
    IN_USE.get()
}

/// Adds a change in bytes to the counter of this thread.
fn count(change: isize) {
    // A thread that ends may free memory after its thread-local counter is destroyed.
    let _ = IN_USE.try_with(|n| n.set(n.get() + change));
}

// SAFETY: every call goes to the system's allocator unchanged.
unsafe impl GlobalAlloc for CountingAllocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as isize);
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count(-(layout.size() as isize));
        // SAFETY: `pointer` came from the same allocator with this layout.
        unsafe { System.dealloc(pointer, layout) }
    }
}
