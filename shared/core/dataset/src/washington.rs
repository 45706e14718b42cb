//! Washington RGB-D Object Dataset (Lai, Bo, Ren and Fox 2011): folder layout of single objects
//! on a turntable, cropped from images of 640 x 480 pixels.
//!
//! A view's files are called `<category>_<instance>_<sequence>_<frame>` with
//! one of these endings, and are in `<category>/<category>_<instance>/`:
//!
//! | ending | content |
//! |---|---|
//! | `_crop.png` | the cut-out in colour, 8 bits a channel |
//! | `_depthcrop.png` | of the same size, 16 bits a pixel, millimetres; 0 is no depth |
//! | `_maskcrop.png` | of the same size, 8 bits a pixel or 1; all but 0 is the object |
//! | `_loc.txt` | `x,y`: column and row of the cut-out's first pixel in the whole image |
//! | `.pcd` | the object's points: `x y z rgb imX imY`, metres |
//!
//! Read are also trees that lack a level or all levels of folders, and views
//! with images only or with points only.
//!
//! What is assumed: `_loc.txt` counts from 1, as the data set's own program for
//! Matlab does, whose camera is [`CAMERA`]; so do `imX` and `imY`, which are
//! written and not read. A PCD file has the camera at its origin, which looks
//! along +y, with x to the right and z upwards; in memory, points are in the
//! camera frame of this project.

mod cloud;
mod image;
mod location;
mod object_dataset;
mod view;
mod view_name;
mod writer;

pub use cloud::{read_cloud, write_cloud};
pub use image::{decode_color, decode_depth, decode_mask};
pub use location::{format_location, parse_location};
pub use object_dataset::ObjectDataset;
pub use view::CroppedView;
pub use view_name::ViewName;
pub use writer::write_view;

use geometry::PinholeCamera;

/// Camera of the dataset's own program: focal length 570.3 pixels, principal point at column
/// 320 and row 240, counted from 1.
pub const CAMERA: PinholeCamera = PinholeCamera {
    fx_px: 570.3,
    fy_px: 570.3,
    cx_px: 319.0,
    cy_px: 239.0,
    width: 640,
    height: 480,
};

const COLOR_SUFFIX: &str = "_crop.png";
const DEPTH_SUFFIX: &str = "_depthcrop.png";
const MASK_SUFFIX: &str = "_maskcrop.png";
const LOCATION_SUFFIX: &str = "_loc.txt";
const CLOUD_SUFFIX: &str = ".pcd";

#[cfg(test)]
mod tests;
