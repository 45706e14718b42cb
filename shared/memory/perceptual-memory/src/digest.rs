//! Content digest: the first 128 bits of BLAKE3.

use std::fmt;

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_bytes::ByteArray;

/// 128-bit content digest. Equal content has equal digests, and collisions cannot be found in
/// practice (BLAKE3: O'Connor, Aumasson, Neves and Wilcox-O'Hearn 2020).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Digest(pub u128);

impl Digest {
    /// Computes the digest of `bytes`.
    pub fn of(bytes: &[u8]) -> Self {
        Hasher::new(b"").update(bytes).finish()
    }
}

impl fmt::Display for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:032x}", self.0)
    }
}

impl Serialize for Digest {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        ByteArray::new(self.0.to_be_bytes()).serialize(to)
    }
}

impl<'de> Deserialize<'de> for Digest {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let bytes = ByteArray::<16>::deserialize(from)?;
        Ok(Self(u128::from_be_bytes(bytes.into_array())))
    }
}

/// Incremental hasher for digests of several parts.
pub(crate) struct Hasher(blake3::Hasher);

impl Hasher {
    /// Hasher with a purpose as domain separation.
    pub(crate) fn new(purpose: &[u8]) -> Self {
        let mut hasher = blake3::Hasher::new();
        hasher.update(purpose);
        Self(hasher)
    }

    pub(crate) fn update(mut self, bytes: &[u8]) -> Self {
        self.0.update(bytes);
        self
    }

    /// Appends a part to the hashed content in place.
    pub(crate) fn add(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }

    /// Appends a text with its length as prefix, so that different lists of parts never hash the
    /// same bytes.
    pub(crate) fn update_text(self, text: &str) -> Self {
        self.update(&(text.len() as u64).to_le_bytes())
            .update(text.as_bytes())
    }

    pub(crate) fn finish(&self) -> Digest {
        let hash = self.0.finalize();
        let first = hash.as_bytes().first_chunk().copied();
        Digest(u128::from_be_bytes(first.unwrap_or_default()))
    }
}
