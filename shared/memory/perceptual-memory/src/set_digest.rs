//! Set digest: digest of a set of records that does not depend on their order and is updated as
//! records come and go.
//!
//! It is the sum of the digests of the records, modulo 2^128 (the additive hash of Bellare and
//! Micciancio 1997). It detects loss and change by accident; it does not withstand somebody who
//! chooses records on purpose, which the hash chain of the history does.

use crate::digest::{Digest, Hasher};

/// Digest of one record with its key, to be added to a [`SetDigest`].
pub(crate) fn record_digest(key: &[u8], record: &[u8]) -> Digest {
    // A key of a table has one length, or contains its length.
    Hasher::new(b"tabula record 3")
        .update(key)
        .update(record)
        .finish()
}

/// Digest of a set of records; zero for the empty set.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct SetDigest(u128);

impl SetDigest {
    /// Adds a record by its digest.
    pub(crate) fn add(&mut self, record: Digest) {
        self.0 = self.0.wrapping_add(record.0);
    }

    /// Removes a record that was added.
    pub(crate) fn remove(&mut self, record: Digest) {
        self.0 = self.0.wrapping_sub(record.0);
    }

    /// Present value.
    pub(crate) fn value(self) -> Digest {
        Digest(self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn set_digest_depends_on_the_records_only(
            kept in prop::collection::vec(any::<u128>(), 1..20),
            gone in prop::collection::vec(any::<u128>(), 0..20),
        ) {
            let of = |records: &[u128]| {
                let mut digest = SetDigest::default();
                for record in records {
                    digest.add(Digest(*record));
                }
                digest
            };
            let mut digest = of(&[gone.clone(), kept.clone()].concat());
            for record in &gone {
                digest.remove(Digest(*record));
            }
            let backwards: Vec<u128> = kept.iter().rev().copied().collect();
            let mut alone = of(&backwards);
            prop_assert_eq!(digest, alone);
            alone.remove(Digest(kept[0]));
            prop_assert_eq!(digest == alone, kept[0] == 0);
        }
    }
}
