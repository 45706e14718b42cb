//! Received message in shared memory, readable by many threads.
#![expect(unsafe_code, reason = "implements Send and Sync for a received sample")]

use crate::domain::Service;
use crate::segment_map::SegmentMap;
use crate::topic::Topic;
use iceoryx2::sample::Sample;
use message::SegmentLocation;
use std::ptr::NonNull;
use std::sync::Arc;

/// Received message, still in shared memory. Wrapped in an `Arc` it can be read by
/// any number of threads; the last one returns the memory to the publisher.
#[derive(Debug)]
pub struct SharedMessage<T: Topic> {
    /// Keeps the message from being overwritten.
    _sample: Sample<Service, [T::Item], T::Header>,
    /// Copied once out of shared memory: what is checked is what is used.
    header: T::Header,
    /// Result of `sample.payload()`, which takes the subscriber's lock at each call.
    items: NonNull<[T::Item]>,
    location: SegmentLocation,
    /// Counts the messages that a guest holds.
    _held: Option<Arc<()>>,
}

// SAFETY: `Sample` is Send, and `items` points into the memory that it holds, which
// every thread may read.
unsafe impl<T: Topic> Send for SharedMessage<T> {}

// SAFETY: `Sample` is not Sync only because it does not promise that its methods may
// run at the same time. Through a shared reference none of them is called: `header` is
// an own copy, and `items` is plain data that no writer touches while the sample is
// held. Returning the sample changes state and needs ownership.
unsafe impl<T: Topic> Sync for SharedMessage<T> {}

impl<T: Topic> SharedMessage<T> {
    pub(crate) fn new(
        sample: Sample<Service, [T::Item], T::Header>,
        segments: &mut SegmentMap,
        held: Option<Arc<()>>,
    ) -> Self {
        let header = *sample.user_header();
        let items = NonNull::from(sample.payload());
        let location = segments.locate(items.addr().get());
        Self {
            _sample: sample,
            header,
            items,
            location,
            _held: held,
        }
    }

    /// Header of the message, a copy of that in shared memory.
    #[inline]
    pub fn header(&self) -> &T::Header {
        &self.header
    }

    /// Items of the message, in shared memory.
    #[inline]
    pub fn items(&self) -> &[T::Item] {
        // SAFETY: the pointer comes from a reference to the sample's payload, which
        // stays mapped and unwritten while the sample is held, and `self` holds it.
        unsafe { self.items.as_ref() }
    }

    /// Location of the items in shared memory, in this process's mapping.
    pub fn location(&self) -> SegmentLocation {
        self.location
    }
}
