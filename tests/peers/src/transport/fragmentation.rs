//! Message fragmentation into datagrams and reassembly, like `DATA_FRAG` of RTPS.
//!
//! A datagram is a header with message number, message length and fragment number, then the bytes.

use bytemuck::{Pod, Zeroable};

/// Maximum size of a datagram, bytes; close to the limit of UDP.
pub const DATAGRAM_BYTES: usize = 65_500;
/// Maximum size of a fragment without its header, bytes.
const BODY_BYTES: usize = DATAGRAM_BYTES - size_of::<FragmentHeader>();

/// Header of a fragment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct FragmentHeader {
    /// Number of the message.
    pub number: u64,
    /// Length of the message, bytes.
    pub message_bytes: u32,
    /// Index of the fragment in its message, from 0.
    pub fragment: u32,
}

/// Header and body of each fragment; an empty message has one fragment.
pub fn fragments(number: u64, message: &[u8]) -> impl Iterator<Item = (FragmentHeader, &[u8])> {
    let n_fragments = message.len().div_ceil(BODY_BYTES).max(1);
    (0..n_fragments).map(move |fragment| {
        let begin = fragment * BODY_BYTES;
        let end = message.len().min(begin + BODY_BYTES);
        let head = FragmentHeader {
            number,
            message_bytes: message.len() as u32,
            fragment: fragment as u32,
        };
        (head, &message[begin..end])
    })
}

/// Reassembler of one message at a time, which reuses its buffer.
#[derive(Debug, Default)]
pub struct Reassembler {
    number: Option<u64>,
    bytes: Vec<u8>,
    is_received: Vec<bool>,
    n_missing: usize,
}

impl Reassembler {
    /// Adds a datagram; returns number and bytes of the message once it is complete.
    ///
    /// Ignores malformed and duplicate fragments. A message that is incomplete when the next one
    /// begins is lost.
    pub fn take(&mut self, datagram: &[u8]) -> Option<(u64, &[u8])> {
        let (head, body) = datagram.split_at_checked(size_of::<FragmentHeader>())?;
        let head: FragmentHeader = bytemuck::pod_read_unaligned(head);
        if self.number != Some(head.number) {
            self.begin(head);
        }
        let begin = head.fragment as usize * BODY_BYTES;
        let is_received = self.is_received.get_mut(head.fragment as usize)?;
        let expected = BODY_BYTES.min(self.bytes.len() - begin);
        if *is_received || body.len() != expected {
            return None;
        }
        self.bytes[begin..][..expected].copy_from_slice(body);
        *is_received = true;
        self.n_missing -= 1;
        (self.n_missing == 0).then_some((head.number, &self.bytes[..]))
    }

    /// Prepares the buffer for a new message.
    fn begin(&mut self, head: FragmentHeader) {
        let n_bytes = head.message_bytes as usize;
        self.number = Some(head.number);
        self.bytes.resize(n_bytes, 0);
        self.n_missing = n_bytes.div_ceil(BODY_BYTES).max(1);
        self.is_received.clear();
        self.is_received.resize(self.n_missing, false);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(n_bytes: usize) -> Vec<u8> {
        (0..n_bytes).map(|i| (i % 251) as u8).collect()
    }

    fn datagrams(number: u64, message: &[u8]) -> Vec<Vec<u8>> {
        let datagram =
            |(head, body): (FragmentHeader, &[u8])| [bytemuck::bytes_of(&head), body].concat();
        fragments(number, message).map(datagram).collect()
    }

    #[test]
    fn message_is_complete_with_its_last_fragment_in_any_order() {
        let mut reassembler = Reassembler::default();
        let sizes = [0, 1, BODY_BYTES, BODY_BYTES + 1, 10 * BODY_BYTES - 1];
        for (number, n_bytes) in (7..).zip(sizes) {
            let message = message(n_bytes);
            let mut datagrams = datagrams(number, &message);
            assert!(datagrams.iter().all(|d| d.len() <= DATAGRAM_BYTES));
            datagrams.reverse();
            let last = datagrams.pop().unwrap();
            for datagram in &datagrams {
                assert_eq!(reassembler.take(datagram), None);
            }
            assert_eq!(reassembler.take(&last), Some((number, &message[..])));
        }
    }

    #[test]
    fn incomplete_message_is_dropped_when_the_next_one_begins() {
        let mut reassembler = Reassembler::default();
        let message = message(3 * BODY_BYTES);
        for datagram in &datagrams(1, &message)[1..] {
            assert_eq!(reassembler.take(datagram), None);
        }
        let datagrams = datagrams(2, &message);
        assert_eq!(reassembler.take(&datagrams[0]), None);
        assert_eq!(reassembler.take(&datagrams[1]), None);
        assert_eq!(reassembler.take(&datagrams[2]), Some((2, &message[..])));
    }

    #[test]
    fn malformed_and_duplicate_fragments_are_ignored() {
        let mut reassembler = Reassembler::default();
        let message = message(2 * BODY_BYTES);
        let datagrams = datagrams(1, &message);
        let cut = &datagrams[0][..datagrams[0].len() - 1];
        for odd in [&[][..], &[1, 2, 3], cut] {
            assert_eq!(reassembler.take(odd), None);
        }
        assert_eq!(reassembler.take(&datagrams[0]), None);
        assert_eq!(reassembler.take(&datagrams[0]), None, "twice");
        assert!(reassembler.take(&datagrams[1]).is_some());
    }
}
