//! A received message that many threads read.
#![expect(
    unsafe_code,
    reason = "makes a received sample readable by several threads"
)]

use crate::domain::Service;
use crate::topic::Topic;
use iceoryx2::sample::Sample;
use message::SegmentLocation;

/// A received message, still in shared memory. Wrapped in an `Arc` it goes to any
/// number of threads; the memory goes back to its publisher with the last one.
#[derive(Debug)]
pub struct SharedFrame<T: Topic> {
    sample: Sample<Service, [T::Item], T::Header>,
    location: SegmentLocation,
}

// SAFETY: `Sample` is Send; it is not Sync only because nothing promises that its
// methods may run at the same time. Through a shared reference we call nothing
// but `payload` and `user_header`, which read two pointers fixed at construction
// and return references to plain data that no writer touches while the sample is
// held. What changes state, returning the sample, needs ownership.
unsafe impl<T: Topic> Sync for SharedFrame<T> {}

impl<T: Topic> SharedFrame<T> {
    pub(crate) fn new(
        sample: Sample<Service, [T::Item], T::Header>,
        location: SegmentLocation,
    ) -> Self {
        Self { sample, location }
    }

    /// The header.
    #[inline]
    pub fn header(&self) -> &T::Header {
        self.sample.user_header()
    }

    /// The items, in shared memory.
    #[inline]
    pub fn items(&self) -> &[T::Item] {
        self.sample.payload()
    }

    /// Where the items lie in shared memory, as this process sees it.
    pub fn location(&self) -> SegmentLocation {
        self.location
    }
}
