//! PCD, the file format of the Point Cloud Library, version 0.7.
//!
//! Read: all three encodings; `x y z` as floating-point numbers of 4 or 8
//! bytes; `rgb` or `rgba` as four bytes, packed as an integer or in the bits of
//! a float; `label` of any type. Other fields are skipped. A point with a
//! coordinate that is not finite has three NaN coordinates; a point without a
//! colour is grey. Bytes after binary data are ignored, since some writers
//! pad their files.
//!
//! Written: `x y z rgba` and, if there are labels, `label`.

mod ascii;
mod decoder;
mod encoding;
mod error;
mod header;
mod header_lines;
mod layout;
mod point_value;
mod writer;

pub use crate::lzf::Error as CompressionError;
pub use decoder::Decoder;
pub use encoding::Encoding;
pub use error::Error;
pub use header::Header;
pub use writer::{PcdView, write};

use file_access::read_file;
use geometry::RigidTransform;
use point_cloud::Point;
use std::path::Path;

/// Maximum number of points of one file.
pub const MAX_POINTS: usize = 1 << 24;

/// Maximum size of one file, and of decompressed data, bytes.
pub const MAX_BYTES: u64 = 1 << 29;

/// Content of a PCD file.
#[derive(Debug, Clone, PartialEq)]
pub struct PcdCloud {
    /// Points, row-major; metres, in the frame of the file.
    pub points: Vec<Point>,
    /// Label of each point, if the file has labels.
    pub labels: Option<Vec<u32>>,
    /// Columns; the number of points when the cloud is not organised.
    pub width: usize,
    /// Rows; 1 when the cloud is not organised.
    pub height: usize,
    /// Pose of the sensor: world from sensor.
    pub viewpoint: RigidTransform,
}

impl PcdCloud {
    /// Borrowed view of the cloud, as [`write()`] takes it.
    pub fn view(&self) -> PcdView<'_> {
        PcdView {
            points: &self.points,
            labels: self.labels.as_deref(),
            width: self.width,
            height: self.height,
            viewpoint: self.viewpoint,
        }
    }
}

/// Decodes a PCD file from its bytes.
///
/// *Allocation*: the points and labels, and a copy of compressed data. For
/// reading at a camera's rate into preallocated memory, see [`Decoder`].
///
/// # Errors
/// When the bytes are not a PCD file this module reads; says where and why.
pub fn read(bytes: &[u8]) -> Result<PcdCloud, Error> {
    let header = Header::parse(bytes)?;
    let mut points = vec![Point::default(); header.n_points()];
    let mut labels = header.has_labels().then(|| vec![0; header.n_points()]);
    Decoder::new().decode_into(bytes, &header, &mut points, labels.as_deref_mut())?;
    Ok(PcdCloud {
        points,
        labels,
        width: header.width(),
        height: header.height(),
        viewpoint: header.viewpoint(),
    })
}

/// Reads a PCD file.
///
/// # Errors
/// When the file cannot be read, or as [`read`].
pub fn open(path: &Path) -> Result<PcdCloud, Error> {
    let mut bytes = Vec::new();
    read_file(path, MAX_BYTES, &mut bytes)?;
    read(&bytes)
}

#[cfg(test)]
mod tests;
