//! Atomic output file of events: it has its name when it is complete.

use service::Failure;
use std::fs::Metadata;
use std::io::{BufWriter, IntoInnerError, Write};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Temporary file beside the output, which it replaces at the end.
pub(crate) struct EventsFile {
    file: BufWriter<NamedTempFile>,
    out: PathBuf,
}

impl EventsFile {
    /// Begins the events of a recording.
    ///
    /// # Errors
    /// When the output is the recording itself or no file, or its folder cannot be written.
    pub(crate) fn create(out: &Path, recording: &Path) -> Result<Self, Failure> {
        check_output(out, recording)?;
        let folder = out.parent().filter(|path| !path.as_os_str().is_empty());
        let file = NamedTempFile::with_prefix_in(".events-", folder.unwrap_or(Path::new(".")));
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
        let synced = flushed.and_then(|file| file.as_file().sync_all().map(|()| file));
        let persisted = synced.and_then(|file| Ok(file.persist(&out)?));
        persisted.map_err(|error| not_written(&out, &error))?;
        Ok(())
    }
}

fn check_output(out: &Path, recording: &Path) -> Result<(), Failure> {
    let Ok(existing) = std::fs::metadata(out) else {
        return Ok(());
    };
    let id = |metadata: &Metadata| (metadata.dev(), metadata.ino());
    let recording = std::fs::metadata(recording);
    let problem = if recording.is_ok_and(|recording| id(&recording) == id(&existing)) {
        "is the recording itself"
    } else if !existing.is_file() {
        "is no file"
    } else {
        return Ok(());
    };
    Err(Failure::usage(format!(
        "{} {problem}; name another file for the events",
        out.display()
    )))
}

fn not_written(out: &Path, error: &std::io::Error) -> Failure {
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
        assert!(refused.sentence.contains("no file"), "{refused}");
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
