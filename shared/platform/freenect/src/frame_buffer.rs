//! Image memory written by the C library.

#![expect(
    unsafe_code,
    reason = "memory that C writes is owned through a raw pointer"
)]

use std::ffi::c_void;
use std::ptr::NonNull;

/// Owned memory of one image.
///
/// Held by pointer instead of a `Box`, because a `Box` asserts unique access, which the library's
/// writes would violate. `T` is a plain number type.
#[derive(Debug)]
pub(crate) struct FrameBuffer<T> {
    pixels: NonNull<[T]>,
}

impl<T: Copy + Default> FrameBuffer<T> {
    /// Zeroed image memory for `n` values.
    pub(crate) fn new(n: usize) -> Self {
        let pixels = Box::leak(vec![T::default(); n].into_boxed_slice());
        Self {
            pixels: NonNull::from(pixels),
        }
    }

    /// Address of the buffer to pass to libfreenect.
    pub(crate) fn address(&self) -> *mut c_void {
        self.pixels.as_ptr().cast()
    }

    /// Pixels of the buffered image.
    ///
    /// # Safety
    /// The library must have been given another buffer, and must not be given this one again
    /// during the lifetime of the result.
    pub(crate) unsafe fn pixels(&self) -> &[T] {
        // SAFETY: the memory is owned and initialised, and the caller guarantees that it is not
        // written.
        unsafe { self.pixels.as_ref() }
    }
}

impl<T> Drop for FrameBuffer<T> {
    fn drop(&mut self) {
        // SAFETY: the pointer came from a leaked box in `new` and is freed once, here.
        drop(unsafe { Box::from_raw(self.pixels.as_ptr()) });
    }
}
