//! Tabletop object detection in one RGB-D point cloud.
//!
//! [`detect`] finds the table plane by RANSAC, keeps the points in the prism above the
//! table's polygon, clusters them by connected components on the image grid, segments the
//! clusters into objects by trained models, and returns each object as a [`Candidate`] with an
//! oriented box. Every [`Constraint`](constraint::Constraint) is evaluated for each
//! candidate; an [`Expression`](constraint::Expression) over them decides whether the
//! candidate is a new object. A cloud without an image grid is reprojected onto one
//! where it is a single view, and searched in a voxel grid otherwise.
//!
//! Invariants: this crate never does I/O, never reads a clock, keeps no state between
//! frames but buffers, gives the same answer for the same input, accepts any bit
//! pattern in the points, and knows people, the robot, the table of earlier frames and tracks
//! only as the shapes in [`ScenePriors`].
//!
//! # Example
//!
//! A cloud without a plane has no table and therefore no candidates:
//!
//! ```
//! use detection::{Config, Detection, DetectionInput, Execution, ScenePriors, Workspace, detect};
//! use point_cloud::{OrganizedCloud, Point};
//!
//! let points = vec![Point::default(); 640 * 480];
//! let frame = DetectionInput {
//!     cloud: OrganizedCloud::new(&points, 640, 480)?,
//!     up_in_camera: None,
//!     priors: ScenePriors::default(),
//! };
//! let (mut workspace, mut detection) = (Workspace::default(), Detection::default());
//! detect(&frame, &Config::default(), &mut workspace, &mut detection, Execution::default())?;
//! assert!(detection.surfaces.is_empty() && detection.candidates.is_empty());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod affine_form;
mod body_map;
mod candidate;
mod carried_objects;
mod cielab;
mod cluster_hypothesis;
mod clusters;
mod config;
mod constraint_evaluation;
mod depth_history;
mod detect;
mod error;
mod execution;
mod footprint;
mod input;
mod level_surfaces;
mod near_limit;
mod near_rim;
mod occluded_table;
mod organized;
mod outline;
mod outline_tracing;
mod output;
mod parallelism;
mod pixel_bounds;
mod plane_ransac;
mod plane_region;
mod prism;
mod reaching_bodies;
mod region_merging;
mod samples;
mod segmentation;
mod segmentation_training;
mod split_gate;
mod stage;
mod support_plane_holes;
mod support_relations;
mod table;
mod table_noise;
mod table_reference;
mod table_selection;
mod table_surface;
mod unorganized;
mod upright_box;
mod walls;
mod workspace;

pub use body_map::BodyMap;
pub use candidate::{Candidate, Support};
pub use config::{Config, InvalidConfig, RawConfig};
pub use detect::detect;
pub use error::Error;
pub use execution::Execution;
pub use input::{DetectionInput, ExpectedTrack, ScenePriors};
pub use outline::Outline;
pub use output::Detection;
pub use parallelism::{Parallelism, Sequential};
pub use region_merging::{FEATURE_NAMES, N_FEATURES, PairFeatures, RegionPair};
pub use segmentation::{
    EDGE_FEATURE_NAMES, EdgeExample, EdgeFeatures, N_EDGE_FEATURES, SegmentationExamples,
};
pub use segmentation_training::add_examples;
pub use stage::DetectionStage;
pub use table::{SurfaceRole, Table, TableChoice, is_same_surface};
pub use workspace::Workspace;
