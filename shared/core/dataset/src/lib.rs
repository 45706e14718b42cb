//! File formats: point clouds (PCD), meshes (PLY, OBJ), RGB-D sequences,
//! fakenect folders and sets of views of single objects.
//!
//! Each format is a pure function over the bytes of a file, with a thin
//! wrapper that reads the file. What a file says about its size is compared
//! with the bytes that are there before any memory is reserved, so that a
//! hostile file costs a sentence.
//!
//! Files are written whole or not at all where a killed writer could leave
//! something that can not be read.
//!
//! This crate never panics on any input, never reserves memory that the input
//! does not account for, never writes to a file outside the folder or path it
//! was given, and knows nothing about channels, sensors or services.

mod bounded_file;
mod lzf;
mod natural_order;
mod number;
mod png_image;
mod whole_file;

#[cfg(test)]
mod hostile;

pub mod fakenect_folder;
pub mod mesh;
pub mod models;
pub mod obj;
pub mod object_views;
pub mod pcd;
pub mod ply;
pub mod recording_kind;
pub mod rgbd_sequence;
pub mod scene_folder;
pub mod washington;

pub use bounded_file::FileError;
pub use natural_order::natural_order;
pub use recording_kind::{RecordingKind, detect_kind};

/// The colour of points from files without colours.
pub const NEUTRAL_GREY: point_cloud::Rgba = point_cloud::Rgba::opaque(128, 128, 128);
