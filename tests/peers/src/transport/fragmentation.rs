//! A long message in datagrams, as RTPS sends one (`DATA_FRAG`): a header with the
//! message's number, its length and the fragment's number, then its bytes.

use bytemuck::{Pod, Zeroable};

/// The largest datagram, that of UDP nearly.
pub const DATAGRAM_BYTES: usize = 65_500;
const BODY_BYTES: usize = DATAGRAM_BYTES - size_of::<Head>();

#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Head {
    /// Of the message.
    pub number: u64,
    pub message_bytes: u32,
    /// Counts the fragments of the message from 0.
    pub fragment: u32,
}

/// Head and body of each fragment; an empty message has one.
pub fn fragments(number: u64, message: &[u8]) -> impl Iterator<Item = (Head, &[u8])> {
    let n_fragments = message.len().div_ceil(BODY_BYTES).max(1);
    (0..n_fragments).map(move |fragment| {
        let begin = fragment * BODY_BYTES;
        let end = message.len().min(begin + BODY_BYTES);
        let head = Head {
            number,
            message_bytes: message.len() as u32,
            fragment: fragment as u32,
        };
        (head, &message[begin..end])
    })
}

/// Puts messages together again. Its memory is used again for the next message.
#[derive(Debug, Default)]
pub struct Assembly {
    number: Option<u64>,
    bytes: Vec<u8>,
    is_there: Vec<bool>,
    n_missing: usize,
}

impl Assembly {
    /// Takes a datagram; the whole message with the last one of it. What does not
    /// fit is left out; a message that is not whole when the next begins is lost.
    pub fn take(&mut self, datagram: &[u8]) -> Option<(u64, &[u8])> {
        let (head, body) = datagram.split_at_checked(size_of::<Head>())?;
        let head: Head = bytemuck::pod_read_unaligned(head);
        if self.number != Some(head.number) {
            self.begin(head);
        }
        let begin = head.fragment as usize * BODY_BYTES;
        let is_there = self.is_there.get_mut(head.fragment as usize)?;
        let expected = BODY_BYTES.min(self.bytes.len() - begin);
        if *is_there || body.len() != expected {
            return None;
        }
        self.bytes[begin..][..expected].copy_from_slice(body);
        *is_there = true;
        self.n_missing -= 1;
        (self.n_missing == 0).then_some((head.number, &self.bytes[..]))
    }

    fn begin(&mut self, head: Head) {
        let n_bytes = head.message_bytes as usize;
        self.number = Some(head.number);
        self.bytes.resize(n_bytes, 0);
        self.n_missing = n_bytes.div_ceil(BODY_BYTES).max(1);
        self.is_there.clear();
        self.is_there.resize(self.n_missing, false);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(n_bytes: usize) -> Vec<u8> {
        (0..n_bytes).map(|i| (i % 251) as u8).collect()
    }

    fn datagrams(number: u64, message: &[u8]) -> Vec<Vec<u8>> {
        let datagram = |(head, body): (Head, &[u8])| [bytemuck::bytes_of(&head), body].concat();
        fragments(number, message).map(datagram).collect()
    }

    #[test]
    fn a_message_is_whole_with_its_last_fragment_in_any_order() {
        let mut assembly = Assembly::default();
        let sizes = [0, 1, BODY_BYTES, BODY_BYTES + 1, 10 * BODY_BYTES - 1];
        for (number, n_bytes) in (7..).zip(sizes) {
            let message = message(n_bytes);
            let mut datagrams = datagrams(number, &message);
            assert!(datagrams.iter().all(|d| d.len() <= DATAGRAM_BYTES));
            datagrams.reverse();
            let last = datagrams.pop().unwrap();
            for datagram in &datagrams {
                assert_eq!(assembly.take(datagram), None);
            }
            assert_eq!(assembly.take(&last), Some((number, &message[..])));
        }
    }

    #[test]
    fn a_message_with_a_gap_is_lost_and_the_next_one_is_not() {
        let mut assembly = Assembly::default();
        let message = message(3 * BODY_BYTES);
        for datagram in &datagrams(1, &message)[1..] {
            assert_eq!(assembly.take(datagram), None);
        }
        let datagrams = datagrams(2, &message);
        assert_eq!(assembly.take(&datagrams[0]), None);
        assert_eq!(assembly.take(&datagrams[1]), None);
        assert_eq!(assembly.take(&datagrams[2]), Some((2, &message[..])));
    }

    #[test]
    fn what_does_not_fit_is_left_out() {
        let mut assembly = Assembly::default();
        let message = message(2 * BODY_BYTES);
        let datagrams = datagrams(1, &message);
        let cut = &datagrams[0][..datagrams[0].len() - 1];
        for odd in [&[][..], &[1, 2, 3], cut] {
            assert_eq!(assembly.take(odd), None);
        }
        assert_eq!(assembly.take(&datagrams[0]), None);
        assert_eq!(assembly.take(&datagrams[0]), None, "twice");
        assert!(assembly.take(&datagrams[1]).is_some());
    }
}
