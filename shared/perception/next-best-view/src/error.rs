//! Errors of view planning.

use value_range::OutOfRange;

/// Error of describing a scene, rendering a view, or choosing one.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Setting outside its valid range.
    #[error("the view planning setting {0}")]
    Setting(#[from] OutOfRange),
    /// Intrinsics of the perspective projection.
    #[error("{0}")]
    Camera(#[from] geometry::InvalidIntrinsics),
    /// Surface model without a point.
    #[error("the surface model has no points; give it the points or the faces of the object")]
    EmptyModel,
    /// Coordinate of a model that is not finite, or beyond 10 m.
    #[error(
        "point {0} of the surface model is not a number or is more than 10 m away from its \
         origin; give points in metres in the frame of the object"
    )]
    ModelPoint(usize),
    /// Pose that is not finite.
    #[error("the pose of {what} {index} is not finite; leave it out")]
    NotFinite {
        /// Kind of the pose's owner.
        what: &'static str,
        /// Index in its list.
        index: usize,
    },
    /// Camera pose far away from the scene.
    #[error(
        "candidate view {0} is more than 100 m away from the scene; give poses in metres in the \
         frame of the hypotheses"
    )]
    FarView(usize),
    /// More hypotheses than labels.
    #[error("{n} object hypotheses are more than the {max} that one view can tell apart")]
    TooManyHypotheses {
        /// Number of hypotheses.
        n: usize,
        /// Greatest number.
        max: usize,
    },
    /// Scene too large for its cells.
    #[error(
        "the scene is {extent_m:.1} m wide, more than {max} cells of {cell_m} m; leave far \
         background out or choose larger cells"
    )]
    SceneTooLarge {
        /// Greatest side of the scene's bounding box, metres.
        extent_m: f64,
        /// Side of a cell, metres.
        cell_m: f64,
        /// Greatest number of cells along a side.
        max: usize,
    },
    /// Empty list of candidates.
    #[error("there is no candidate view to choose from; give at least one camera pose")]
    NoCandidates,
    /// Candidates that are all visited or blocked.
    #[error(
        "none of the {n} candidate views is left: {n_visited} were visited and {n_blocked} are \
         inside an object or at a surface; give other camera poses"
    )]
    NoneLeft {
        /// Number of candidates.
        n: usize,
        /// Number of visited ones, the current one included.
        n_visited: usize,
        /// Number of blocked ones.
        n_blocked: usize,
    },
}
