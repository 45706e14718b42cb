//! Kind of library: real libfreenect or fakenect.

use std::fmt;

/// Kind of library: real libfreenect or fakenect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LibraryKind {
    /// Real library, which talks to a Kinect.
    Real,
    /// Fakenect: plays the folder named by the environment variable `FAKENECT_PATH` (see
    /// [`crate::restart_with_recording`]).
    ///
    /// It waits between entries as recorded, but never makes up for delays: a recording of 30 Hz
    /// plays about two per cent slow. At the end it stays there, even for a newly opened camera,
    /// until the last user of the library drops it; loaded again, it plays from the start, having
    /// leaked one file descriptor (it never closes `INDEX.txt`).
    Fake,
}

impl fmt::Display for LibraryKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Real => "libfreenect",
            Self::Fake => "fakenect (libfreenect's player of recordings)",
        })
    }
}
