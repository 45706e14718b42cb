//! Lossless encoding of a camera frame: header fields, then planes of bytes.
//!
//! The points of an organised cloud follow from depth and colour: x and y are a pixel's viewing
//! ray times z. A frame holds depth and colour, and planes of x and y only when the product
//! differs from them in some bit; these then hold the differing bits. Depth has a dictionary
//! encoding, a table of its distinct values and an index for each pixel, or a byte shuffle when
//! there are too many. The bytes of colours have a delta encoding, from the pixel before.

use crate::field_reader::FieldReader;
use crate::word_table::{self, WordTable};
use crate::{InvalidRecord, byte_planes};
use geometry::PinholeCamera;
use message::{CloudPoint, FrameHeader, InvalidFrame, Text, WireTransform};

/// Version of the encoding.
const VERSION: u32 = 1;
/// Bit of the planes of x.
const HAS_X: u32 = 1;
/// Bit of the planes of y.
const HAS_Y: u32 = 1 << 1;
/// Bit of a table in the place of the planes of z.
const HAS_Z_TABLE: u32 = 1 << 2;

/// Viewing rays of a camera's columns and rows, x and y at z = 1.
struct Rays {
    x: Vec<f32>,
    y: Vec<f32>,
}

impl Rays {
    fn new(camera: &PinholeCamera) -> Self {
        let x = |column| camera.ray(f64::from(column), 0.0).x as f32;
        let y = |row| camera.ray(0.0, f64::from(row)).y as f32;
        Self {
            x: (0..camera.width).map(x).collect(),
            y: (0..camera.height).map(y).collect(),
        }
    }

    /// Rays along x of all pixels, row by row.
    fn x_of_pixels(&self) -> impl Iterator<Item = f32> + '_ {
        self.y.iter().flat_map(|_| self.x.iter().copied())
    }

    /// Rays along y of all pixels, row by row.
    fn y_of_pixels(&self) -> impl Iterator<Item = f32> + '_ {
        self.y.iter().flat_map(|&y| self.x.iter().map(move |_| y))
    }
}

/// Bits that a coordinate is expected to have. Without depth they are those of z: which NaN a
/// product has depends on the processor.
#[inline]
fn expected_bits(ray: f32, z: f32) -> u32 {
    if z.is_finite() {
        (ray * z).to_bits()
    } else {
        z.to_bits()
    }
}

/// Encodes a frame into `out`, which is cleared. The message number, the location in shared
/// memory and padding are left out; everything else is kept to the bit.
///
/// # Errors
/// When the header is invalid or does not fit the number of points.
pub fn encode_frame(
    header: &FrameHeader,
    points: &[CloudPoint],
    out: &mut Vec<u8>,
) -> Result<(), InvalidFrame> {
    let camera = header.checked(points.len(), u64::MAX)?.camera;
    let rays = Rays::new(&camera);
    out.clear();
    append_header(header, out);
    let flags_at = out.len();
    out.extend(0_u32.to_le_bytes());
    let n_points = points.len();
    let z = points.iter().map(|point| point.z.to_bits());
    let has_table = word_table::append(z.clone(), out);
    if !has_table {
        byte_planes::append(n_points, z, out);
    }
    let colors_at = out.len();
    byte_planes::append(n_points, points.iter().map(|point| point.argb), out);
    byte_planes::to_differences(&mut out[colors_at..]);
    let x = points.iter().zip(rays.x_of_pixels());
    let x = x.map(|(point, ray)| point.x.to_bits() ^ expected_bits(ray, point.z));
    let has_x = append_difference(n_points, x, out);
    let y = points.iter().zip(rays.y_of_pixels());
    let y = y.map(|(point, ray)| point.y.to_bits() ^ expected_bits(ray, point.z));
    let has_y = append_difference(n_points, y, out);
    let bit = |is_set: bool, bit: u32| if is_set { bit } else { 0 };
    let planes = bit(has_x, HAS_X) | bit(has_y, HAS_Y) | bit(has_table, HAS_Z_TABLE);
    out[flags_at..flags_at + 4].copy_from_slice(&planes.to_le_bytes());
    Ok(())
}

/// Appends the planes of a difference and returns true; nothing when all of it is zero.
fn append_difference(n_words: usize, words: impl Iterator<Item = u32>, out: &mut Vec<u8>) -> bool {
    let begin = out.len();
    byte_planes::append(n_words, words, out);
    let is_different = out[begin..].iter().any(|&byte| byte != 0);
    if !is_different {
        out.truncate(begin);
    }
    is_different
}

fn append_header(header: &FrameHeader, out: &mut Vec<u8>) {
    out.extend(VERSION.to_le_bytes());
    out.extend(header.flags.to_le_bytes());
    for number in [
        header.session,
        header.sequence,
        header.source_frame,
        header.capture_stamp_ns,
        header.scheduled_stamp_ns,
        header.published_stamp_ns,
    ] {
        out.extend(number.to_le_bytes());
    }
    out.extend(header.wall_clock_offset_ns.to_le_bytes());
    let rows = header.world_from_camera.rows.as_flattened();
    let numbers = header.intrinsics_px.iter().chain(rows);
    for number in numbers.chain(&header.up_in_camera) {
        out.extend(number.to_le_bytes());
    }
    for side in header.size_px {
        out.extend(side.to_le_bytes());
    }
    let name = header.source_name.as_str().unwrap_or_default().as_bytes();
    out.extend((name.len() as u32).to_le_bytes());
    out.extend(name);
}

fn read_header(fields: &mut FieldReader<'_>) -> Result<FrameHeader, InvalidRecord> {
    let version = fields.u32("version")?;
    if version != VERSION {
        return Err(InvalidRecord::Version {
            found: version,
            known: VERSION,
        });
    }
    let mut header = FrameHeader {
        flags: fields.u32("flags")?,
        session: fields.u64("session")?,
        sequence: fields.u64("sequence number")?,
        source_frame: fields.u64("frame number")?,
        capture_stamp_ns: fields.u64("capture stamp")?,
        scheduled_stamp_ns: fields.u64("scheduled stamp")?,
        published_stamp_ns: fields.u64("publication stamp")?,
        wall_clock_offset_ns: fields.i64("clock offset")?,
        intrinsics_px: fields.f64s("intrinsics")?,
        ..FrameHeader::default()
    };
    let mut pose = WireTransform::IDENTITY;
    for row in &mut pose.rows {
        *row = fields.f64s("camera pose")?;
    }
    header.world_from_camera = pose;
    header.up_in_camera = fields.f64s("up direction")?;
    header.size_px = [fields.u32("size")?, fields.u32("size")?];
    header.source_name = read_name(fields)?;
    Ok(header)
}

fn read_name(fields: &mut FieldReader<'_>) -> Result<Text, InvalidRecord> {
    let length = fields.u32("source name")? as usize;
    if length > Text::CAPACITY {
        return Err(InvalidRecord::Name);
    }
    let name = fields.bytes(length, "source name")?;
    let name = std::str::from_utf8(name).map_err(|_| InvalidRecord::Name)?;
    Ok(Text::truncated(name))
}

/// Recorded frame with a valid header, still encoded.
#[derive(Debug, Clone)]
pub struct FrameRecord<'a> {
    /// Header of the frame.
    pub header: FrameHeader,
    /// Camera intrinsics with the image size.
    pub camera: PinholeCamera,
    z: Depths<'a>,
    /// Planes of differences.
    argb: &'a [u8],
    /// Planes of the difference; `None` when there is none.
    x: Option<&'a [u8]>,
    y: Option<&'a [u8]>,
}

/// Encoded depths of a frame.
#[derive(Debug, Clone)]
enum Depths<'a> {
    Planes(&'a [u8]),
    Table(WordTable<'a>),
}

impl Depths<'_> {
    /// Sets the depth of each point.
    fn fill(&self, points: &mut [CloudPoint]) {
        match self {
            Self::Planes(planes) => set_depths(points, byte_planes::words(planes)),
            Self::Table(table) => set_depths(points, table.words()),
        }
    }
}

fn set_depths(points: &mut [CloudPoint], words: impl Iterator<Item = u32>) {
    for (point, word) in points.iter_mut().zip(words) {
        point.z = f32::from_bits(word);
    }
}

impl<'a> FrameRecord<'a> {
    /// Reads the header of an encoded frame and finds its planes.
    ///
    /// # Errors
    /// When the bytes are no frame of this version.
    pub fn parse(bytes: &'a [u8]) -> Result<Self, InvalidRecord> {
        let mut fields = FieldReader::new(bytes);
        let header = read_header(&mut fields)?;
        let planes = fields.u32("planes")?;
        if planes & !(HAS_X | HAS_Y | HAS_Z_TABLE) != 0 {
            return Err(InvalidRecord::Planes(planes));
        }
        let n_points = (u64::from(header.size_px[0]) * u64::from(header.size_px[1])) as usize;
        let camera = header.checked(n_points, u64::MAX)?.camera;
        let n_bytes = byte_planes::plane_bytes(n_points);
        let z = if planes & HAS_Z_TABLE == 0 {
            Depths::Planes(fields.bytes(n_bytes, "depth")?)
        } else {
            Depths::Table(WordTable::read(&mut fields, n_points)?)
        };
        let n_planes = 1 + (planes & (HAS_X | HAS_Y)).count_ones() as usize;
        let (found, needed) = (fields.rest().len(), n_planes * n_bytes);
        if found != needed {
            return Err(InvalidRecord::PointBytes { found, needed });
        }
        let mut next = || fields.bytes(n_bytes, "points");
        Ok(Self {
            header,
            camera,
            z,
            argb: next()?,
            x: (planes & HAS_X != 0).then(&mut next).transpose()?,
            y: (planes & HAS_Y != 0).then(next).transpose()?,
        })
    }

    /// Number of points of the frame.
    pub fn n_points(&self) -> usize {
        self.camera.n_pixels()
    }

    /// Decodes the points, row by row.
    ///
    /// # Errors
    /// When the buffer has another length; it is then unchanged.
    pub fn fill(&self, points: &mut [CloudPoint]) -> Result<(), InvalidRecord> {
        let (found, needed) = (points.len(), self.n_points());
        if found != needed {
            return Err(InvalidRecord::BufferLength { found, needed });
        }
        let rays = Rays::new(&self.camera);
        self.z.fill(points);
        let colors = byte_planes::words_of_differences(self.argb);
        let of_pixels = rays.x_of_pixels().zip(rays.y_of_pixels());
        for ((point, argb), (ray_x, ray_y)) in points.iter_mut().zip(colors).zip(of_pixels) {
            *point = CloudPoint {
                x: f32::from_bits(expected_bits(ray_x, point.z)),
                y: f32::from_bits(expected_bits(ray_y, point.z)),
                z: point.z,
                argb,
            };
        }
        if let Some(planes) = self.x {
            for (point, bits) in points.iter_mut().zip(byte_planes::words(planes)) {
                point.x = f32::from_bits(point.x.to_bits() ^ bits);
            }
        }
        if let Some(planes) = self.y {
            for (point, bits) in points.iter_mut().zip(byte_planes::words(planes)) {
                point.y = f32::from_bits(point.y.to_bits() ^ bits);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
