//! Views and changes of what was learned, between perception and memory.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Identity of a mutation, 128 random bits made by the client: a retry after a
/// crash is answered, not done twice. Serialised as 32 hexadecimal digits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct MutationId(#[serde(with = "hex_id")] pub u128);

impl fmt::Display for MutationId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:032x}", self.0)
    }
}

/// Identity of a stored view.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct ViewId {
    /// The track.
    pub track_id: u64,
    /// The view of the track.
    pub view_id: u32,
}

/// A key view on its way to the memory.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StoredView {
    /// Identity.
    pub id: ViewId,
    /// How the descriptor was made; only equal kinds compare.
    pub descriptor_kind: String,
    /// The descriptor: `f32`, little-endian.
    #[serde(with = "serde_bytes")]
    pub descriptor: Vec<u8>,
    /// Centre of the box in the world, metres.
    pub position_m: [f64; 3],
    /// Orientation of the box in the world.
    pub orientation_xyzw: [f64; 4],
    /// Full lengths of the box's sides, metres.
    pub size_m: [f64; 3],
    /// Capture time, wall clock, nanoseconds since 1970.
    pub captured_ns: i64,
    /// Sequence of the frame.
    pub frame_sequence: u64,
    /// Name of the source or file of the frame.
    pub source_name: String,
}

/// A view and the category it was taught as.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LearnedView {
    /// Identity.
    pub id: ViewId,
    /// The category.
    pub category: String,
    /// How the descriptor was made.
    pub descriptor_kind: String,
    /// The descriptor: `f32`, little-endian.
    #[serde(with = "serde_bytes")]
    pub descriptor: Vec<u8>,
}

/// One change of one view; applying it twice changes nothing more.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LearnedChange {
    /// The view now belongs to a category.
    Assigned(LearnedView),
    /// The view belongs to no category.
    Unassigned(ViewId),
}

/// A page of labelled views. The reader notes the sequence of the first page,
/// reads all pages, then applies the changes since that sequence.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SnapshotPage {
    /// Identity of the store.
    #[serde(with = "hex_id")]
    pub store_id: u128,
    /// Newest history sequence when the page was made.
    pub sequence: u64,
    /// The views.
    pub views: Vec<LearnedView>,
    /// Where the next page begins; `None` after the last one.
    pub next: Option<ViewId>,
}

/// Changes in the order they were made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ChangesPage {
    /// The changes up to a sequence; ask again from there while `more`.
    Changes {
        /// The reader holds this sequence when it has applied the changes.
        up_to: u64,
        /// The changes.
        changes: Vec<LearnedChange>,
        /// Whether there are more.
        more: bool,
    },
    /// Another store or a gap: begin with a snapshot again.
    Reload,
}

/// 128-bit identities as 32 hexadecimal digits.
pub(super) mod hex_id {
    use serde::{Deserialize, Deserializer, Serializer, de::Error};

    pub(in super::super) fn serialize<S: Serializer>(id: &u128, to: S) -> Result<S::Ok, S::Error> {
        to.collect_str(&format_args!("{id:032x}"))
    }

    pub(in super::super) fn deserialize<'de, D: Deserializer<'de>>(
        from: D,
    ) -> Result<u128, D::Error> {
        let digits = String::deserialize(from)?;
        if digits.len() != 32 {
            return Err(D::Error::custom(
                "an identity must have 32 hexadecimal digits",
            ));
        }
        u128::from_str_radix(&digits, 16).map_err(D::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::de::IntoDeserializer;
    use serde::de::value::{Error, StrDeserializer};

    #[test]
    fn identities_are_32_hexadecimal_digits() {
        let check = |text: &'static str| {
            let from: StrDeserializer<'_, Error> = text.into_deserializer();
            hex_id::deserialize(from).ok()
        };
        assert_eq!(check("000000000000000000000000000000ff"), Some(255));
        assert_eq!(
            MutationId(255).to_string(),
            "000000000000000000000000000000ff"
        );
        assert_eq!(check("ff"), None);
        assert_eq!(check("zz0000000000000000000000000000ff"), None);
    }
}
