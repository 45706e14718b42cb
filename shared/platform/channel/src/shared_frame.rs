//! A received message that many threads read.
#![expect(
    unsafe_code,
    reason = "makes a received sample readable by several threads"
)]

use crate::domain::Service;
use crate::segment::SegmentMap;
use crate::topic::Topic;
use iceoryx2::sample::Sample;
use message::SegmentLocation;
use std::ptr::NonNull;

/// A received message, still in shared memory. Wrapped in an `Arc` it goes to any
/// number of threads; the memory goes back to its publisher with the last one.
#[derive(Debug)]
pub struct SharedFrame<T: Topic> {
    sample: Sample<Service, [T::Item], T::Header>,
    /// What `sample.payload()` gives, which takes the subscriber's lock each time.
    items: NonNull<[T::Item]>,
    location: SegmentLocation,
}

// SAFETY: `Sample` is Send, and `items` points into the memory that it holds, in
// which every thread may read.
unsafe impl<T: Topic> Send for SharedFrame<T> {}

// SAFETY: `Sample` is not Sync only because nothing promises that its methods may
// run at the same time. Through a shared reference we call nothing but
// `user_header`, which reads a pointer fixed at construction, and read `items`:
// both are plain data that no writer touches while the sample is held. What
// changes state, returning the sample, needs ownership.
unsafe impl<T: Topic> Sync for SharedFrame<T> {}

impl<T: Topic> SharedFrame<T> {
    pub(crate) fn new(
        sample: Sample<Service, [T::Item], T::Header>,
        segments: &mut SegmentMap,
    ) -> Self {
        let items = NonNull::from(sample.payload());
        let location = segments.locate(items.addr().get());
        Self {
            sample,
            items,
            location,
        }
    }

    /// The header.
    #[inline]
    pub fn header(&self) -> &T::Header {
        self.sample.user_header()
    }

    /// The items, in shared memory.
    #[inline]
    pub fn items(&self) -> &[T::Item] {
        // SAFETY: the pointer comes from a reference to the sample's payload, which
        // stays mapped and unwritten while the sample is held, and `self` holds it.
        unsafe { self.items.as_ref() }
    }

    /// Where the items lie in shared memory, as this process sees it.
    pub fn location(&self) -> SegmentLocation {
        self.location
    }
}
