//! Folders of real data, for tests marked `#[ignore = "needs TABULA_DATA"]`.

use std::path::PathBuf;

/// A folder within the data.
pub(crate) fn folder(name: &str) -> PathBuf {
    let data = std::env::var_os("TABULA_DATA").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data")),
        PathBuf::from,
    );
    let folder = data.join(name);
    assert!(
        folder.is_dir(),
        "{} is not there; set TABULA_DATA",
        folder.display()
    );
    folder
}
