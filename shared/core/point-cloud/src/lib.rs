//! Points, organised point clouds as borrowed views, principal axes and colour histograms.
//!
//! A cloud is a slice of [`Point`]s; the memory (a vector, a shared frame, a
//! file) belongs to the caller. An organised cloud keeps the image grid it was
//! measured on; a pixel without depth holds NaN coordinates.
//!
//! This crate never allocates per point and never does I/O.
//!
//! # Example
//!
//! ```
//! use point_cloud::{Moments, OrganizedCloud, Point};
//!
//! let points: Vec<Point> = (0..6)
//!     .map(|i| Point { x: i as f32, y: (i % 2) as f32, z: 1.0, ..Point::default() })
//!     .collect();
//! let cloud = OrganizedCloud::new(&points, 3, 2)?;
//! assert_eq!(cloud.row(1).len(), 3);
//!
//! let mut moments = Moments::default();
//! points.iter().for_each(|point| moments.add(&point.position()));
//! let axes = moments.principal_axes().expect("there are more than two points");
//! assert!(axes.axes.column(0)[0].abs() > 0.9, "the points extend along x");
//! # Ok::<(), point_cloud::SizeMismatch>(())
//! ```

mod color_histogram;
mod color_term;
mod least_eigenvector;
mod organized_cloud;
mod point;
mod principal_axes;
mod vertex;

pub use color_histogram::ColorHistogram;
pub use color_term::{ColorShares, ColorTerm};
pub use least_eigenvector::least_eigenvector;
pub use organized_cloud::{OrganizedCloud, SizeMismatch};
pub use point::{Point, Rgba};
pub use principal_axes::{Moments, PrincipalAxes};
pub use vertex::Vertex;
