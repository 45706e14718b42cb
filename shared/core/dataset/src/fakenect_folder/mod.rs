//! Folders of a Kinect's raw frames, as libfreenect's `fakenect-record` writes
//! them and its fakenect library plays them.
//!
//! `INDEX.txt` lists the frames' files in the order of their arrival, one name
//! on each line: `<d|r|a>-<unix time, seconds>-<u32 stamp>.<pgm|ppm|dump>`.
//!
//! | kind | file |
//! |---|---|
//! | `d` depth | `P5 640 480 65535`, newline, little-endian 11-bit values; 2047 is none |
//! | `r` colour | `P6 640 480 255`, newline, red, green, blue bytes |
//! | `a` accelerometer | the 12 bytes of C's `freenect_raw_tilt_state` |
//!
//! The fakenect library ends the process when a listed file is missing, reads
//! behind the end of a short one, and sleeps as long as two times differ.
//! [`FakenectFolder::open`] refuses all of this before the library sees it.

mod error;
mod folder;
mod index;
mod writer;

pub use error::Error;
pub use folder::FakenectFolder;
pub use index::{Entry, FrameKind, parse_index};
pub use writer::{FakenectWriter, Tilt, TiltMotor};

/// Columns of depth and colour frames.
pub const WIDTH: usize = 640;

/// Rows of depth and colour frames.
pub const HEIGHT: usize = 480;

/// The raw depth of a pixel without depth.
pub const NO_DEPTH: u16 = 2047;

/// The name of the list of frames.
pub(crate) const INDEX_NAME: &str = "INDEX.txt";

const DEPTH_HEADER: &[u8] = b"P5 640 480 65535\n";
const COLOR_HEADER: &[u8] = b"P6 640 480 255\n";

/// Bytes of an accelerometer file.
const TILT_BYTES: usize = 12;

impl FrameKind {
    /// How a file of this kind begins.
    fn header(self) -> &'static [u8] {
        match self {
            Self::Depth => DEPTH_HEADER,
            Self::Color => COLOR_HEADER,
            Self::Tilt => &[],
        }
    }

    /// Bytes behind the header.
    fn n_bytes(self) -> usize {
        match self {
            Self::Depth => 2 * WIDTH * HEIGHT,
            Self::Color => 3 * WIDTH * HEIGHT,
            Self::Tilt => TILT_BYTES,
        }
    }
}

#[cfg(test)]
mod tests;
