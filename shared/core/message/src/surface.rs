//! Support surfaces of a scene.

use bytemuck::{Pod, Zeroable};
use iceoryx2::prelude::ZeroCopySend;

/// Maximum number of surfaces in one scene summary.
pub const MAX_SURFACES: usize = 6;

/// Maximum number of corners of a surface.
pub const MAX_SURFACE_CORNERS: usize = 16;

coded_enum::coded_enum! {
    /// Kind of a support surface, as a code in [`WireSurface::kind`].
    pub enum SurfaceKind: u32 {
        /// Surface on which objects are looked for first.
        Table = 1, "table";
        /// Level of furniture over or under the table that carries objects, too.
        Level = 2, "level";
        /// Level that only the present frame shows, and that carries no object yet.
        NewLevel = 3, "new-level";
        /// Floor, or another surface so low that no object is looked for there.
        Floor = 4, "floor";
    }
}

impl SurfaceKind {
    /// True if objects are looked for on surfaces of this kind.
    pub fn carries_objects(self) -> bool {
        matches!(self, Self::Table | Self::Level)
    }
}

/// Support surface of a scene summary, world frame.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable, ZeroCopySend)]
#[type_name("tabula.Surface.v1")]
#[repr(C)]
pub struct WireSurface {
    /// Plane: upward unit normal and offset, metres.
    pub plane: [f64; 4],
    /// Kind: code of a [`SurfaceKind`].
    pub kind: u32,
    /// Number of samples of the subsampled image on the surface.
    pub n_samples: u32,
    /// Number of valid entries of `corners_m`.
    pub n_corners: u32,
    /// Corners of the convex hull of what is seen of it, metres, in order around it.
    pub corners_m: [[f32; 3]; MAX_SURFACE_CORNERS],
    /// 0.
    pub reserved: u32,
}

const _: () = assert!(size_of::<WireSurface>() == 48 + MAX_SURFACE_CORNERS * 12);

impl Default for WireSurface {
    fn default() -> Self {
        Self::zeroed()
    }
}

impl WireSurface {
    /// Kind of the surface; `None` for one that is no finite plane of a known kind.
    pub fn checked_kind(&self) -> Option<SurfaceKind> {
        let is_finite = self.plane.iter().all(|value| value.is_finite());
        SurfaceKind::from_code(self.kind).filter(|_| is_finite)
    }

    /// Corners of the surface, metres.
    pub fn corners_m(&self) -> &[[f32; 3]] {
        &self.corners_m[..MAX_SURFACE_CORNERS.min(self.n_corners as usize)]
    }
}
