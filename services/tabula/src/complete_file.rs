//! File that gets its name when it is complete and on disk.

use service::Failure;
use std::fs::File;
use std::io;
use std::path::Path;

/// Failure of a file, which "could not be written" or the like.
pub(crate) fn file_failed(doing: &str, file: &Path, error: &io::Error) -> Failure {
    let sentence = format!("{} could not be {doing}: {error}", file.display());
    Failure::general(sentence)
}

/// Writes a file by `write`, for this user only. An existing file of this name is replaced when the
/// new one is complete and on disk; a failure leaves it as it is, and nothing else behind.
///
/// # Errors
/// That of `write`, or if the file cannot be created, synchronised or named.
pub(crate) fn write_complete<T>(
    path: &Path,
    write: impl FnOnce(&mut File) -> Result<T, Failure>,
) -> Result<T, Failure> {
    let failed = |error: &io::Error| file_failed("written", path, error);
    let folder = path.parent().filter(|folder| *folder != Path::new(""));
    let folder = folder.unwrap_or(Path::new("."));
    let mut partial = tempfile::Builder::new()
        .prefix("tabula-export-")
        .suffix(".partial")
        .tempfile_in(folder)
        .map_err(|error| failed(&error))?;
    let written = write(partial.as_file_mut())?;
    partial
        .as_file()
        .sync_all()
        .map_err(|error| failed(&error))?;
    partial
        .persist(path)
        .map_err(|error| failed(&error.error))?;
    let synced = File::open(folder).and_then(|folder| folder.sync_all());
    synced.map_err(|error| failed(&error))?;
    Ok(written)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    #[test]
    fn file_is_replaced_when_it_is_complete() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("model.ply");
        for content in ["first", "second"] {
            let written = write_complete(&path, |file| {
                file.write_all(content.as_bytes()).unwrap();
                Ok(content.len())
            });
            assert_eq!(written, Ok(content.len()));
            assert_eq!(std::fs::read_to_string(&path).unwrap(), content);
        }
        let failed = write_complete::<()>(&path, |file| {
            file.write_all(b"half").unwrap();
            Err(Failure::general("the memory has gone"))
        });
        assert!(failed.is_err());
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "second");
        assert_eq!(folder.path().read_dir().unwrap().count(), 1);
    }

    #[test]
    fn missing_folder_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("missing/model.ply");
        let failure = write_complete(&path, |_| Ok(())).unwrap_err();
        assert!(failure.sentence.contains("missing/model.ply"), "{failure}");
    }
}
