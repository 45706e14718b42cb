//! What can go wrong between the daemon and a Kinect.

use crate::{LibraryKind, RecordingError};
use std::{fmt, path::PathBuf};

/// Why the library or the camera can not be used.
#[derive(Debug)]
#[non_exhaustive]
pub enum Error {
    /// No library was found.
    LibraryMissing {
        /// Which one was looked for.
        kind: LibraryKind,
        /// Each place, with the loader's answer.
        tried: Vec<(PathBuf, String)>,
    },
    /// A library was found, but it is not libfreenect 0.5.
    SymbolMissing {
        /// The library.
        library: PathBuf,
        /// The function it lacks.
        symbol: &'static str,
        /// The loader's answer.
        source: libloading::Error,
    },
    /// Fakenect is to play a folder it must not be given.
    Recording(RecordingError),
    /// Fakenect was loaded, but the process was not started for a recording.
    NoRecording,
    /// Fakenect already plays in this process.
    FakeInUse,
    /// USB can not be used at all.
    UsbUnavailable {
        /// The code of libusb.
        code: i32,
    },
    /// The library sees no Kinect.
    NoKinect {
        /// What the USB bus shows, and what to do.
        advice: String,
    },
    /// There is a Kinect, but it can not be opened.
    CannotOpen {
        /// Which one was asked for.
        wanted: String,
        /// The library's code.
        code: i32,
        /// What the library said about it.
        said: String,
        /// Serials of the cameras that are there, when the library can tell.
        serials: Vec<String>,
        /// What the USB bus shows, and what to do.
        advice: String,
    },
    /// The library offers no image of 640x480 in the format needed.
    ModeMissing {
        /// `depth` or `video`.
        stream: &'static str,
    },
    /// A function of the library failed.
    CallFailed {
        /// The function.
        function: &'static str,
        /// Its code.
        code: i32,
        /// What the library said about it.
        said: String,
    },
    /// The library refused a buffer, or wrote a frame elsewhere than asked.
    Misbehaved,
    /// The Kinect stopped answering.
    Gone {
        /// The library's code.
        code: i32,
        /// What the library said about it.
        said: String,
    },
    /// The recording is played to its end.
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

/// Appends what the library said, if anything.
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
