//! Upload of an export file or a document: an unnamed temporary file with a limit, which leaves
//! disk free, or a small document in memory.

use control_protocol::{DOCUMENT_PAGE_BYTES, Refusal, RefusalKind};
use parking_lot::Mutex;
use std::fs::{self, File};
use std::os::unix::fs::{DirBuilderExt, FileExt, MetadataExt};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

const BYTES_PER_MB: u64 = 1 << 20;
/// Maximum length of a document that is uploaded into memory, bytes: one page.
const MAX_IN_MEMORY: u64 = DOCUMENT_PAGE_BYTES as u64;

/// Limits of all uploads together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct UploadLimits {
    /// Maximum number of uploaded bytes that are kept at the same time.
    pub max_bytes: u64,
    /// Disk space that an upload leaves free, bytes.
    pub free_disk_min_bytes: u64,
}

/// Uploaded file or document. A file has no name, so that its bytes are freed with it, however its
/// process ends.
#[derive(Debug)]
pub(crate) struct Upload {
    folder: PathBuf,
    /// Maximum length, bytes.
    max_bytes: u64,
    n_bytes: AtomicU64,
    content: Mutex<UploadedContent>,
}

#[derive(Debug)]
enum UploadedContent {
    /// At most [`MAX_IN_MEMORY`].
    Memory(Vec<u8>),
    File(File),
}

impl Upload {
    /// Begins the upload of an import on the disk of a folder, which is created for this user only.
    pub(crate) fn of_import(folder: &Path) -> Result<Self, Refusal> {
        let file = temporary_file(folder)?;
        Ok(Self::new(folder, u64::MAX, UploadedContent::File(file)))
    }

    /// Begins the upload of a document of at most `max_bytes`. It is in memory until it is longer
    /// than a page, then on the disk of the folder; so a note can be stored whatever the disk has
    /// left beside the store.
    pub(crate) fn of_document(folder: &Path, max_bytes: u64) -> Self {
        Self::new(folder, max_bytes, UploadedContent::Memory(Vec::new()))
    }

    fn new(folder: &Path, max_bytes: u64, content: UploadedContent) -> Self {
        Self {
            folder: folder.to_owned(),
            max_bytes,
            n_bytes: AtomicU64::new(0),
            content: Mutex::new(content),
        }
    }

    /// Writes bytes at an offset; waits for the disk. `n_others` is the length of all other uploads,
    /// bytes.
    pub(crate) fn write(
        &self,
        offset: u64,
        bytes: &[u8],
        n_others: u64,
        limits: &UploadLimits,
    ) -> Result<(), Refusal> {
        let mut content = self.content.lock();
        let end = offset.saturating_add(bytes.len() as u64);
        let end = end.max(self.n_bytes());
        self.check_length(end, n_others, limits)?;
        if let UploadedContent::Memory(begun) = &mut *content {
            if end <= MAX_IN_MEMORY {
                begun.resize(end as usize, 0);
                let place = begun.iter_mut().skip(offset as usize);
                place.zip(bytes).for_each(|(place, byte)| *place = *byte);
                self.n_bytes.store(end, Ordering::Relaxed);
                return Ok(());
            }
            let file = temporary_file(&self.folder)?;
            self.leaves_free(&file, end, limits.free_disk_min_bytes)?;
            let moved = file.write_all_at(begun, 0);
            moved.map_err(|error| not_kept(&self.folder, &error))?;
            *content = UploadedContent::File(file);
        }
        if let UploadedContent::File(file) = &*content {
            // Holes of the file may be filled later.
            let n_more = end - n_written(file).min(end);
            self.leaves_free(file, n_more, limits.free_disk_min_bytes)?;
            let written = file.write_all_at(bytes, offset);
            written.map_err(|error| not_kept(&self.folder, &error))?;
        }
        self.n_bytes.store(end, Ordering::Relaxed);
        Ok(())
    }

    fn check_length(&self, end: u64, n_others: u64, limits: &UploadLimits) -> Result<(), Refusal> {
        let sentence = if end > self.max_bytes {
            format!(
                "byte {end} was sent of a document, which may have {} bytes; store a smaller one",
                self.max_bytes
            )
        } else if end.saturating_add(n_others) > limits.max_bytes {
            format!(
                "all uploads together may have {} MB; raise [memory] import_max_mb, or send less",
                limits.max_bytes / BYTES_PER_MB
            )
        } else {
            return Ok(());
        };
        Err(Refusal::new(RefusalKind::Invalid, sentence))
    }

    /// Length, bytes; does not wait.
    pub(crate) fn n_bytes(&self) -> u64 {
        self.n_bytes.load(Ordering::Relaxed)
    }

    /// All bytes of a document; waits for the disk.
    pub(crate) fn read(&self) -> Result<Vec<u8>, Refusal> {
        match &*self.content.lock() {
            UploadedContent::Memory(bytes) => Ok(bytes.clone()),
            UploadedContent::File(file) => {
                let mut bytes = vec![0; self.n_bytes() as usize];
                let read = file.read_exact_at(&mut bytes, 0);
                read.map_err(|error| not_read(&self.folder, &error))?;
                Ok(bytes)
            }
        }
    }

    /// Another handle of the file of an import; both have one position.
    pub(crate) fn open(&self) -> Result<File, Refusal> {
        match &*self.content.lock() {
            UploadedContent::File(file) => {
                let opened = file.try_clone();
                opened.map_err(|error| not_read(&self.folder, &error))
            }
            UploadedContent::Memory(_) => {
                let sentence = "this upload is a document; store it as one";
                Err(Refusal::new(RefusalKind::Invalid, sentence))
            }
        }
    }

    fn leaves_free(&self, file: &File, n_more: u64, free_min: u64) -> Result<(), Refusal> {
        let disk = rustix::fs::fstatvfs(file).map_err(|error| not_kept(&self.folder, &error))?;
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

/// File without a name in a folder, which is created for this user only.
fn temporary_file(folder: &Path) -> Result<File, Refusal> {
    let create = || {
        fs::DirBuilder::new()
            .recursive(true)
            .mode(0o700)
            .create(folder)?;
        tempfile::tempfile_in(folder)
    };
    create().map_err(|error| not_kept(folder, &error))
}

/// Bytes that have their place on the disk.
fn n_written(file: &File) -> u64 {
    file.metadata()
        .map_or(0, |metadata| 512 * metadata.blocks())
}

fn not_read(folder: &Path, error: &dyn std::fmt::Display) -> Refusal {
    let sentence = format!(
        "the uploaded bytes cannot be read again from {}: {error}; upload them again",
        folder.display()
    );
    Refusal::new(RefusalKind::Unavailable, sentence)
}

fn not_kept(folder: &Path, error: &dyn std::fmt::Display) -> Refusal {
    let sentence = format!(
        "the uploaded bytes cannot be kept in {}: {error}; see that the disk has room",
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
        let upload = Upload::of_import(&folder.path().join("exchange")).unwrap();
        upload.write(3, b"lo", 0, &LIMITS).unwrap();
        upload.write(0, b"hel", 0, &LIMITS).unwrap();
        let mut text = String::new();
        upload.open().unwrap().read_to_string(&mut text).unwrap();
        assert_eq!(text, "hello");
        assert_eq!(upload.read().unwrap(), b"hello");
        let names = fs::read_dir(folder.path().join("exchange")).unwrap();
        assert_eq!(names.count(), 0);
    }

    #[test]
    fn upload_stays_below_the_limit_of_all() {
        let folder = tempfile::tempdir().unwrap();
        let upload = Upload::of_import(folder.path()).unwrap();
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

    const ROOMY: UploadLimits = UploadLimits {
        max_bytes: u64::MAX,
        free_disk_min_bytes: 0,
    };

    #[test]
    fn document_stays_below_its_own_limit() {
        for max_bytes in [10, 2 * MAX_IN_MEMORY] {
            let folder = tempfile::tempdir().unwrap();
            let upload = Upload::of_document(folder.path(), max_bytes);
            let last = max_bytes - 8;
            upload.write(last, &[1; 8], 0, &ROOMY).unwrap();
            for offset in [last + 1, max_bytes, u64::MAX - 7, u64::MAX] {
                let refused = upload.write(offset, &[1; 8], 0, &ROOMY).unwrap_err();
                assert_eq!(refused.kind, RefusalKind::Invalid, "{offset}");
                assert!(refused.sentence.contains("bytes; store"), "{refused}");
            }
            let read = upload.read().unwrap();
            assert_eq!(read.len() as u64, max_bytes);
            assert_eq!(read.iter().map(|byte| u64::from(*byte)).sum::<u64>(), 8);
        }
    }

    /// The bytes of a document are the same in memory and on the disk, in any order of writing.
    #[test]
    fn document_moves_to_the_disk_when_it_is_longer_than_a_page() {
        let folder = tempfile::tempdir().unwrap();
        let exchange = folder.path().join("exchange");
        let upload = Upload::of_document(&exchange, u64::MAX);
        upload.write(2, b"cd", 0, &ROOMY).unwrap();
        upload.write(0, b"ab", 0, &ROOMY).unwrap();
        assert_eq!(upload.read().unwrap(), b"abcd");
        assert!(!exchange.exists(), "nothing is on the disk");
        upload.write(MAX_IN_MEMORY, b"end", 0, &ROOMY).unwrap();
        upload.write(1, b"BC", 0, &ROOMY).unwrap();
        let read = upload.read().unwrap();
        assert_eq!(read.len() as u64, MAX_IN_MEMORY + 3);
        assert!(read.starts_with(b"aBCd\0") && read.ends_with(b"\0end"));
    }

    #[test]
    fn small_document_needs_no_free_disk_and_a_large_one_does() {
        let folder = tempfile::tempdir().unwrap();
        let limits = UploadLimits {
            free_disk_min_bytes: u64::MAX,
            ..ROOMY
        };
        let upload = Upload::of_document(folder.path(), u64::MAX);
        upload.write(0, b"note", 0, &limits).unwrap();
        let refused = upload.write(MAX_IN_MEMORY, b"x", 0, &limits).unwrap_err();
        assert_eq!(refused.kind, RefusalKind::Unavailable);
        assert_eq!(upload.read().unwrap(), b"note");
    }

    #[test]
    fn upload_leaves_disk_free() {
        let folder = tempfile::tempdir().unwrap();
        let upload = Upload::of_import(folder.path()).unwrap();
        let limits = UploadLimits {
            free_disk_min_bytes: u64::MAX,
            ..LIMITS
        };
        let refused = upload.write(0, &[1; 8], 0, &limits).unwrap_err();
        assert_eq!(refused.kind, RefusalKind::Unavailable);
        assert!(refused.sentence.contains("kept free"), "{refused}");
    }
}
