//! Counting the messages of a port, so that a receiver sees what it lost.

use crate::{
    ArmState, FrameHeader, ObjectCloudHeader, ObjectViewHeader, PersonBody, SceneSummary,
    TraceHeader, TruthHeader,
};
use bytemuck::AnyBitPattern;
use iceoryx2::prelude::ZeroCopySend;

/// A header that counts the messages of its port from 1.
///
/// In a long header the number stands in front, beside the stamps: a receiver that
/// reads it has the cache line with both, each of which takes 0.1 µs from another core.
pub trait Counted {
    /// The number of this message.
    fn sent(&self) -> u64;
    /// Writes the number.
    fn set_sent(&mut self, sent: u64);
}

/// The header of messages that need no other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.PlainHeader.v1")]
#[repr(C)]
pub struct PlainHeader {
    /// Counts the messages of the port.
    pub sent: u64,
}

const _: () = assert!(size_of::<PlainHeader>() == 8);

macro_rules! counted {
    ($($header:ty),*) => {$(
        impl Counted for $header {
            fn sent(&self) -> u64 {
                self.sent
            }
            fn set_sent(&mut self, sent: u64) {
                self.sent = sent;
            }
        }
    )*};
}

counted!(
    PlainHeader,
    FrameHeader,
    SceneSummary,
    ObjectViewHeader,
    ObjectCloudHeader,
    ArmState,
    PersonBody,
    TraceHeader,
    TruthHeader
);
