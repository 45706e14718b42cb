//! Closing of files on a thread of their own: what waits for the disk does not hold up the writer.

use crate::recording_folder::give_name;
use std::fs::File;
use std::io;
use std::path::PathBuf;
use std::thread::JoinHandle;

/// Closer of written files, at most one at a time.
#[derive(Debug, Default)]
pub(crate) struct FileCloser {
    running: Option<JoinHandle<Closed>>,
}

/// Path of a file while it was written, and its name or the failure.
pub(crate) type Closed = (PathBuf, io::Result<PathBuf>);

impl FileCloser {
    /// Begins to bring a file to the disk and to give it its name. Waits for the one before, and
    /// returns it, and the new one if it could not be begun.
    pub(crate) fn close(&mut self, path: PathBuf, file: File) -> [Option<Closed>; 2] {
        let before = self.wait();
        let at = path.clone();
        let thread = std::thread::Builder::new().name("closing".into());
        let started = thread.spawn(move || {
            // The lock of the file is held until it has its name.
            let closed = file.sync_all().and_then(|()| give_name(&at));
            (at, closed)
        });
        match started {
            Ok(running) => {
                self.running = Some(running);
                [before, None]
            }
            Err(error) => [before, Some((path, Err(error)))],
        }
    }

    /// Waits for the file that is being closed, if any.
    pub(crate) fn wait(&mut self) -> Option<Closed> {
        self.running.take()?.join().ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_closed_one_after_the_other() {
        let folder = tempfile::tempdir().unwrap();
        let mut closer = FileCloser::default();
        let mut close = |name: &str| {
            let path = folder.path().join(name);
            let file = File::create(&path).unwrap();
            closer.close(path, file)
        };
        assert!(close("a.mcap.active").iter().all(Option::is_none));
        let [before, failed] = close("b.mcap.active");
        assert!(before.unwrap().1.unwrap().ends_with("a.mcap"));
        assert!(failed.is_none());
        // The name is taken.
        let [before, _] = close("a.mcap.active");
        assert!(before.unwrap().1.unwrap().ends_with("b.mcap"));
        let (path, refused) = closer.wait().unwrap();
        assert!(path.ends_with("a.mcap.active") && refused.is_err());
    }
}
