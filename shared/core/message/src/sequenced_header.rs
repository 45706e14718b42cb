//! Message numbers of a port, by which a receiver detects loss.

use crate::{
    ArmState, FrameHeader, ImageHeader, ObjectCloudHeader, ObjectViewHeader, PersonBody,
    SceneSummary, TraceHeader, TruthHeader, ViewPlanHeader,
};
use bytemuck::AnyBitPattern;
use iceoryx2::prelude::ZeroCopySend;

/// Header with a message number, counted per port from 1.
///
/// In a long header the number precedes the other fields, next to the time stamps: a receiver
/// that reads it has the cache line with both, each of which takes 0.1 µs from another core.
pub trait SequencedHeader {
    /// Number of this message, counted per port.
    fn sent(&self) -> u64;
    /// Sets the number of this message, counted per port.
    fn set_sent(&mut self, sent: u64);
}

/// Header of messages without other header fields.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.PlainHeader.v1")]
#[repr(C)]
pub struct PlainHeader {
    /// Message number of the port, from 1.
    pub sent: u64,
}

const _: () = assert!(size_of::<PlainHeader>() == 8);

macro_rules! counted {
    ($($header:ty),*) => {$(
        impl SequencedHeader for $header {
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
    ImageHeader,
    SceneSummary,
    ObjectViewHeader,
    ObjectCloudHeader,
    ArmState,
    PersonBody,
    TraceHeader,
    TruthHeader,
    ViewPlanHeader
);
