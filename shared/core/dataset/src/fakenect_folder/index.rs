//! Index of a fakenect recording.

use super::error::Error;
use file_access::excerpt;
use std::time::Duration;

/// Maximum pause between two frames, for which the player sleeps.
pub(super) const MAX_PAUSE: Duration = Duration::from_secs(60);

/// Kind of a frame in a fakenect recording: depth, colour or accelerometer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrameKind {
    /// Raw 11-bit depth, 640 x 480.
    Depth,
    /// Colour: red, green and blue, 640 x 480.
    Color,
    /// Accelerometer and tilt motor state.
    Tilt,
}

/// Line of the index: one frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct IndexEntry {
    /// Kind of the recorded frame.
    pub kind: FrameKind,
    /// Arrival time of the frame since 1970.
    pub unix_time: Duration,
    /// Time stamp of the Kinect's own clock, about 60 MHz; it wraps around.
    pub stamp: u32,
    /// File name of the frame within the folder.
    pub file_name: String,
}

impl FrameKind {
    pub(super) const fn letter_and_extension(self) -> (&'static str, &'static str) {
        match self {
            Self::Depth => ("d", "pgm"),
            Self::Color => ("r", "ppm"),
            Self::Tilt => ("a", "dump"),
        }
    }
}

/// File name of a frame, as made by libfreenect's recorder.
pub(super) fn file_name(kind: FrameKind, unix_time: Duration, stamp: u32) -> String {
    let (letter, extension) = kind.letter_and_extension();
    let (seconds, micros) = (unix_time.as_secs(), unix_time.subsec_micros());
    format!("{letter}-{seconds}.{micros:06}-{stamp}.{extension}")
}

/// Parses the bytes of an `INDEX.txt`.
///
/// A name cannot lead out of the folder, since it has no other characters than
/// the pattern of names allows. Times may go backwards, as clocks do.
///
/// # Errors
/// When a line is not the name of a frame (the player takes a blank line for
/// the end), or a frame comes more than a minute after the one before.
pub fn parse_index(bytes: &[u8]) -> Result<Vec<IndexEntry>, Error> {
    let mut entries: Vec<IndexEntry> = Vec::new();
    let bytes = bytes.strip_suffix(b"\n").unwrap_or(bytes);
    for (idx, line) in bytes.split(|&byte| byte == b'\n').enumerate() {
        let error = |problem| Error::IndexLine {
            line: idx + 1,
            problem,
        };
        let name = std::str::from_utf8(line).map_err(|_| error("it is not text".to_owned()))?;
        let entry = parse_name(name).ok_or_else(|| {
            error(format!(
                "\"{}\" is no name like d-1290000000.5-123456.pgm",
                excerpt(name)
            ))
        })?;
        let latest = entries
            .last()
            .map_or(entry.unix_time, |last| last.unix_time + MAX_PAUSE);
        if entry.unix_time > latest {
            return Err(error(
                "it comes more than a minute after the one before".to_owned(),
            ));
        }
        entries.push(entry);
    }
    Ok(entries)
}

fn parse_name(name: &str) -> Option<IndexEntry> {
    let (rest, extension) = name.rsplit_once('.')?;
    let mut parts = rest.split('-');
    let (letter, time, stamp) = (parts.next()?, parts.next()?, parts.next()?);
    let kinds = [FrameKind::Depth, FrameKind::Color, FrameKind::Tilt];
    let kind = kinds
        .into_iter()
        .find(|k| k.letter_and_extension() == (letter, extension))?;
    if parts.next().is_some() || !is_number(stamp) {
        return None;
    }
    Some(IndexEntry {
        kind,
        unix_time: parse_time(time)?,
        stamp: stamp.parse().ok()?,
        file_name: name.to_owned(),
    })
}

/// Parses seconds with up to nine decimals.
fn parse_time(text: &str) -> Option<Duration> {
    let (seconds, decimals) = text.split_once('.').unwrap_or((text, "0"));
    if !is_number(seconds) || !is_number(decimals) || decimals.len() > 9 {
        return None;
    }
    let scale = 10_u32.pow(9 - decimals.len() as u32);
    let nanos: u32 = decimals.parse().ok()?;
    Some(Duration::new(seconds.parse().ok()?, nanos * scale))
}

fn is_number(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
}
