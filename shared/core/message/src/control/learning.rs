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
    /// The object's points in the frame of the box, as [`pack_cloud`] packs them;
    /// empty when they are not kept.
    ///
    /// [`pack_cloud`]: super::pack_cloud
    #[serde(default, with = "serde_bytes")]
    pub points: Vec<u8>,
    /// Mean red, green, blue of the points, where they have colours.
    #[serde(default)]
    pub mean_rgb: Option<[u8; 3]>,
}

/// Longest encoding of a view without its texts, descriptor and points, bytes: names,
/// numbers and lengths.
const MAX_FIXED_BYTES: usize = 512;

impl StoredView {
    /// Most that the views of one request may have by [`max_encoded_bytes`]: all of a
    /// message but 1 KiB for the request around them.
    ///
    /// [`max_encoded_bytes`]: Self::max_encoded_bytes
    pub const MAX_REQUEST_BYTES: usize = super::MAX_MESSAGE_BYTES - 1024;

    /// No fewer bytes than the view has in a request.
    pub fn max_encoded_bytes(&self) -> usize {
        MAX_FIXED_BYTES
            + self.descriptor_kind.len()
            + self.descriptor.len()
            + self.source_name.len()
            + self.points.len()
    }
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
    pub next: Option<SnapshotCursor>,
}

/// Where a page of labelled views begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct SnapshotCursor(#[serde(with = "hex_id")] pub u128);

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
    use super::super::{Command, MAX_CLOUD_POINTS, MAX_MESSAGE_BYTES, Request, pack_cloud};
    use super::*;
    use geometry::RigidTransform;
    use point_cloud::Point;
    use serde::de::IntoDeserializer;
    use serde::de::value::{Error, StrDeserializer};

    /// A view whose numbers take as many bytes as numbers can.
    fn longest_view(n_points: usize) -> StoredView {
        let cloud = vec![Point::default(); n_points];
        StoredView {
            id: ViewId {
                track_id: u64::MAX,
                view_id: u32::MAX,
            },
            descriptor_kind: "shape and colour".into(),
            descriptor: vec![255; 309 * 4],
            position_m: [0.1; 3],
            orientation_xyzw: [0.1; 4],
            size_m: [0.1; 3],
            captured_ns: i64::MIN,
            frame_sequence: u64::MAX,
            source_name: "s".repeat(300),
            points: pack_cloud(cloud.iter(), &RigidTransform::identity()),
            mean_rgb: Some([255; 3]),
        }
    }

    fn encoded<T: Serialize>(value: &T) -> Vec<u8> {
        let mut bytes = Vec::new();
        ciborium::into_writer(value, &mut bytes).unwrap();
        bytes
    }

    #[test]
    fn a_view_is_no_longer_than_it_says_and_survives() {
        for n_points in [0, 1, 1000, MAX_CLOUD_POINTS] {
            let view = longest_view(n_points);
            let bytes = encoded(&view);
            assert!(bytes.len() <= view.max_encoded_bytes(), "{n_points}");
            let read: StoredView = ciborium::from_reader(bytes.as_slice()).unwrap();
            assert_eq!(read, view);
        }
    }

    #[test]
    fn a_request_of_as_many_views_as_are_allowed_is_a_message() {
        for n_points in [0, 10, 1000, MAX_CLOUD_POINTS] {
            let view = longest_view(n_points);
            let n_views = StoredView::MAX_REQUEST_BYTES / view.max_encoded_bytes();
            assert!(n_views > 0, "{n_points}");
            let command = Command::StoreViews {
                id: MutationId(u128::MAX),
                views: vec![view; n_views],
            };
            let n_bytes = encoded(&Request::from(command)).len();
            assert!(n_bytes <= MAX_MESSAGE_BYTES, "{n_points}: {n_bytes}");
        }
    }

    /// Programs that were written before views had points send none.
    #[test]
    fn a_view_needs_neither_points_nor_colour() {
        #[derive(Serialize)]
        struct Sent {
            id: ViewId,
            descriptor_kind: &'static str,
            descriptor: serde_bytes::ByteBuf,
            position_m: [f64; 3],
            orientation_xyzw: [f64; 4],
            size_m: [f64; 3],
            captured_ns: i64,
            frame_sequence: u64,
            source_name: &'static str,
        }
        let sent = Sent {
            id: ViewId {
                track_id: 1,
                view_id: 0,
            },
            descriptor_kind: "good",
            descriptor: serde_bytes::ByteBuf::from([0; 4]),
            position_m: [0.0; 3],
            orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
            size_m: [0.1; 3],
            captured_ns: 0,
            frame_sequence: 0,
            source_name: "",
        };
        let view: StoredView = ciborium::from_reader(encoded(&sent).as_slice()).unwrap();
        assert_eq!((view.points, view.mean_rgb), (vec![], None));
    }

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
