//! Writer of fakenect recordings.

use super::error::Error;
use super::index::{FrameKind, MAX_PAUSE, file_name};
use super::{INDEX_NAME, NO_DEPTH, TILT_BYTES};
use file_access::FileError;
use file_access::{create_folder, write_atomic};
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Writer of a fakenect recording. A frame is listed after its file is complete, so that an
/// interrupted recording stays playable.
#[derive(Debug)]
pub struct FakenectWriter {
    folder: PathBuf,
    index: File,
    last_time: Option<Duration>,
    /// File buffer of one frame, reused.
    frame: Vec<u8>,
}

/// State of the accelerometer and the tilt motor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tilt {
    /// Acceleration along the sensor's axes; 819 is standard gravity.
    pub acceleration: [i16; 3],
    /// Tilt of the sensor, half degrees.
    pub half_degrees: i8,
    /// State of the tilt motor.
    pub motor: TiltMotor,
}

/// State of the tilt motor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(i32)]
pub enum TiltMotor {
    /// Tilt motor stands still and holds its position.
    Stopped = 0,
    /// Tilt motor has reached its mechanical limit.
    AtLimit = 1,
    /// Tilt motor is moving.
    Moving = 4,
}

impl FakenectWriter {
    /// Starts a recording in a folder, which is created if necessary.
    ///
    /// # Errors
    /// When the folder cannot be made or already holds a recording.
    pub fn create(folder: &Path) -> Result<Self, Error> {
        create_folder(folder)?;
        let path = folder.join(INDEX_NAME);
        let index = File::create_new(&path).map_err(FileError::io(&path, "create"))?;
        Ok(Self {
            folder: folder.to_owned(),
            index,
            last_time: None,
            frame: Vec::new(),
        })
    }

    /// Records a depth frame of 640 x 480 raw 11-bit values.
    ///
    /// # Errors
    /// When the frame has another size or other values, comes more than a
    /// minute after the one before, or cannot be written.
    pub fn write_depth(
        &mut self,
        raw_depth: &[u16],
        unix_time: Duration,
        stamp: u32,
    ) -> Result<(), Error> {
        if let Some(value) = raw_depth.iter().find(|value| **value > NO_DEPTH) {
            return Err(Error::RawDepth(*value));
        }
        self.begin(FrameKind::Depth);
        self.frame
            .extend(raw_depth.iter().flat_map(|value| value.to_le_bytes()));
        self.finish(FrameKind::Depth, 2, unix_time, stamp)
    }

    /// Records a colour frame of 640 x 480 pixels: red, green and blue.
    ///
    /// # Errors
    /// As [`FakenectWriter::write_depth`].
    pub fn write_color(
        &mut self,
        rgb: &[u8],
        unix_time: Duration,
        stamp: u32,
    ) -> Result<(), Error> {
        self.begin(FrameKind::Color);
        self.frame.extend_from_slice(rgb);
        self.finish(FrameKind::Color, 1, unix_time, stamp)
    }

    /// Records the state of the accelerometer and the tilt motor.
    ///
    /// # Errors
    /// When it comes more than a minute after the frame before, or cannot be
    /// written.
    pub fn write_tilt(&mut self, tilt: Tilt, unix_time: Duration, stamp: u32) -> Result<(), Error> {
        self.begin(FrameKind::Tilt);
        self.frame.extend(tilt.to_bytes());
        self.finish(FrameKind::Tilt, 1, unix_time, stamp)
    }

    fn begin(&mut self, kind: FrameKind) {
        self.frame.clear();
        self.frame.extend_from_slice(kind.header());
    }

    /// Validates and writes the frame, whose values have `value_bytes` each.
    fn finish(
        &mut self,
        kind: FrameKind,
        value_bytes: usize,
        unix_time: Duration,
        stamp: u32,
    ) -> Result<(), Error> {
        let n_bytes = self.frame.len() - kind.header().len();
        if n_bytes != kind.n_bytes() {
            let (found, needed) = (n_bytes / value_bytes, kind.n_bytes() / value_bytes);
            return Err(Error::FrameLength { found, needed });
        }
        if self
            .last_time
            .is_some_and(|last| unix_time > last + MAX_PAUSE)
        {
            return Err(Error::TimeGap);
        }
        let name = file_name(kind, unix_time, stamp);
        let path = self.folder.join(&name);
        write_atomic(&path, &self.frame)?;
        append(&mut self.index, &name).map_err(FileError::io(&self.folder, "write"))?;
        self.last_time = Some(unix_time);
        Ok(())
    }
}

/// Appends a line to the index in a single write, so that it is never partial.
fn append(index: &mut File, name: &str) -> io::Result<()> {
    index.write_all(format!("{name}\n").as_bytes())
}

impl Tilt {
    /// C structure `freenect_raw_tilt_state`: three `int16_t`, an `int8_t`, padding, an
    /// enumeration.
    fn to_bytes(self) -> [u8; TILT_BYTES] {
        let [[x0, x1], [y0, y1], [z0, z1]] = self.acceleration.map(i16::to_le_bytes);
        let [m0, m1, m2, m3] = (self.motor as i32).to_le_bytes();
        [
            x0,
            x1,
            y0,
            y1,
            z0,
            z1,
            self.half_degrees as u8,
            0,
            m0,
            m1,
            m2,
            m3,
        ]
    }
}
