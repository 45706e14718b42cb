//! Upload of an export file: an unnamed temporary file with a limit, which leaves disk free.

use message::control::{Refusal, RefusalKind};
use std::fs::{self, File};
use std::io;
use std::os::unix::fs::{DirBuilderExt, FileExt};
use std::path::{Path, PathBuf};

const BYTES_PER_MB: u64 = 1 << 20;

/// Limits of all uploads together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct UploadLimits {
    /// Maximum number of uploaded bytes that are kept at the same time.
    pub max_bytes: u64,
    /// Disk space that an upload leaves free, bytes.
    pub free_disk_min_bytes: u64,
}

/// Uploaded file. It has no name, so that its bytes are freed with it, however its process ends.
#[derive(Debug)]
pub(crate) struct Upload {
    file: File,
    folder: PathBuf,
}

impl Upload {
    /// Begins an upload on the disk of a folder, which is created for this user only.
    pub(crate) fn begin(folder: &Path) -> Result<Self, Refusal> {
        let create = || {
            fs::DirBuilder::new()
                .recursive(true)
                .mode(0o700)
                .create(folder)?;
            tempfile::tempfile_in(folder)
        };
        Ok(Self {
            file: create().map_err(|error| not_kept(folder, &error))?,
            folder: folder.to_owned(),
        })
    }

    /// Writes bytes at an offset. `n_others` is the length of all other uploads, bytes.
    pub(crate) fn write(
        &self,
        offset: u64,
        bytes: &[u8],
        n_others: u64,
        limits: &UploadLimits,
    ) -> Result<(), Refusal> {
        let end = offset.saturating_add(bytes.len() as u64);
        let end = end.max(self.n_bytes());
        if end.saturating_add(n_others) > limits.max_bytes {
            let sentence = format!(
                "all imports together may have {} MB; raise [memory] import_max_mb, or import \
                 smaller files",
                limits.max_bytes / BYTES_PER_MB
            );
            return Err(Refusal::new(RefusalKind::Invalid, sentence));
        }
        // Holes of the file may be filled later.
        let n_more = end - self.n_written().min(end);
        self.leaves_free(n_more, limits.free_disk_min_bytes)?;
        let written = self.file.write_all_at(bytes, offset);
        written.map_err(|error| not_kept(&self.folder, &error))
    }

    /// Length, bytes.
    pub(crate) fn n_bytes(&self) -> u64 {
        self.file.metadata().map_or(0, |metadata| metadata.len())
    }

    /// Another handle of the file; both have one position.
    pub(crate) fn open(&self) -> io::Result<File> {
        self.file.try_clone()
    }

    /// Bytes that have their place on the disk.
    fn n_written(&self) -> u64 {
        use std::os::unix::fs::MetadataExt;
        self.file
            .metadata()
            .map_or(0, |metadata| 512 * metadata.blocks())
    }

    fn leaves_free(&self, n_more: u64, free_min: u64) -> Result<(), Refusal> {
        let disk =
            rustix::fs::fstatvfs(&self.file).map_err(|error| not_kept(&self.folder, &error))?;
        let free = disk.f_bavail.saturating_mul(disk.f_frsize);
        if free >= free_min.saturating_add(n_more) {
            return Ok(());
        }
        let sentence = format!(
            "the disk of {} has {} MB left, and {} MB are kept free; make room, or lower [memory] \
             free_disk_min_mb",
            self.folder.display(),
            free / BYTES_PER_MB,
            free_min / BYTES_PER_MB
        );
        Err(Refusal::new(RefusalKind::Unavailable, sentence))
    }
}

fn not_kept(folder: &Path, error: &dyn std::fmt::Display) -> Refusal {
    let sentence = format!(
        "the bytes of the import cannot be kept in {}: {error}; see that the disk has room",
        folder.display()
    );
    Refusal::new(RefusalKind::Unavailable, sentence)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Read;

    const LIMITS: UploadLimits = UploadLimits {
        max_bytes: 100,
        free_disk_min_bytes: 0,
    };

    #[test]
    fn upload_is_read_as_it_was_written_and_has_no_name() {
        let folder = tempfile::tempdir().unwrap();
        let upload = Upload::begin(&folder.path().join("exchange")).unwrap();
        upload.write(3, b"lo", 0, &LIMITS).unwrap();
        upload.write(0, b"hel", 0, &LIMITS).unwrap();
        let mut text = String::new();
        upload.open().unwrap().read_to_string(&mut text).unwrap();
        assert_eq!(text, "hello");
        let names = fs::read_dir(folder.path().join("exchange")).unwrap();
        assert_eq!(names.count(), 0);
    }

    #[test]
    fn upload_stays_below_the_limit_of_all() {
        let folder = tempfile::tempdir().unwrap();
        let upload = Upload::begin(folder.path()).unwrap();
        upload.write(0, &[1; 60], 40, &LIMITS).unwrap();
        // Written again, it does not count twice.
        upload.write(0, &[1; 60], 40, &LIMITS).unwrap();
        for (offset, n_others) in [(60, 40), (u64::MAX, 0), (99, 0)] {
            let refused = upload
                .write(offset, &[1; 2], n_others, &LIMITS)
                .unwrap_err();
            assert_eq!(refused.kind, RefusalKind::Invalid, "{offset}");
        }
        assert_eq!(upload.n_bytes(), 60);
    }

    #[test]
    fn upload_leaves_disk_free() {
        let folder = tempfile::tempdir().unwrap();
        let upload = Upload::begin(folder.path()).unwrap();
        let limits = UploadLimits {
            free_disk_min_bytes: u64::MAX,
            ..LIMITS
        };
        let refused = upload.write(0, &[1; 8], 0, &limits).unwrap_err();
        assert_eq!(refused.kind, RefusalKind::Unavailable);
        assert!(refused.sentence.contains("kept free"), "{refused}");
    }
}
