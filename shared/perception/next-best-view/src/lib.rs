//! Next best view: virtual views of object hypotheses, their entropy, and the choice among them.
//!
//! A [`PlanningScene`] holds object hypotheses, each a [`SurfaceModel`] at a pose, and the points
//! of the table and of other background. A [`ViewPlanner`] renders it into a [`VirtualView`] from
//! every candidate camera, and scores each candidate by its viewpoint entropy, weighted by the
//! distance from the current camera; [`choose_view`] takes the best one or draws one (Kasaei et
//! al. 2018, equations 2 to 4). An [`OccupancyGrid`] adds the unknown space that a candidate
//! would see. A [`ViewSegmenter`] segments a virtual view by the project's own detection, in place
//! of the identities of its hypotheses.
//!
//! Invariants: this crate does no I/O, reads no clock, starts no thread, and draws randomness only
//! from the given generator. Once its buffers have grown, scoring and choosing allocate nothing.
//!
//! # Example
//!
//! ```
//! use geometry::RigidTransform;
//! use nalgebra::{Point3, Vector3};
//! use next_best_view::{
//!     CandidateViews, Config, Hypothesis, PlanningScene, SurfaceModel, ViewPlanner,
//!     ViewSelection, choose_view,
//! };
//! use random::Random;
//!
//! // Two boxes in a row along x: from along the row one hides the other.
//! let cube = SurfaceModel::of_mesh(&mesh::rounded_box([0.1; 3], 0.01, 0.1).mesh, 0.003)?;
//! let at = |id, x| Hypothesis {
//!     id,
//!     model: &cube,
//!     world_from_object: RigidTransform::translation(x, 0.0, 0.05),
//! };
//! let scene = PlanningScene::new(&[at(1, -0.1), at(2, 0.1)], &[])?;
//! let looking_from = |x, y| {
//!     let (eye, middle) = (Point3::new(x, y, 0.05), Point3::new(0.0, 0.0, 0.05));
//!     RigidTransform::face_towards(&eye, &middle, &-Vector3::z())
//! };
//! let candidates = [looking_from(1.0, 0.0), looking_from(0.3, -0.95)];
//! let views = CandidateViews {
//!     world_from_candidates: &candidates,
//!     world_from_current: looking_from(0.8, -0.6),
//!     world_from_visited: &[],
//! };
//! let mut planner = ViewPlanner::default();
//! let scores = planner.score(&scene, &views, &Config::default(), None)?;
//! let choice = choose_view(scores, ViewSelection::Greedy, &mut Random::from_seed(1))?;
//! assert_eq!(choice.candidate, 1);
//! assert!(scores[1].entropy > 0.99 && scores[0].entropy < 0.01);
//! # Ok::<(), next_best_view::Error>(())
//! ```

mod candidate_views;
mod config;
mod depth_buffer;
mod error;
mod explained_space;
mod occupancy_grid;
mod planning_scene;
mod ray_casting;
mod surface_model;
mod view_choice;
mod view_distance;
mod view_entropy;
mod view_planner;
mod view_projection;
mod view_segmenter;
mod virtual_view;

pub use candidate_views::CandidateViews;
pub use config::Config;
pub use error::Error;
pub use explained_space::ExplainedSpace;
pub use occupancy_grid::{OccupancyGrid, VoxelState};
pub use planning_scene::{Hypothesis, PlanningScene};
pub use surface_model::SurfaceModel;
pub use view_choice::{ChoiceReason, ViewChoice, ViewSelection, choose_view};
pub use view_distance::ViewMetric;
pub use view_entropy::{TotalArea, view_entropy};
pub use view_planner::{CandidateState, ViewPlanner, ViewScore};
pub use view_projection::ViewProjection;
pub use view_segmenter::ViewSegmenter;
pub use virtual_view::{RenderConfig, ViewLabel, VirtualView};
