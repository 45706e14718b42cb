//! Object descriptors: appearance (shape, size, colour) and GOOD, with their object
//! frames.
//!
//! A descriptor is a vector that is similar for similar visible surfaces. [`AppearanceDescriptor`]
//! is the descriptor of the live system; it determines the object frame itself. [`Good`]
//! is the published descriptor; with [`reference_frame`], the frame of its
//! implementation, it reproduces the published numbers.
//!
//! Invariants: this crate copies an object's points once, into the object frame; it
//! never allocates in steady state, never does I/O, and knows nothing about categories
//! or distances between descriptors.
//!
//! # Example
//!
//! ```
//! use description::{AppearanceDescriptor, AppearanceWeights, ObjectPoints};
//! use point_cloud::{Point, Rgba};
//!
//! let point = |i: u16| {
//!     let t = f32::from(i);
//!     Point {
//!         x: 0.1 * t.sin(),
//!         y: 0.05 * (1.7 * t).sin(),
//!         z: 0.9 + 0.02 * (2.3 * t).sin(),
//!         color: Rgba::opaque(200, 40, 40),
//!     }
//! };
//! let cloud: Vec<Point> = (0..500).map(point).collect();
//! let mut appearance = AppearanceDescriptor::new(AppearanceWeights::default())?;
//! let hypotheses = appearance.describe(ObjectPoints::all(&cloud), None)?;
//! assert_eq!(hypotheses[0].len(), AppearanceDescriptor::DIMENSION);
//! # Ok::<(), description::Error>(())
//! ```

mod object_points;
mod white_balance;

mod descriptor;
mod descriptor_frame;
mod error;

mod object_axes;
mod projected_points;
mod reference_frame;
mod symmetric_eigen;

mod appearance;
mod good;

pub use appearance::{
    AppearanceDescriptor, AppearanceWeights, LearnedMetric, N_AXIS_HYPOTHESES, WarpedGood,
};
pub use descriptor::Descriptor;
pub use descriptor_frame::DescriptorFrame;
pub use error::Error;
pub use good::{Good, GoodVariant, Support};
pub use object_axes::{AxesKind, ObjectAxes, object_axes};
pub use object_points::ObjectPoints;
pub use reference_frame::reference_frame;
pub use white_balance::{LightColor, WhiteBalance};
