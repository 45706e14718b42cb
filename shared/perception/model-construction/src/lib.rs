//! Construction of object models: views of an object become one coloured surface.
//!
//! [`ModelBuilder::add`] takes one view after the other:
//!
//! 1. The pose of the camera that the robot reports is filtered with the motion so far, by a
//!    Kalman filter.
//! 2. The view is registered with the part of the model that its camera should see, with the
//!    filtered pose as prior. A view that does not fit is refused, with the reason.
//!    The first view after somebody has turned or moved the object is registered in all turns about
//!    the vertical; shape and colour tell the right one.
//! 3. It is fused into a truncated signed distance field with colours (Curless and Levoy, "A
//!    volumetric method for building complex models from range images", 1996).
//!
//! When the views have led around the object, or at [`ModelBuilder::finish`], a pose graph over
//! pairs of views distributes the remaining errors (Lu and Milios 1997), and all views are fused
//! again. [`ModelBuilder::mesh`] extracts the surface by marching cubes.

mod config;
mod cube_cases;
mod depth_view;
mod depth_window;
mod error;
mod facing_surface;
mod frame_error;
mod loop_closure;
mod marching_cubes;
mod model_builder;
mod placement;
mod pose_filter;
mod pose_graph;
mod surface_points;
mod tsdf_volume;
mod turn_search;
mod view;
mod voxel_block;

pub use config::Config;
pub use error::{Error, Misfit};
pub use model_builder::ModelBuilder;
pub use pose_filter::PoseSigma;
pub use surface_points::SurfacePoint;
pub use view::{BuiltView, View};
