//! Evaluation metrics of detection, tracking and recognition, and their figures.
//!
//! Each metric is a function from data to figures; the same input gives the same result.
//!
//! - Segmentation: [`labelled_scenes`] reads scenes with ground truth, [`segmentation_score`]
//!   scores the hypotheses of [`hypothesis_image`], and [`scene_picture`] shows
//!   the result.
//! - Tracking: [`tracking_score`] scores [`tracked_frame`]s by [`clear_mot`] and [`id_f1`],
//!   [`track_drift`] measures jitter, [`true_shape`] gives ground-truth boxes, and
//!   [`track_figure`] and [`box_picture`] show tracks.
//! - Recognition: [`open_ended`] runs the simulated teacher and [`cross_validation`] k-fold
//!   cross-validation over a [`recogniser`];
//!   [`novelty_score`] measures open-set rejection, [`answer_score`] what is said of it.
//! - Sensor: [`sensor_error`] compares the simulated Kinect's depth noise with the published
//!   model, and [`memory_floor`] gives the cost of reading a cloud once.
//!
//! Statistics (percentiles, bootstrap confidence intervals) are in the crate `statistics`, charts
//! and HTML pages in the crate `plot`.
//!
//! ```
//! use evaluation::segmentation_score::{Overlaps, score};
//!
//! // One object (label 10) of 400 pixels, of which hypothesis 1 covers 300.
//! let labels = vec![10_u16; 400];
//! let hypotheses: Vec<u16> = (0..400).map(|pixel| u16::from(pixel < 300)).collect();
//! let score = score(&Overlaps::count(&hypotheses, &labels)).unwrap();
//! assert_eq!(score.wov, 0.75);
//! ```
//!
//! Invariants: this crate starts no process, reads no clock, writes no file and knows no
//! channels. Durations are measured by the caller and passed as numbers.

pub mod answer_score;
pub mod box_picture;
pub mod calibration_score;
pub mod clear_mot;
pub mod cross_validation;
pub mod disturbance;
pub mod hypothesis_image;
pub mod id_f1;
pub mod labelled_scenes;
pub mod memory_floor;
pub mod new_side_score;
pub mod novelty_score;
pub mod open_ended;
pub mod recogniser;
pub mod resting_objects;
pub mod scene_picture;
pub mod segmentation_score;
pub mod sensor_error;
pub mod track_drift;
pub mod track_figure;
pub mod track_wholeness;
pub mod tracked_frame;
pub mod tracking_score;
pub mod true_shape;
mod upright_outline;
