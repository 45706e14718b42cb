//! Experiments: what is measured, and how it is drawn.
//!
//! Each experiment is a function from its parameters to its figures, and a
//! function that draws them. The same parameters give the same figures.
//!
//! [`labelled_scenes`] reads scenes whose objects are known,
//! [`segmentation_score`] says how well a detection agrees with them, and
//! [`scene_picture`] and [`score_page`] show it. [`sensor_error`] compares the
//! simulated sensor with the published law.
//!
//! This crate never starts a process, never reads a clock, writes no file, and
//! knows nothing of channels. Durations are measured by the caller and come in
//! as numbers, see [`durations`].

pub mod durations;
mod figure;
pub mod hypothesis_image;
pub mod labelled_scenes;
pub mod scene_picture;
pub mod score_page;
pub mod segmentation_score;
pub mod sensor_error;

pub use figure::DrawingError;
