//! Ground truth of a simulated frame.

use crate::pose::WirePose;
use crate::{SCHEMA_VERSION, Text};
use bytemuck::AnyBitPattern;
use iceoryx2::prelude::ZeroCopySend;

/// Most objects of a simulated scene.
pub const MAX_TRUE_OBJECTS: usize = 64;

/// What an object of the simulation is doing, as a number in [`TrueObject::state`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TrueState {
    /// It lies still.
    Settled = 1,
    /// It moves by itself.
    Moving = 2,
    /// A person holds it.
    HeldByPerson = 3,
    /// The arm holds it.
    HeldByArm = 4,
    /// It has fallen off the table.
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

    /// The number on the wire.
    pub fn code(self) -> u32 {
        self as u32
    }

    /// The state of a number; `None` for any other number.
    pub fn from_code(code: u32) -> Option<Self> {
        Self::ALL.into_iter().find(|one| one.code() == code)
    }
}

/// One object of a simulated scene.
#[derive(Debug, Clone, Copy, PartialEq, Default, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.TrueObject.v1")]
#[repr(C)]
pub struct TrueObject {
    /// Number in the scene, from 1; its value in the mask.
    pub id: u32,
    /// Number of a [`TrueState`].
    pub state: u32,
    /// Pose: origin in the middle of the model's bounding box.
    pub world_from_object: WirePose,
    /// Sides of the model's bounding box, metres.
    pub size_m: [f32; 3],
    /// Share of the pixels it would fill alone that show it, 0 to 1.
    pub visible_fraction: f32,
    /// Pixels that show it.
    pub visible_px: u32,
    /// Pixels it would fill alone.
    pub unoccluded_px: u32,
    /// Its category.
    pub category: Text,
    /// Its name, which tells instances apart.
    pub name: Text,
}

const _: () = assert!(size_of::<TrueObject>() == 352);

/// Belongs to the frame of the same session and sequence; the payload beside it
/// is the objects, or the mask: the object of each pixel, row-major, 0 for none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.TruthHeader.v1")]
#[repr(C)]
pub struct TruthHeader {
    /// [`SCHEMA_VERSION`] of the writer.
    pub schema_version: u32,
    /// Zero.
    pub reserved: u32,
    /// Session of the frame.
    pub session: u64,
    /// Sequence of the frame.
    pub sequence: u64,
    /// Capture stamp of the frame.
    pub capture_ns: u64,
    /// Counts the messages of the port.
    pub sent: u64,
}

const _: () = assert!(size_of::<TruthHeader>() == 40);

impl Default for TruthHeader {
    fn default() -> Self {
        Self {
            schema_version: SCHEMA_VERSION,
            reserved: 0,
            session: 0,
            sequence: 0,
            capture_ns: 0,
            sent: 0,
        }
    }
}

/// Object of one pixel, 0 for none.
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
