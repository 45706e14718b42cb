//! Header of a PCD file.

use super::encoding::Encoding;
use super::error::Error;
use super::header_lines::{Line, Lines};
use super::layout::Layout;
use super::{MAX_BYTES, MAX_POINTS};
use crate::lzf;
use geometry::RigidTransform;
use nalgebra::{Quaternion, Translation3, UnitQuaternion};

/// Tolerance of the length of the viewpoint's quaternion, for numbers with few digits. Chosen.
const QUATERNION_TOLERANCE: f64 = 0.01;

/// Header of a PCD file, validated against the number of bytes that follow it.
#[derive(Debug, Clone, PartialEq)]
pub struct Header {
    pub(super) layout: Layout,
    pub(super) encoding: Encoding,
    /// Offset of the point data in the PCD file, bytes.
    pub(super) data_offset: usize,
    width: usize,
    height: usize,
    viewpoint: RigidTransform,
}

impl Header {
    /// Parses the header of a PCD file. The announced data is present, or can be present when it is
    /// text or compressed: memory for [`Header::n_points`] may be reserved.
    ///
    /// # Errors
    /// When the header is wrong or announces more than the bytes can hold.
    pub fn parse(bytes: &[u8]) -> Result<Self, Error> {
        let (lines, encoding, data_offset) = Lines::split(bytes)?;
        lines.require("VERSION")?.one_of(&["0.7", ".7"])?;
        let layout = Layout::parse(&lines)?;
        let (width, height) = (
            lines.require("WIDTH")?.count()?,
            lines.require("HEIGHT")?.count()?,
        );
        let points = lines.require("POINTS")?;
        if width.checked_mul(height) != Some(points.count()?) {
            return Err(points.error("the number of points is not WIDTH times HEIGHT"));
        }
        let viewpoint = match lines.find("VIEWPOINT") {
            Some(line) => viewpoint(line)?,
            None => RigidTransform::identity(),
        };
        let header = Self {
            layout,
            encoding,
            data_offset,
            width,
            height,
            viewpoint,
        };
        header.check_size(&bytes[data_offset..])?;
        Ok(header)
    }

    /// Columns; the number of points when the cloud is not organised.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows; 1 when the cloud is not organised.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Number of points, at most [`MAX_POINTS`].
    pub fn n_points(&self) -> usize {
        self.width * self.height
    }

    /// True if the file's points have labels.
    pub fn has_labels(&self) -> bool {
        self.layout.label.is_some()
    }

    /// True if the points have colours; otherwise they are grey.
    pub fn has_colors(&self) -> bool {
        self.layout.color.is_some()
    }

    /// Encoding of the point data.
    pub fn encoding(&self) -> Encoding {
        self.encoding
    }

    /// Pose of the sensor: world from sensor.
    pub fn viewpoint(&self) -> RigidTransform {
        self.viewpoint
    }

    /// Size of all points in binary, bytes.
    pub(super) fn n_binary_bytes(&self) -> usize {
        self.n_points() * self.layout.point_bytes
    }

    /// Compressed point data after its two size fields.
    pub(super) fn compressed<'a>(&self, data: &'a [u8]) -> Result<&'a [u8], Error> {
        let truncated = |needed| Error::Truncated {
            needed,
            present: data.len(),
        };
        let (sizes, rest) = data.split_first_chunk::<8>().ok_or(truncated(8))?;
        let [a, b, c, d, e, f, g, h] = *sizes;
        let n_compressed = u32::from_le_bytes([a, b, c, d]) as usize;
        let announced = u32::from_le_bytes([e, f, g, h]) as usize;
        let needed = self.n_binary_bytes();
        if announced != needed {
            return Err(Error::CompressedSize { announced, needed });
        }
        rest.get(..n_compressed)
            .ok_or(truncated(n_compressed.saturating_add(8)))
    }

    fn check_size(&self, data: &[u8]) -> Result<(), Error> {
        let n_bytes = self.n_points().checked_mul(self.layout.point_bytes);
        // The sides are checked as well: an empty cloud may be 0 x 2^60.
        let longest = self.n_points().max(self.width).max(self.height);
        if longest > MAX_POINTS || n_bytes.is_none_or(|n| n as u64 > MAX_BYTES) {
            return Err(Error::TooLarge);
        }
        let (needed, present) = match self.encoding {
            Encoding::Binary => (self.n_binary_bytes(), data.len()),
            // A digit and a separator for each value; the last needs none.
            Encoding::Ascii => (
                2 * self.n_points() * self.layout.point_values,
                data.len().saturating_add(1),
            ),
            Encoding::BinaryCompressed => {
                let present = self.compressed(data)?.len();
                (self.n_binary_bytes().div_ceil(lzf::MAX_EXPANSION), present)
            }
        };
        if needed > present {
            Err(Error::Truncated { needed, present })
        } else {
            Ok(())
        }
    }
}

/// Parses a viewpoint: translation, then a quaternion with its real part first.
fn viewpoint(line: &Line<'_>) -> Result<RigidTransform, Error> {
    let number = |word: &&str| word.parse().ok().filter(|number: &f64| number.is_finite());
    let numbers: Option<Vec<f64>> = line.words.iter().map(number).collect();
    let Some([tx, ty, tz, qw, qx, qy, qz]) = numbers.as_deref() else {
        return Err(line.error("it must be seven finite numbers tx ty tz qw qx qy qz"));
    };
    let quaternion = Quaternion::new(*qw, *qx, *qy, *qz);
    if (quaternion.norm() - 1.0).abs() > QUATERNION_TOLERANCE {
        return Err(line.error("its quaternion must have length 1"));
    }
    let rotation = UnitQuaternion::from_quaternion(quaternion);
    Ok(RigidTransform::from_parts(
        Translation3::new(*tx, *ty, *tz),
        rotation,
    ))
}
