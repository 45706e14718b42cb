//! Output files and folders: atomic writes whose errors are command-line failures.

use plot::DrawingError;
use service::Failure;
use std::path::Path;

/// Writes a file atomically: a partial file and a rename, so that an interruption leaves no half
/// file under that name.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    dataset::write_atomic(path, bytes).map_err(Failure::general)
}

/// Writes a drawn figure under its name in a folder.
pub(crate) fn write_figure(
    out: &Path,
    name: &str,
    svg: Result<String, DrawingError>,
) -> Result<(), Failure> {
    write(&out.join(name), svg.map_err(Failure::general)?.as_bytes())
}

/// Creates a folder and its parents, if missing.
pub(crate) fn create_folder(path: &Path) -> Result<(), Failure> {
    dataset::create_folder(path).map_err(Failure::general)
}
