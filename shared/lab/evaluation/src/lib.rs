//! Experiments: what is measured, and how it is drawn.
//!
//! Each experiment is a function from its parameters to its figures, and a
//! function that draws them. The same parameters give the same figures.
//!
//! [`labelled_scenes`] reads scenes whose objects are known,
//! [`segmentation_score`] says how well a detection agrees with them, and
//! [`scene_picture`] and [`score_page`] show it. [`sensor_error`] compares the
//! simulated sensor with the published law. [`tracking_score`] says how well tracks
//! agree with the truth of [`tracked_frame`]s. [`open_ended`] and [`cross_validation`]
//! say how well a [`recogniser`] learns views of objects, [`novelty_score`] how well it
//! tells what it was never taught, and [`bootstrap`] how certain the figures of runs are.
//!
//! [`figure`] draws curves, also those of others.
//!
//! This crate never starts a process, never reads a clock, writes no file, and
//! knows nothing of channels. Durations are measured by the caller and come in
//! as numbers, see [`durations`].

pub mod box_picture;
pub mod clear_mot;
pub mod cross_validation;
pub mod hypothesis_image;
pub mod id_f1;
pub mod labelled_scenes;
pub mod memory_floor;
pub mod novelty_score;
pub mod open_ended;
pub mod recogniser;
pub mod scene_picture;
pub mod score_page;
pub mod segmentation_score;
pub mod sensor_error;
pub mod track_drift;
pub mod track_figure;
pub mod tracked_frame;
pub mod tracking_score;
pub mod true_shape;
mod upright_outline;
