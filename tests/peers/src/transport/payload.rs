//! Test payload and, for systems without a header of their own, the header before it.

use crate::clock;
use bytemuck::{Pod, Zeroable};

/// Stride of the bytes that the receiver touches: one memory page.
const PAGE_BYTES: usize = 4_096;
/// Size of a point, bytes.
const POINT_BYTES: usize = crate::benchmark_case::POINT_BYTES;

/// Message header with the size of a frame header in shared memory.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct MessageHeader {
    /// Sequence number of the message, from 0.
    pub number: u64,
    /// Monotonic time of sending, nanoseconds.
    pub sent_ns: u64,
    /// Size of the payload that follows, bytes.
    pub payload_bytes: u64,
    reserved: [[u64; 15]; 3],
}

const _: () = assert!(size_of::<MessageHeader>() == size_of::<message::FrameHeader>());

impl MessageHeader {
    /// Header without a time stamp.
    pub fn new(number: u64, payload_bytes: usize) -> Self {
        Self {
            number,
            payload_bytes: payload_bytes as u64,
            ..Self::zeroed()
        }
    }
}

/// Payload generator that records the processor time of each payload.
#[derive(Debug, Default)]
pub struct PayloadWriter {
    cpu_ns: Vec<u64>,
}

impl PayloadWriter {
    /// Writes every byte of a payload, as points that depend on the message's number.
    pub fn write(&mut self, number: u64, payload: &mut [u8]) {
        let begin_ns = clock::thread_ns();
        let point: [u8; POINT_BYTES] =
            std::array::from_fn(|i| (number as u8).wrapping_add(i as u8));
        let (points, _) = payload.as_chunks_mut();
        points.fill(std::hint::black_box(point));
        self.cpu_ns.push(clock::thread_ns() - begin_ns);
    }

    /// Processor times of all payloads but the first `n_first`, nanoseconds.
    pub fn into_cpu_ns_after(mut self, n_first: u64) -> Vec<u64> {
        self.cpu_ns.split_off(n_first as usize)
    }
}

/// Reads the first byte of each page of a payload.
///
/// # Panics
/// If it is not the payload of message `number`.
pub fn touch(number: u64, payload: &[u8]) {
    let mut bytes = payload.iter().step_by(PAGE_BYTES);
    assert!(bytes.all(|&byte| byte == number as u8), "another payload");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn payload_of_another_message_is_detected() {
        let mut payload = vec![0; 3 * PAGE_BYTES];
        let mut writer = PayloadWriter::default();
        writer.write(6, &mut payload);
        writer.write(7, &mut payload);
        touch(7, &payload);
        assert!(std::panic::catch_unwind(|| touch(8, &payload)).is_err());
        payload[2 * PAGE_BYTES] = 0;
        assert!(std::panic::catch_unwind(|| touch(7, &payload)).is_err());
        assert_eq!(writer.into_cpu_ns_after(1).len(), 1);
    }
}
