//! Plots as SVG and reports as HTML pages, drawn with plotters.
//!
//! [`diagram`] draws line charts, [`box_plot`] box plots, [`forest_plot`] forest plots of
//! estimates with their confidence intervals, and [`figure_page`] puts tables and figures on an
//! HTML page.
//!
//! ```
//! use plot::diagram::{Axis, Color, Curve, Diagram, Legend, side_by_side};
//!
//! let curve = Curve::marked("detection", Color::BLUE, [(1.0, 3.2), (8.0, 7.5)]);
//! let svg = side_by_side(&[Diagram {
//!     title: "Latency",
//!     x: Axis::linear("objects", 0.0..10.0),
//!     y: Axis::linear("ms", 0.0..10.0),
//!     curves: vec![curve],
//!     legend: Legend::UpperLeft,
//! }])?;
//! assert!(svg.contains("detection"));
//! # Ok::<(), plot::DrawingError>(())
//! ```
//!
//! Invariants: this crate never writes a file and never reads a clock; the same input gives the
//! same text.

pub mod box_plot;
pub mod diagram;
pub mod figure_page;
pub mod forest_plot;
pub mod html_page;

pub use diagram::DrawingError;
