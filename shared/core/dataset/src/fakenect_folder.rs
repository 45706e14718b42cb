//! Fakenect recordings: raw Kinect frames as libfreenect's `fakenect-record` writes them and
//! its fakenect library plays them.
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
//! past the end of a short one, and sleeps as long as two times differ.
//! [`FakenectFolder::open`] refuses all of this before the library sees it.

mod error;
mod folder;
mod index;
mod writer;

pub use error::Error;
pub use folder::FakenectFolder;
pub use index::{FrameKind, IndexEntry, parse_index};
pub use writer::{FakenectWriter, Tilt, TiltMotor};

/// Image width of depth and colour frames, pixels.
pub const WIDTH: usize = 640;

/// Image height of depth and colour frames, pixels.
pub const HEIGHT: usize = 480;

/// Raw depth value of a pixel without depth.
pub const NO_DEPTH: u16 = 2047;

/// File name of the recording's index.
pub(crate) const INDEX_NAME: &str = "INDEX.txt";

const DEPTH_HEADER: &[u8] = b"P5 640 480 65535\n";
const COLOR_HEADER: &[u8] = b"P6 640 480 255\n";

/// Size of an accelerometer file, bytes.
const TILT_BYTES: usize = 12;

impl FrameKind {
    /// Required header of a frame file.
    fn header(self) -> &'static [u8] {
        match self {
            Self::Depth => DEPTH_HEADER,
            Self::Color => COLOR_HEADER,
            Self::Tilt => &[],
        }
    }

    /// Size of the frame data after the header of the frame file, bytes.
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
