//! Synchronisation of learned views between perception and memory.

use crate::DescriptorBytes;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Idempotency key of a mutation, 128 random bits chosen by the client: a retry after a crash
/// is answered, not executed twice. Serialised as 32 hexadecimal digits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct MutationId(#[serde(with = "hex_id")] pub u128);

/// Error of a random id: the operating system gives no random numbers.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("this machine gives no random numbers: {0}")]
pub struct RandomIdError(String);

impl MutationId {
    /// Random id, unique for all practical purposes.
    ///
    /// # Errors
    /// When the operating system gives no random numbers.
    pub fn random() -> Result<Self, RandomIdError> {
        let mut bytes = [0; 16];
        match getrandom::fill(&mut bytes) {
            Ok(()) => Ok(Self(u128::from_le_bytes(bytes))),
            Err(error) => Err(RandomIdError(error.to_string())),
        }
    }
}

impl fmt::Display for MutationId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:032x}", self.0)
    }
}

/// Identity of a stored view.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct ViewId {
    /// Track-id of the object that the view shows.
    pub track_id: u64,
    /// Number of the view within its track.
    pub view_id: u32,
}

/// Key view to be stored in the perceptual memory.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StoredView {
    /// Identity of the view.
    pub id: ViewId,
    /// Kind of the descriptor: its method and version. Only equal kinds can be compared.
    pub descriptor_kind: String,
    /// Descriptor of the view.
    pub descriptor: DescriptorBytes,
    /// Centre of the box in the world, metres.
    pub position_m: [f64; 3],
    /// Orientation of the box in the world, quaternion: x, y, z, w.
    pub orientation_xyzw: [f64; 4],
    /// Side lengths of the object's box, metres.
    pub size_m: [f64; 3],
    /// Capture time, wall clock, nanoseconds since 1970.
    pub captured_ns: i64,
    /// Sequence number of the captured frame.
    pub frame_sequence: u64,
    /// Name of the camera or recording of the frame.
    pub source_name: String,
    /// Points of the object in the frame of the box, encoded by [`pack_cloud`]; empty when not
    /// kept.
    ///
    /// [`pack_cloud`]: crate::pack_cloud
    #[serde(default, with = "serde_bytes")]
    pub points: Vec<u8>,
    /// Mean colour of the points: red, green, blue; `None` for points without colours.
    #[serde(default)]
    pub mean_rgb: Option<[u8; 3]>,
}

/// Upper bound of the encoded size of a view without its texts, descriptor and points, bytes.
const MAX_FIXED_BYTES: usize = 512;

impl StoredView {
    /// Budget of the views of one request, summed by [`max_encoded_bytes`]: the maximum message
    /// size less 1 KiB for the envelope.
    ///
    /// [`max_encoded_bytes`]: Self::max_encoded_bytes
    pub const MAX_REQUEST_BYTES: usize = crate::MAX_MESSAGE_BYTES - 1024;

    /// Upper bound of the encoded size of this view in a request, bytes.
    pub fn max_encoded_bytes(&self) -> usize {
        MAX_FIXED_BYTES
            + self.descriptor_kind.len()
            + self.descriptor.len()
            + self.source_name.len()
            + self.points.len()
    }
}

/// Labelled view: a view with its category.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LearnedView {
    /// Identity of the labelled view.
    pub id: ViewId,
    /// Category name of the view.
    pub category: String,
    /// Kind of the descriptor: its method and version.
    pub descriptor_kind: String,
    /// Descriptor of the view.
    pub descriptor: DescriptorBytes,
}

/// Change of one view's label; idempotent.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LearnedChange {
    /// View assigned to a category.
    Assigned(LearnedView),
    /// View that has no category any more.
    Unassigned(ViewId),
}

/// Page of labelled views. A reader notes the sequence of the first page, reads all pages, then
/// applies the changes since that sequence.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SnapshotPage {
    /// Identity of the store that the page was read from.
    #[serde(with = "hex_id")]
    pub store_id: u128,
    /// Newest history sequence at the time of the page.
    pub sequence: u64,
    /// Labelled views of the page.
    pub views: Vec<LearnedView>,
    /// Cursor of the next page; `None` after the last page.
    pub next: Option<SnapshotCursor>,
}

/// Cursor into the labelled views.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct SnapshotCursor(#[serde(with = "hex_id")] pub u128);

/// Answer to a request for changes, in the order of the history.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ChangesPage {
    /// Changes up to a sequence; the next request starts there while `more` is true.
    Changes {
        /// Sequence that the reader holds after applying the changes.
        up_to: u64,
        /// Label changes in the order of the history.
        changes: Vec<LearnedChange>,
        /// True if more changes follow this page.
        more: bool,
    },
    /// Changes unavailable, because of another store or a gap in the history: reload a snapshot.
    Reload,
}

/// Serde format of 128-bit identities: 32 hexadecimal digits.
pub(super) mod hex_id {
    use serde::{Deserialize, Deserializer, Serializer, de::Error};

    pub(crate) fn serialize<S: Serializer>(id: &u128, to: S) -> Result<S::Ok, S::Error> {
        to.collect_str(&format_args!("{id:032x}"))
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<u128, D::Error> {
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
    use crate::{Command, MAX_CLOUD_POINTS, MAX_MESSAGE_BYTES, Request, pack_cloud};
    use geometry::RigidTransform;
    use point_cloud::Point;
    use serde::de::IntoDeserializer;
    use serde::de::value::{Error, StrDeserializer};

    /// View of maximum encoded size.
    fn longest_view(n_points: usize) -> StoredView {
        let cloud = vec![Point::default(); n_points];
        StoredView {
            id: ViewId {
                track_id: u64::MAX,
                view_id: u32::MAX,
            },
            descriptor_kind: "shape and colour".into(),
            descriptor: vec![255; 309 * 4].into(),
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
    fn encoded_size_is_within_the_bound_and_views_survive() {
        for n_points in [0, 1, 1000, MAX_CLOUD_POINTS] {
            let view = longest_view(n_points);
            let bytes = encoded(&view);
            assert!(bytes.len() <= view.max_encoded_bytes(), "{n_points}");
            let read: StoredView = ciborium::from_reader(bytes.as_slice()).unwrap();
            assert_eq!(read, view);
        }
    }

    #[test]
    fn a_full_request_fits_into_a_message() {
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

    /// Backward compatibility: older programs send neither points nor colour.
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
