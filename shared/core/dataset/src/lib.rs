//! File formats: point clouds (PCD), meshes (PLY, OBJ, STL, DAE), BOP scenes, RGB-D
//! sequences, registered RGB-D images, fakenect recordings and datasets of
//! object views.
//!
//! Each format is a pure function over the bytes of a file, with a thin
//! wrapper that reads the file. A size that a file announces is compared with
//! the bytes present before any memory is reserved, so that a hostile file
//! costs no more than an error message.
//!
//! This crate never panics on any input, never reserves memory that the input
//! does not account for, never writes to a file outside the folder or path it
//! was given, and knows nothing about channels, sensors or services.
//!
//! # Example
//!
//! ```
//! use dataset::pcd::{self, Encoding, PcdView};
//! use geometry::RigidTransform;
//! use point_cloud::{Point, Rgba};
//!
//! let points = [Point { x: 0.1, y: 0.2, z: 1.5, color: Rgba::opaque(200, 100, 50) }];
//! let view = PcdView {
//!     points: &points,
//!     labels: None,
//!     width: 1,
//!     height: 1,
//!     viewpoint: RigidTransform::identity(),
//! };
//! let file = pcd::write(view, Encoding::BinaryCompressed)?;
//! assert_eq!(pcd::read(&file)?.points, points);
//! # Ok::<(), pcd::Error>(())
//! ```

mod error;
mod folder_path;
mod image_error;
mod jpeg_image;
mod lzf;
mod model;
mod model_error;
mod png_image;
mod texture;
mod texture_folder;
mod textured_mesh;

pub mod bop_scene;
pub mod dae;
pub mod fakenect_folder;
pub mod model_folder;
pub mod obj;
pub mod object_views;
pub mod pcd;
pub mod recording_kind;
pub mod registered_images;
pub mod rgbd_sequence;
pub mod scene_folder;
pub mod stl;
pub mod washington;

pub use error::{ContentError, Error};
pub use file_access::{
    FileError, OutputFile, check_output, create_folder, natural_order, write_atomic,
};
pub use image_error::ImageError;
pub use model::{FileModel, UpAxis};
pub use model_error::ModelError;
pub use ply::{self, NEUTRAL_GREY, mesh};
pub use recording_kind::{RecordingKind, detect_recording_kind};
