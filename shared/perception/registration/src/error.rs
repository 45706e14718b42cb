//! Errors of registration.

/// Error of making a surface or of registering two.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Too few points, or points too sparse, for a surface.
    #[error(
        "the {n_points} points of the view make {n_surfels} surface elements of 4 mm, too few to \
         register; show the object larger or from nearer"
    )]
    TooFewSurfels {
        /// Points of the view.
        n_points: usize,
        /// Surface elements with a normal.
        n_surfels: usize,
    },
    /// A coordinate that is not finite.
    #[error("point {0} of the view has a coordinate that is not a number; leave such points out")]
    NotFinite(usize),
    /// A coordinate beyond all measurements.
    #[error("point {0} of the view is more than 1 km away; give the points in metres")]
    TooFar(usize),
    /// No correspondences between the surfaces.
    #[error(
        "the two views have no surface in common within {reach_mm} mm of the expected pose; take \
         views that overlap, or give a better pose"
    )]
    NoOverlap {
        /// Distance up to which correspondences were searched, millimetres.
        reach_mm: u32,
    },
}
