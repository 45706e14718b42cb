//! Folder of the development data.

use std::path::PathBuf;

/// Folder of the development data: `TABULA_DATA`, or the usual one.
pub(crate) fn data_folder() -> PathBuf {
    std::env::var_os("TABULA_DATA").map_or_else(
        || {
            PathBuf::from(concat!(
                env!("CARGO_MANIFEST_DIR"),
                "/../../../../shared/data"
            ))
        },
        PathBuf::from,
    )
}
