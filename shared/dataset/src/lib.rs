//! File formats: PCD, PLY, RGB-D sequences and fakenect folders.
//!
//! Each format is a pure function over the bytes of a file, with a thin
//! wrapper that reads the file. What a file says about its size is compared
//! with the bytes that are there before any memory is reserved, so that a
//! hostile file costs a sentence.
//!
//! This crate never panics on any input, never reserves memory that the input
//! does not account for, never writes to a file outside the folder or path it
//! was given, and knows nothing about channels, sensors or services.

mod bounded_file;
mod lzf;
mod natural_order;
mod number;

#[cfg(test)]
mod hostile;

pub mod fakenect_folder;
pub mod pcd;
pub mod ply;
pub mod recording_kind;
pub mod rgbd_sequence;
pub mod scene_folder;

pub use bounded_file::FileError;
pub use natural_order::natural_order;
pub use recording_kind::{RecordingKind, detect_kind};

/// The colour of points from files without colours.
pub const NEUTRAL_GREY: point_cloud::Rgba = point_cloud::Rgba::opaque(128, 128, 128);
