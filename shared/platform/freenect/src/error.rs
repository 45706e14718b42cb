//! Errors of the library and the camera.

use crate::{LibraryKind, RecordingError};
use std::path::PathBuf;

/// Error of the library or the camera.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The libfreenect library was not found.
    #[error(
        "{kind} is not on this machine; install the Debian package libfreenect0.5 \
         (sudo apt-get install libfreenect0.5). Tried{}",
        tried_list(.tried)
    )]
    LibraryMissing {
        /// Kind of library that was searched for.
        kind: LibraryKind,
        /// Each place with the loader's error message.
        tried: Vec<(PathBuf, String)>,
    },
    /// Library file that is not libfreenect 0.5.
    #[error(
        "{} is not libfreenect 0.5: it has no function {symbol}; install the Debian package \
         libfreenect0.5",
        .library.display()
    )]
    SymbolMissing {
        /// Path of the libfreenect library.
        library: PathBuf,
        /// Name of the missing library function.
        symbol: &'static str,
        /// Error of the dynamic loader.
        source: libloading::Error,
    },
    /// Faulty recording for fakenect.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// Fakenect was loaded, but the environment names no recording.
    #[error(
        "fakenect was chosen, but the environment names no recording; start the camera with a \
         recording's folder, or choose the real Kinect"
    )]
    NoRecording,
    /// Second fakenect player in one process.
    #[error(
        "fakenect already plays a recording in this process, and it can play only one; close the \
         other camera first"
    )]
    FakeInUse,
    /// USB is unavailable.
    #[error(
        "USB cannot be used (libusb code {code}); check that /dev/bus/usb exists and that this \
         user may read it"
    )]
    UsbUnavailable {
        /// Error code returned by libusb.
        code: i32,
    },
    /// libfreenect finds no Kinect.
    #[error("no Kinect found: {advice}")]
    NoKinect {
        /// State of the USB bus, with the remedy.
        advice: String,
    },
    /// Kinect that was found but cannot be opened.
    #[error(
        "the Kinect with {wanted} cannot be opened (code {code}{}){}; {advice}",
        said_clause(.said),
        serials_clause(.serials)
    )]
    CannotOpen {
        /// Selector of the requested Kinect.
        wanted: String,
        /// Error code of libfreenect.
        code: i32,
        /// Log messages of libfreenect.
        said: String,
        /// Serial numbers of the present cameras, if the library can list them.
        serials: Vec<String>,
        /// State of the USB bus, with the remedy.
        advice: String,
    },
    /// Library without a 640x480 image in the required format.
    #[error(
        "the library offers no {stream} image of 640x480 in the format needed; install the Debian \
         package libfreenect0.5"
    )]
    ModeMissing {
        /// Name of the stream: `depth` or `video`.
        stream: &'static str,
    },
    /// A libfreenect function failed.
    #[error(
        "{function} failed (code {code}{}); unplug the Kinect and plug it in again",
        said_clause(.said)
    )]
    CallFailed {
        /// Name of the libfreenect function.
        function: &'static str,
        /// Error code that the function returned.
        code: i32,
        /// Log messages of libfreenect.
        said: String,
    },
    /// Library that rejected a buffer, or wrote a frame outside of it.
    #[error(
        "the library does not write frames into the buffers it is given; install the Debian \
         package libfreenect0.5"
    )]
    Misbehaved,
    /// The Kinect stopped responding.
    #[error(
        "the Kinect stopped answering (code {code}{}); check its USB plug and power supply, then \
         open it again",
        said_clause(.said)
    )]
    Gone {
        /// Error code of libfreenect.
        code: i32,
        /// Log messages of libfreenect.
        said: String,
    },
    /// The recording played by fakenect has ended.
    #[error("the recording is played to its end")]
    Ended,
}

/// List of the tried libraries, each with the loader's error message.
fn tried_list(tried: &[(PathBuf, String)]) -> String {
    let answers = tried
        .iter()
        .map(|(place, answer)| format!("{} ({answer})", place.display()));
    let list = answers.collect::<Vec<_>>().join("; ");
    if list.is_empty() {
        list
    } else {
        format!(": {list}")
    }
}

/// Clause with the library's log messages; empty without any.
fn said_clause(said: &str) -> String {
    if said.is_empty() {
        String::new()
    } else {
        format!(", it says: {said}")
    }
}

/// Clause with the present cameras; empty without any.
fn serials_clause(serials: &[String]) -> String {
    if serials.is_empty() {
        String::new()
    } else {
        format!("; cameras present: {}", serials.join(", "))
    }
}
