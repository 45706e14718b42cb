//! Ground truth of simulated frames: objects and instance masks.

use crate::pose::WirePose;
use crate::{SCHEMA_VERSION, Text};
use bytemuck::{AnyBitPattern, Zeroable};
use iceoryx2::prelude::ZeroCopySend;

/// Maximum number of objects in a simulated scene.
pub const MAX_TRUE_OBJECTS: usize = 64;

/// Motion state of a simulated object, as a code in [`TrueObject::state`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TrueState {
    /// Object at rest.
    Settled = 1,
    /// Object in motion without being held.
    Moving = 2,
    /// Held by a person.
    HeldByPerson = 3,
    /// Held by the arm.
    HeldByArm = 4,
    /// Fallen off the table.
    OnFloor = 5,
}

impl TrueState {
    const ALL: [Self; 5] = [
        Self::Settled,
        Self::Moving,
        Self::HeldByPerson,
        Self::HeldByArm,
        Self::OnFloor,
    ];

    /// Wire code of the true state.
    pub fn code(self) -> u32 {
        self as u32
    }

    /// State of a wire code; `None` for an unknown code.
    pub fn from_code(code: u32) -> Option<Self> {
        Self::ALL.into_iter().find(|one| one.code() == code)
    }
}

/// Ground truth of one object of a simulated scene.
#[derive(Debug, Clone, Copy, PartialEq, Default, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.TrueObject.v1")]
#[repr(C)]
pub struct TrueObject {
    /// Id in the scene, from 1; pixel value in the mask.
    pub id: u32,
    /// True state: code of a [`TrueState`].
    pub state: u32,
    /// Pose; the origin is the centre of the model's bounding box.
    pub world_from_object: WirePose,
    /// Side lengths of the model's bounding box, metres.
    pub size_m: [f32; 3],
    /// Visible fraction: visible pixels over unoccluded pixels, 0 to 1.
    pub visible_fraction: f32,
    /// Number of visible pixels of the object.
    pub visible_px: u32,
    /// Number of pixels without occlusion by other objects.
    pub unoccluded_px: u32,
    /// Category name of the object.
    pub category: Text,
    /// Name of the object instance.
    pub name: Text,
}

const _: () = assert!(size_of::<TrueObject>() == 352);

/// Header of the ground truth of the frame with the same session and sequence. The payload is
/// the objects, or the mask: the object id of each pixel, row-major, 0 for background.
#[derive(Debug, Clone, Copy, PartialEq, Eq, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.TruthHeader.v1")]
#[repr(C)]
pub struct TruthHeader {
    /// [`SCHEMA_VERSION`] of the sending program.
    pub schema_version: u32,
    /// Padding for alignment, zero.
    pub reserved: u32,
    /// Session number of the frame source.
    pub session: u64,
    /// Sequence number of the frame.
    pub sequence: u64,
    /// Capture stamp of the frame, nanoseconds.
    pub capture_ns: u64,
    /// Message number of the port, from 1.
    pub sent: u64,
}

const _: () = assert!(size_of::<TruthHeader>() == 40);

impl Default for TruthHeader {
    fn default() -> Self {
        Self {
            schema_version: SCHEMA_VERSION,
            ..Self::zeroed()
        }
    }
}

/// Pixel of an instance mask: object id, 0 for background.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Default, bytemuck::Pod, bytemuck::Zeroable, ZeroCopySend,
)]
#[type_name("tabula.MaskPixel.v1")]
#[repr(C)]
pub struct MaskPixel(pub u16);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_state_has_its_number() {
        for state in TrueState::ALL {
            assert_eq!(TrueState::from_code(state.code()), Some(state));
        }
        assert_eq!(TrueState::from_code(99), None);
    }
}
