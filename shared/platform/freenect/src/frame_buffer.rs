//! Memory the C library writes images into.

#![expect(
    unsafe_code,
    reason = "memory that C writes is owned through a raw pointer"
)]

use std::ffi::c_void;
use std::ptr::NonNull;

/// One image's memory, owned.
///
/// It is held by pointer and not as a `Box`, because a `Box` promises that
/// nobody else writes to it, wherever it is moved. `T` is a plain number.
#[derive(Debug)]
pub(crate) struct FrameBuffer<T> {
    pixels: NonNull<[T]>,
}

impl<T: Copy + Default> FrameBuffer<T> {
    /// Zeroed memory for `n` values.
    pub(crate) fn new(n: usize) -> Self {
        let pixels = Box::leak(vec![T::default(); n].into_boxed_slice());
        Self {
            pixels: NonNull::from(pixels),
        }
    }

    /// The address to hand to the library.
    pub(crate) fn address(&self) -> *mut c_void {
        self.pixels.as_ptr().cast()
    }

    /// The image.
    ///
    /// # Safety
    /// The library must have been given another buffer, and must not be given
    /// this one again while the result lives.
    pub(crate) unsafe fn pixels(&self) -> &[T] {
        // SAFETY: the memory is ours, initialised, and by the caller's word unwritten.
        unsafe { self.pixels.as_ref() }
    }
}

impl<T> Drop for FrameBuffer<T> {
    fn drop(&mut self) {
        // SAFETY: the pointer came from a leaked box in `new` and is freed once, here.
        drop(unsafe { Box::from_raw(self.pixels.as_ptr()) });
    }
}
