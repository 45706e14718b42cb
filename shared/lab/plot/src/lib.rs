//! Plots as SVG and reports as HTML pages, drawn with plotters.
//!
//! [`figure`] draws curves in diagrams, [`interval_figure`] estimates with their
//! confidence intervals, and [`figure_page`] puts tables and figures on a page.
//!
//! Invariants: this crate never writes a file and never reads a clock; the same
//! input gives the same text.

pub mod figure;
pub mod figure_page;
pub mod interval_figure;
pub mod page;

pub use figure::DrawingError;
