//! Errors of the library and the camera.

use crate::{LibraryKind, RecordingError};
use std::{fmt, path::PathBuf};

/// Error of the library or the camera.
#[derive(Debug)]
#[non_exhaustive]
pub enum Error {
    /// No library was found.
    LibraryMissing {
        /// Library that was searched for.
        kind: LibraryKind,
        /// Each place with the loader's error message.
        tried: Vec<(PathBuf, String)>,
    },
    /// A library was found, but it is not libfreenect 0.5.
    SymbolMissing {
        /// Path of the library.
        library: PathBuf,
        /// Name of the missing function.
        symbol: &'static str,
        /// Error of the loader.
        source: libloading::Error,
    },
    /// The recording for fakenect is faulty.
    Recording(RecordingError),
    /// Fakenect was loaded, but the environment names no recording.
    NoRecording,
    /// Another fakenect player is active in this process.
    FakeInUse,
    /// USB is unavailable.
    UsbUnavailable {
        /// Error code of libusb.
        code: i32,
    },
    /// The library finds no Kinect.
    NoKinect {
        /// State of the USB bus, with the remedy.
        advice: String,
    },
    /// A Kinect was found but cannot be opened.
    CannotOpen {
        /// Selector of the requested Kinect.
        wanted: String,
        /// Error code of the library.
        code: i32,
        /// Log messages of the library.
        said: String,
        /// Serial numbers of the present cameras, if the library can list them.
        serials: Vec<String>,
        /// State of the USB bus, with the remedy.
        advice: String,
    },
    /// The library offers no 640x480 image in the required format.
    ModeMissing {
        /// `depth` or `video`.
        stream: &'static str,
    },
    /// A library function failed.
    CallFailed {
        /// Name of the function.
        function: &'static str,
        /// Error code of the function.
        code: i32,
        /// Log messages of the library.
        said: String,
    },
    /// The library rejected a buffer, or wrote a frame outside of it.
    Misbehaved,
    /// The Kinect stopped responding.
    Gone {
        /// Error code of the library.
        code: i32,
        /// Log messages of the library.
        said: String,
    },
    /// The recording has ended.
    Ended,
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::LibraryMissing { kind, tried } => {
                write!(
                    f,
                    "{kind} is not on this machine; install the Debian package "
                )?;
                write!(
                    f,
                    "libfreenect0.5 (sudo apt-get install libfreenect0.5). Tried"
                )?;
                for (index, (place, answer)) in tried.iter().enumerate() {
                    let separator = if index == 0 { ": " } else { "; " };
                    write!(f, "{separator}{} ({answer})", place.display())?;
                }
                Ok(())
            }
            Self::SymbolMissing {
                library, symbol, ..
            } => write!(
                f,
                "{} is not libfreenect 0.5: it has no function {symbol}; install the Debian \
                 package libfreenect0.5",
                library.display()
            ),
            Self::Recording(error) => error.fmt(f),
            Self::NoRecording => f.write_str(
                "fakenect was chosen, but the environment names no recording; start the camera \
                 with a recording's folder, or choose the real Kinect",
            ),
            Self::FakeInUse => f.write_str(
                "fakenect already plays a recording in this process, and it can play only one; \
                 close the other camera first",
            ),
            Self::ModeMissing { stream } => write!(
                f,
                "the library offers no {stream} image of 640x480 in the format needed; install \
                 the Debian package libfreenect0.5"
            ),
            Self::Misbehaved => f.write_str(
                "the library does not write frames into the buffers it is given; install the \
                 Debian package libfreenect0.5",
            ),
            Self::Ended => f.write_str("the recording is played to its end"),
            _ => self.fmt_camera(f),
        }
    }
}

impl Error {
    /// The sentences about a camera, as opposed to the library.
    fn fmt_camera(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UsbUnavailable { code } => write!(
                f,
                "USB can not be used (libusb code {code}); check that /dev/bus/usb exists and \
                 that this user may read it"
            ),
            Self::NoKinect { advice } => write!(f, "no Kinect found: {advice}"),
            Self::CannotOpen {
                wanted,
                code,
                said,
                serials,
                advice,
            } => {
                write!(f, "the Kinect with {wanted} can not be opened (code {code}")?;
                said_clause(f, said)?;
                f.write_str(")")?;
                if !serials.is_empty() {
                    write!(f, "; cameras present: {}", serials.join(", "))?;
                }
                write!(f, "; {advice}")
            }
            Self::CallFailed {
                function,
                code,
                said,
            } => {
                write!(f, "{function} failed (code {code}")?;
                said_clause(f, said)?;
                f.write_str("); unplug the Kinect and plug it in again")
            }
            Self::Gone { code, said } => {
                write!(f, "the Kinect stopped answering (code {code}")?;
                said_clause(f, said)?;
                f.write_str("); check its USB plug and power supply, then open it again")
            }
            _ => Ok(()),
        }
    }
}

/// Clause with the library's log messages; empty without any.
fn said_clause(f: &mut fmt::Formatter<'_>, said: &str) -> fmt::Result {
    if said.is_empty() {
        Ok(())
    } else {
        write!(f, ", it says: {said}")
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::SymbolMissing { source, .. } => Some(source),
            Self::Recording(error) => error.source(),
            _ => None,
        }
    }
}

impl From<RecordingError> for Error {
    fn from(error: RecordingError) -> Self {
        Self::Recording(error)
    }
}
