//! Reading of small text files that people write: scenes, labels, marks.

use std::path::Path;

/// Maximum size of a file, bytes. Chosen.
const MOST_BYTES: u64 = 1 << 20;

/// Reads a text file of at most 1 MiB.
///
/// # Errors
/// The cause, when it is missing, no regular file, larger, or not UTF-8.
pub(super) fn read(path: &Path) -> Result<String, String> {
    let metadata = std::fs::metadata(path).map_err(|error| error.to_string())?;
    if !metadata.is_file() || metadata.len() > MOST_BYTES {
        return Err("it is not a file of at most 1 MiB".to_owned());
    }
    std::fs::read_to_string(path).map_err(|error| error.to_string())
}
