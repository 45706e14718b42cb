//! How many bytes of the heap are in use.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

/// The system's allocator, counting for each thread what it was asked for and
/// gave back.
pub struct Counting;

thread_local! {
    static IN_USE: Cell<isize> = const { Cell::new(0) };
}

/// Bytes this thread has asked for and not given back, without the allocator's
/// own overhead.
pub fn in_use() -> isize {
    IN_USE.get()
}

fn count(change: isize) {
    // A thread that ends frees after its counter is gone.
    let _ = IN_USE.try_with(|n| n.set(n.get() + change));
}

// SAFETY: every call goes to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
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
