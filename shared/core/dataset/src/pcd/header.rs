//! The text at the start of a PCD file.

use super::error::Error;
use super::layout::Layout;
use super::{MAX_BYTES, MAX_POINTS};
use crate::lzf;
use crate::number::excerpt;
use geometry::RigidTransform;
use nalgebra::{Quaternion, Translation3, UnitQuaternion};

/// Most bytes searched for the end of the header.
const MAX_HEADER_BYTES: usize = 1 << 16;

/// How far a quaternion's length may be from 1, as written by people.
const QUATERNION_TOLERANCE: f64 = 0.01;

/// How the points follow the header.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Encoding {
    /// A line of text for each point.
    Ascii,
    /// The points' bytes, little-endian, one point after the other.
    Binary,
    /// Two sizes, then LZF data of all values of the first field, of the
    /// second, and so on.
    BinaryCompressed,
}

/// What the header of a PCD file says, checked against itself and against the
/// number of bytes that follow it.
#[derive(Debug, Clone, PartialEq)]
pub struct Header {
    pub(super) layout: Layout,
    pub(super) encoding: Encoding,
    /// Where the data begins in the file.
    pub(super) data_offset: usize,
    width: usize,
    height: usize,
    viewpoint: RigidTransform,
}

impl Header {
    /// Reads the header of a PCD file. What it announces is there, or can be
    /// there when the data is text or compressed: memory for
    /// [`Header::n_points`] may be reserved.
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

    /// Whether the points have labels.
    pub fn has_labels(&self) -> bool {
        self.layout.label.is_some()
    }

    /// Whether the points have colours; otherwise they are grey.
    pub fn has_colors(&self) -> bool {
        self.layout.color.is_some()
    }

    /// How the points are stored.
    pub fn encoding(&self) -> Encoding {
        self.encoding
    }

    /// Where the sensor was: world from sensor.
    pub fn viewpoint(&self) -> RigidTransform {
        self.viewpoint
    }

    /// Bytes of all points in binary.
    pub(super) fn n_binary_bytes(&self) -> usize {
        self.n_points() * self.layout.point_bytes
    }

    /// The compressed bytes behind their two sizes.
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
        // The sides are looked at too: an empty cloud may be 0 x 2^60.
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

/// Translation, then a quaternion with its real part first.
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

const KEYS: [&str; 9] = [
    "VERSION",
    "FIELDS",
    "SIZE",
    "TYPE",
    "COUNT",
    "WIDTH",
    "HEIGHT",
    "VIEWPOINT",
    "POINTS",
];

/// One line of the header: its number, its first word and the others.
pub(super) struct Line<'a> {
    number: usize,
    key: &'static str,
    pub(super) words: Vec<&'a str>,
}

impl Line<'_> {
    pub(super) fn error(&self, problem: &str) -> Error {
        let problem = format!("\"{} …\": {problem}", self.key);
        Error::HeaderLine {
            line: self.number,
            problem,
        }
    }

    fn one_of(&self, allowed: &[&str]) -> Result<(), Error> {
        match self.words[..] {
            [word] if allowed.contains(&word) => Ok(()),
            _ => Err(self.error(&format!("it must be {}", allowed.join(" or ")))),
        }
    }

    /// The line's only word as a number.
    fn count(&self) -> Result<usize, Error> {
        if self.words.len() == 1 {
            self.number(0)
        } else {
            Err(self.error("it must be a number"))
        }
    }

    /// The word at `idx`, which must be there, as a number.
    pub(super) fn number(&self, idx: usize) -> Result<usize, Error> {
        let word = self.words[idx];
        word.parse()
            .map_err(|_| self.error(&format!("\"{}\" is not a count", excerpt(word))))
    }
}

/// The lines of the header before the last.
pub(super) struct Lines<'a>(Vec<Line<'a>>);

impl<'a> Lines<'a> {
    /// Splits the header, and tells how and where the data follows.
    fn split(bytes: &'a [u8]) -> Result<(Self, Encoding, usize), Error> {
        let mut lines = Vec::new();
        let mut rest = &bytes[..bytes.len().min(MAX_HEADER_BYTES)];
        let mut number = 0;
        loop {
            number += 1;
            let end = rest
                .iter()
                .position(|&byte| byte == b'\n')
                .ok_or(Error::NoData)?;
            let (line, after) = (&rest[..end], &rest[end + 1..]);
            let text = std::str::from_utf8(line).map_err(|_| Error::NoData)?;
            let data_offset = bytes.len().min(MAX_HEADER_BYTES) - after.len();
            rest = after;
            let mut words = text.split_ascii_whitespace();
            match words.next() {
                None => {}
                Some(word) if word.starts_with('#') => {}
                Some("DATA") => return Ok((Self(lines), encoding(words, number)?, data_offset)),
                Some(key) => push_line(&mut lines, number, key, words.collect())?,
            }
        }
    }

    pub(super) fn find(&self, key: &str) -> Option<&Line<'a>> {
        self.0.iter().find(|line| line.key == key)
    }

    pub(super) fn require(&self, key: &'static str) -> Result<&Line<'a>, Error> {
        self.find(key).ok_or(Error::MissingLine(key))
    }
}

fn encoding<'a>(words: impl Iterator<Item = &'a str>, line: usize) -> Result<Encoding, Error> {
    match words.collect::<Vec<_>>()[..] {
        ["ascii"] => Ok(Encoding::Ascii),
        ["binary"] => Ok(Encoding::Binary),
        ["binary_compressed"] => Ok(Encoding::BinaryCompressed),
        _ => {
            let problem = "DATA must be ascii, binary or binary_compressed".to_owned();
            Err(Error::HeaderLine { line, problem })
        }
    }
}

fn push_line<'a>(
    lines: &mut Vec<Line<'a>>,
    number: usize,
    key: &str,
    words: Vec<&'a str>,
) -> Result<(), Error> {
    let Some(&key) = KEYS.iter().find(|known| **known == key) else {
        let problem = format!("\"{}\" is no word of a PCD header", excerpt(key));
        return Err(Error::HeaderLine {
            line: number,
            problem,
        });
    };
    let line = Line { number, key, words };
    if lines.iter().any(|earlier| earlier.key == key) {
        return Err(line.error("it is there twice"));
    }
    lines.push(line);
    Ok(())
}
