//! Rigid registration of partial views of an object: generalised ICP on surfels.
//!
//! A view becomes a [`ViewSurface`]: its points, and the surfels of a voxel grid. [`register`] finds
//! the pose of one surface in the frame of another, from a prior such as the pose that the robot
//! reports for its camera.
//!
//! 1. From the prior, and from the prior with the centroids brought together, the surfels are
//!    aligned by generalised ICP with a shrinking distance of correspondence (Segal, Haehnel and
//!    Thrun, "Generalized-ICP", 2009). The start whose result contradicts the two views least
//!    goes on: a point contradicts a view that should have seen it, and did not.
//! 2. A turn that the surfaces hardly constrain, such as that of a can about its axis, stays as in
//!    the prior, unless the points themselves clearly prefer another one.
//! 3. All surfels refine the result.
//!
//! [`estimate_pose`] finds the pose of a whole model in a segment of a view without a prior.
//!
//! # Example
//!
//! ```
//! use nalgebra::{Isometry3, Vector3};
//! use registration::{Prior, ViewSurface, register};
//!
//! // A bent sheet, and the same 1 cm further to the right.
//! let sheet = |dx: f32| -> Vec<[f32; 3]> {
//!     let place = |i: u32| ((i % 60) as f32 * 0.002, (i / 60) as f32 * 0.002);
//!     (0..3600).map(place).map(|(x, y)| [x + dx, y, 3.0 * x * y + x * x]).collect()
//! };
//! let target = ViewSurface::new(&sheet(0.0), None)?;
//! let source = ViewSurface::new(&sheet(0.01), None)?;
//! let found = register(&target, &source, &Prior::at(Isometry3::identity()))?;
//! let moved = found.target_from_source.translation.vector;
//! assert!((moved - Vector3::new(-0.01, 0.0, 0.0)).norm() < 0.001);
//! # Ok::<(), registration::Error>(())
//! ```

mod color_gradient;
mod correspondence_score;
mod error;
mod generalized_icp;
mod kd_tree;
mod model_pose;
mod near_grid;
mod nearest_surfel_grid;
mod prior;
mod range_image;
mod register;
mod surfels;
pub mod twist;
mod view_surface;
mod weak_rotation;

pub use error::Error;
pub use kd_tree::KdTree;
pub use model_pose::{ModelCandidate, ModelPose, PoseModel, SegmentView, estimate_pose, identify};
pub use prior::Prior;
pub use register::{PairAlignment, Registration, refine, register};
pub use view_surface::{ViewOrigin, ViewSurface};
