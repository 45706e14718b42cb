//! Tombstone records: identity of a purged view and the time at which it was forgotten, at most 48
//! bytes with what the database adds.
//!
//! The requester of the forgetting is recorded in the history only.

use durable_leveldb::record::{seal, unseal};

use crate::digest::Digest;
use crate::keys;
use crate::set_digest::record_digest;

/// Serialised tombstone of a view forgotten at a time, nanoseconds since 1970, UTC.
pub(crate) fn seal_tombstone(identity: Digest, forgotten_ns: u64) -> Vec<u8> {
    seal(&keys::digest_key(keys::TOMBSTONE, identity), &forgotten_ns)
}

/// Time in the tombstone under `key`.
pub(crate) fn unseal_tombstone(key: &[u8], record: &[u8]) -> Result<u64, &'static str> {
    unseal(key, record)
}

/// Digest of a tombstone for the [set digest](crate::set_digest) of the index.
pub(crate) fn digest(identity: Digest, forgotten_ns: u64) -> Digest {
    let key = keys::digest_key(keys::TOMBSTONE, identity);
    record_digest(&key, &seal_tombstone(identity, forgotten_ns))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bytes that a table of LevelDB adds to a record: three lengths, and sequence number and kind.
    const TABLE_BYTES: usize = 3 + 8;

    #[test]
    fn tombstone_has_at_most_48_bytes_on_disk() {
        for forgotten_ns in [0, 1_700_000_000_000_000_000, u64::MAX] {
            let identity = Digest(u128::MAX);
            let key = keys::digest_key(keys::TOMBSTONE, identity);
            let record = seal_tombstone(identity, forgotten_ns);
            assert!(key.len() + record.len() + TABLE_BYTES <= 48);
            assert_eq!(unseal_tombstone(&key, &record), Ok(forgotten_ns));
        }
    }
}
