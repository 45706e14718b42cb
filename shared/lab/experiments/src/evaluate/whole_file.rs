//! Writing files that are there whole or not at all.

use super::failed;
use service::Failure;
use std::path::Path;

/// Writes a file beside its place and then moves it there, so that what is
/// interrupted leaves no half file behind that name.
pub(super) fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let mut part = path.as_os_str().to_owned();
    part.push(".part");
    std::fs::write(&part, bytes)
        .and_then(|()| std::fs::rename(&part, path))
        .map_err(|error| failed(format!("could not write {}: {error}", path.display())))
}

/// Makes a folder if it is not there.
pub(super) fn make_folder(path: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(path)
        .map_err(|error| failed(format!("could not create {}: {error}", path.display())))
}
