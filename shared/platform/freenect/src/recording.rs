//! Validation of a recorded folder before it is passed to fakenect.
//!
//! Fakenect trusts its folder: it ends the process (`exit(1)`) when a file is missing, copies 614
//! 400 or 921 600 bytes from a file of any length, stops for good at an empty line, and sleeps
//! inside the library through any pause between time stamps. So every file is checked first, as
//! fakenect will read it, and a faulty folder is rejected as a whole.
//!
//! A folder contains `INDEX.txt`, a list of file names in playing order, each
//! `<kind>-<seconds>-<stamp>.<anything>`: kind `d` (depth), `r` (colour) or `a` (accelerometer),
//! the time in seconds as a decimal, and the Kinect's 32-bit stamp.

use crate::raw::{DEPTH_BYTES, TiltState, VIDEO_BYTES};
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::time::Duration;

mod error;
pub use error::RecordingError;

/// Longest accepted pause between two entries. Fakenect sleeps through it uninterruptibly, and
/// the daemon guarantees to stop within 5 s.
pub const MAX_PAUSE: Duration = Duration::from_secs(2);

/// Maximum size of the index: an hour of both streams and the accelerometer is 14 MB.
const MAX_INDEX_BYTES: u64 = 64 << 20;
/// Maximum length of an image's header line, bytes.
const MAX_HEADER_BYTES: usize = 64;

/// Contents of a valid recording folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RecordingSummary {
    /// Number of recorded depth images.
    pub n_depth: usize,
    /// Number of recorded colour images.
    pub n_video: usize,
    /// Number of recorded accelerometer readings.
    pub n_acceleration: usize,
    /// Playing time: sum of all forward steps in time.
    pub duration: Duration,
}

/// Entry of the recording's index file.
#[derive(Debug, Clone, Copy, PartialEq)]
struct IndexEntry<'a> {
    kind: EntryKind,
    seconds: f64,
    file_name: &'a str,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum EntryKind {
    Depth,
    Video,
    Acceleration,
}

/// Validates that fakenect can play the folder to its end.
///
/// Reads the index and the head of every file: about 10 µs per cached file.
///
/// # Errors
/// Names the faulty file or line and its fault.
pub fn check_recording(folder: &Path) -> Result<RecordingSummary, RecordingError> {
    let index_path = folder.join("INDEX.txt");
    let index = read_index(folder, &index_path)?;
    let mut summary = RecordingSummary::default();
    let mut previous_seconds = None;
    // Only the last line may be empty.
    let lines = index.strip_suffix('\n').unwrap_or(&index).split('\n');
    for (index, line) in lines.enumerate() {
        let wrong_line = |rule| RecordingError::WrongLine {
            index: index_path.clone(),
            line_number: index + 1,
            rule,
        };
        let entry = parse_line(line).map_err(wrong_line)?;
        let pause = pause_before(entry.seconds, previous_seconds).map_err(wrong_line)?;
        previous_seconds = Some(entry.seconds);
        check_file(&folder.join(entry.file_name), entry.kind)?;
        summary.add(entry.kind, pause);
    }
    Ok(summary)
}

impl RecordingSummary {
    fn add(&mut self, kind: EntryKind, pause: Duration) {
        match kind {
            EntryKind::Depth => self.n_depth += 1,
            EntryKind::Video => self.n_video += 1,
            EntryKind::Acceleration => self.n_acceleration += 1,
        }
        self.duration = self.duration.saturating_add(pause);
    }
}

fn read_index(folder: &Path, index_path: &Path) -> Result<String, RecordingError> {
    if !folder.is_dir() {
        return Err(RecordingError::NoFolder {
            folder: folder.to_owned(),
        });
    }
    let unreadable = |source| RecordingError::Unreadable {
        file: index_path.to_owned(),
        source,
    };
    let file = open_regular(index_path)?;
    let mut text = String::new();
    file.take(MAX_INDEX_BYTES + 1)
        .read_to_string(&mut text)
        .map_err(unreadable)?;
    if text.len() as u64 > MAX_INDEX_BYTES {
        return Err(unreadable(io::Error::other("it is longer than 64 MB")));
    }
    Ok(text)
}

/// Opens a regular file; pipes and devices could block fakenect.
fn open_regular(path: &Path) -> Result<File, RecordingError> {
    let unreadable = |source| RecordingError::Unreadable {
        file: path.to_owned(),
        source,
    };
    if !fs::metadata(path).map_err(unreadable)?.is_file() {
        return Err(unreadable(io::Error::other("it is not a regular file")));
    }
    File::open(path).map_err(unreadable)
}

/// Parses a line of the index, more strictly than fakenect's `sscanf`.
fn parse_line(line: &str) -> Result<IndexEntry<'_>, &'static str> {
    if line.is_empty() {
        return Err("an empty line, at which fakenect would stop");
    }
    if line.contains(['/', '\0', '\r']) {
        return Err("a file name must not hold a slash, a carriage return or a null");
    }
    let mut parts = line.splitn(3, '-');
    let kind = match parts.next() {
        Some("d") => EntryKind::Depth,
        Some("r") => EntryKind::Video,
        Some("a") => EntryKind::Acceleration,
        _ => return Err("a file name must begin with d-, r- or a-"),
    };
    let seconds = parts.next().and_then(parse_seconds);
    let seconds = seconds.ok_or("the time must be a decimal number of seconds")?;
    let stamp = parts.next().unwrap_or_default();
    let digits = stamp
        .split(|c: char| !c.is_ascii_digit())
        .next()
        .unwrap_or_default();
    let stamp: Result<u32, _> = digits.parse();
    stamp.map_err(|_| "the stamp must be a whole number below 2^32")?;
    Ok(IndexEntry {
        kind,
        seconds,
        file_name: line,
    })
}

/// Parses a plain decimal such as `1288.25`; no sign, exponent, infinity or NaN.
fn parse_seconds(text: &str) -> Option<f64> {
    let plain = text
        .bytes()
        .all(|byte| byte.is_ascii_digit() || byte == b'.');
    text.parse()
        .ok()
        .filter(|seconds: &f64| plain && seconds.is_finite())
}

/// Pause fakenect makes before an entry; 0 for a step back in time.
fn pause_before(seconds: f64, previous: Option<f64>) -> Result<Duration, &'static str> {
    let step = previous.map_or(0.0, |previous| (seconds - previous).max(0.0));
    Duration::try_from_secs_f64(step)
        .ok()
        .filter(|pause| *pause <= MAX_PAUSE)
        .ok_or("the pause before this entry is longer than 2 s, which fakenect would sleep through")
}

/// Validates that a file contains the bytes fakenect will copy from it.
fn check_file(path: &Path, kind: EntryKind) -> Result<(), RecordingError> {
    let wrong = |rule| RecordingError::WrongFile {
        file: path.to_owned(),
        rule,
    };
    let mut file = open_regular(path)?;
    let unreadable = |source| RecordingError::Unreadable {
        file: PathBuf::from(path),
        source,
    };
    let length = file.metadata().map_err(unreadable)?.len();
    let (header, n_bytes, rule) = match kind {
        EntryKind::Depth => (["P5", "640", "480", "65535"], DEPTH_BYTES, DEPTH_RULE),
        EntryKind::Video => (["P6", "640", "480", "255"], VIDEO_BYTES, VIDEO_RULE),
        EntryKind::Acceleration => {
            let expected = size_of::<TiltState>() as u64;
            return if length == expected {
                Ok(())
            } else {
                Err(wrong(ACCELERATION_RULE))
            };
        }
    };
    let mut head = [0; MAX_HEADER_BYTES];
    let n_read = read_head(&mut file, &mut head).map_err(unreadable)?;
    let line = head[..n_read]
        .split_inclusive(|byte| *byte == b'\n')
        .next()
        .unwrap_or_default();
    let words = std::str::from_utf8(line).unwrap_or_default();
    let is_header = words.ends_with('\n') && words.split_ascii_whitespace().eq(header);
    if !is_header || length != (line.len() + n_bytes) as u64 {
        return Err(wrong(rule));
    }
    Ok(())
}

const DEPTH_RULE: &str = "a depth image is one line `P5 640 480 65535` and 614400 bytes";
const VIDEO_RULE: &str = "a colour image is one line `P6 640 480 255` and 921600 bytes";
const ACCELERATION_RULE: &str = "an accelerometer reading has 12 bytes";

fn read_head(file: &mut File, head: &mut [u8]) -> io::Result<usize> {
    let mut n_read = 0;
    while n_read < head.len() {
        match file.read(&mut head[n_read..])? {
            0 => break,
            n => n_read += n,
        }
    }
    Ok(n_read)
}

#[cfg(test)]
mod tests;
