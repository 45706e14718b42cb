//! The payload's bytes and the header before them, where there is no header of
//! the system's own.

use crate::clock;
use bytemuck::{Pod, Zeroable};

/// So far apart the receiver reads one byte.
const PAGE_BYTES: usize = 4_096;
const POINT_BYTES: usize = crate::plan::POINT_BYTES;

/// As large as a frame's header in shared memory.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct Header {
    pub number: u64,
    pub sent_ns: u64,
    /// Of what follows.
    pub payload_bytes: u64,
    reserved: [[u64; 15]; 3],
}

const _: () = assert!(size_of::<Header>() == size_of::<message::FrameHeader>());

impl Header {
    pub fn new(number: u64, payload_bytes: usize) -> Self {
        Self {
            number,
            payload_bytes: payload_bytes as u64,
            ..Self::zeroed()
        }
    }
}

/// Writes payloads and remembers what that took.
#[derive(Debug, Default)]
pub struct Fill {
    cpu_ns: Vec<u64>,
}

impl Fill {
    /// Writes each byte, points that tell the message's number, as a camera does.
    pub fn write(&mut self, number: u64, payload: &mut [u8]) {
        let begin_ns = clock::thread_ns();
        let point: [u8; POINT_BYTES] =
            std::array::from_fn(|i| (number as u8).wrapping_add(i as u8));
        let (points, _) = payload.as_chunks_mut();
        points.fill(std::hint::black_box(point));
        self.cpu_ns.push(clock::thread_ns() - begin_ns);
    }

    /// Processor time of each writing but the first ones.
    pub fn without(mut self, n_first: u64) -> Vec<u64> {
        self.cpu_ns.split_off(n_first as usize)
    }
}

/// Reads the first byte of each page.
///
/// # Panics
/// When this is not the payload of that message.
pub fn touch(number: u64, payload: &[u8]) {
    let mut bytes = payload.iter().step_by(PAGE_BYTES);
    assert!(bytes.all(|&byte| byte == number as u8), "another payload");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_payload_is_known_by_its_number() {
        let mut payload = vec![0; 3 * PAGE_BYTES];
        let mut fill = Fill::default();
        fill.write(6, &mut payload);
        fill.write(7, &mut payload);
        touch(7, &payload);
        assert!(std::panic::catch_unwind(|| touch(8, &payload)).is_err());
        payload[2 * PAGE_BYTES] = 0;
        assert!(std::panic::catch_unwind(|| touch(7, &payload)).is_err());
        assert_eq!(fill.without(1).len(), 1);
    }
}
