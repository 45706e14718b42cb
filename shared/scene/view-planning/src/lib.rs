//! Next best view of a snapshot: rating of candidate camera poses and choice among them.
//!
//! A [`PlanningFrame`](scene_client::PlanningFrame) has its origin in the middle of the objects and z against gravity. A
//! [`PlanContent`] holds what a snapshot shows in it: object hypotheses, the background around them
//! and the unknown space. [`plan`] rates candidates such as those of a [`hemisphere`] by their
//! virtual views, leaves out those that are visited, blocked or below the table, and chooses one.
//!
//! Invariants: this crate does no I/O and reads no clock; a plan depends on its arguments alone.
//!
//! # Example
//!
//! ```
//! use geometry::PinholeCamera;
//! use point_cloud::{Point, Rgba};
//! use random::Random;
//! use scene_client::{ModelShelf, PlanningFrame, Snapshot};
//! use view_planning::{PlanContent, PlanSettings, hemisphere, plan};
//!
//! // A wall, a metre before a camera that knows nothing else.
//! let camera = PinholeCamera { fx_px: 60.0, fy_px: 60.0, cx_px: 31.5, cy_px: 23.5, width: 64, height: 48 };
//! let place = |i: u32| camera.back_project(f64::from(i % 64), f64::from(i / 64), 1.0);
//! let color = Rgba::opaque(90, 90, 90);
//! let points = (0..64 * 48).map(|i| {
//!     let [x, y, z] = place(i).cast::<f32>().into();
//!     Point { x, y, z, color }
//! });
//! let snapshot = Snapshot::of_points(camera, points.collect());
//! let frame = PlanningFrame::of(&snapshot).expect("the image has depth in its middle");
//! let content = PlanContent::of(&snapshot, frame, &ModelShelf::default(), true)?;
//! let candidates = hemisphere(20, 1.0, 0.3);
//! let settings = PlanSettings::default();
//! let plan = plan(&content, &candidates, &[], &settings, &mut Random::from_seed(1))?;
//! assert!(plan.chosen < 20 && plan.views.len() == 20);
//! # Ok::<(), service::Failure>(())
//! ```

mod candidate_poses;
mod plan_content;
mod plan_settings;
mod planning_space;
mod view_plan;
mod virtual_camera;
mod visible_shares;

pub use candidate_poses::hemisphere;
pub use plan_content::PlanContent;
pub use plan_settings::PlanSettings;
pub use planning_space::PlanningSpace;
pub use view_plan::{RatedView, ViewPlan, plan, rate};
