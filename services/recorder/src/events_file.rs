//! Atomic output file of events: it has its name when it is complete.

use dataset::{OutputFile, check_output};
use service::Failure;
use std::io::{BufWriter, IntoInnerError, Write};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

/// Temporary file beside the output, which it replaces at the end.
pub(crate) struct EventsFile {
    file: BufWriter<OutputFile>,
    out: PathBuf,
}

impl EventsFile {
    /// Begins the events of a recording.
    ///
    /// # Errors
    /// When the output is the recording itself or no file, or its folder cannot be written.
    pub(crate) fn create(out: &Path, recording: &Path) -> Result<Self, Failure> {
        check_is_other(out, recording)?;
        check_output(out).map_err(Failure::usage)?;
        let file = OutputFile::create_private(out);
        Ok(Self {
            file: BufWriter::new(file.map_err(|error| not_written(out, &error))?),
            out: out.to_owned(),
        })
    }

    /// Appends lines.
    ///
    /// # Errors
    /// When the disk cannot be written.
    pub(crate) fn append(&mut self, lines: &str) -> Result<(), Failure> {
        let written = self.file.write_all(lines.as_bytes());
        written.map_err(|error| not_written(&self.out, &error))
    }

    /// Puts the complete events in the place of the output.
    ///
    /// # Errors
    /// When the disk cannot be written; the output is then as it was.
    pub(crate) fn finish(self) -> Result<(), Failure> {
        let Self { file, out } = self;
        let flushed = file.into_inner().map_err(IntoInnerError::into_error);
        let file = flushed.map_err(|error| not_written(&out, &error))?;
        file.finish().map_err(|error| not_written(&out, &error))
    }
}

fn check_is_other(out: &Path, recording: &Path) -> Result<(), Failure> {
    let id = |path: &Path| {
        let metadata = std::fs::metadata(path).ok()?;
        Some((metadata.dev(), metadata.ino()))
    };
    if id(out).is_none() || id(out) != id(recording) {
        return Ok(());
    }
    Err(Failure::usage(format!(
        "{} is the recording itself; name another file for the events",
        out.display()
    )))
}

fn not_written(out: &Path, error: &impl std::fmt::Display) -> Failure {
    Failure::general(format!(
        "the events {} could not be written: {error}; free disk space, or name a file in another \
         folder",
        out.display()
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn events_never_replace_their_recording() {
        let folder = tempfile::tempdir().unwrap();
        let recording = folder.path().join("a.mcap");
        std::fs::write(&recording, "frames").unwrap();
        let link = folder.path().join("link");
        std::os::unix::fs::symlink(&recording, &link).unwrap();
        for out in [&recording, &link] {
            let refused = EventsFile::create(out, &recording).err().unwrap();
            assert!(refused.sentence.contains("recording itself"), "{refused}");
        }
        let refused = EventsFile::create(folder.path(), &recording).err().unwrap();
        assert!(refused.sentence.contains("is a folder"), "{refused}");
        assert_eq!(std::fs::read_to_string(&recording).unwrap(), "frames");
    }

    #[test]
    fn events_of_an_unfinished_replay_leave_the_output_as_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("events");
        std::fs::write(&out, "before").unwrap();
        let begin = || {
            let mut events = EventsFile::create(&out, Path::new("a.mcap")).unwrap();
            events.append("after").unwrap();
            events
        };
        drop(begin());
        assert_eq!(std::fs::read_to_string(&out).unwrap(), "before");
        begin().finish().unwrap();
        assert_eq!(std::fs::read_to_string(&out).unwrap(), "after");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
