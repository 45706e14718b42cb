//! Data of tests and benchmarks: recorded scenes, views and models, and golden files.
//!
//! The data are in the folder named by the environment variable `TABULA_DATA`, by default
//! `../shared/data` beside the workspace. A test that needs them is marked
//! `#[ignore = "needs TABULA_DATA"]`, so that it counts as skipped without them.
//!
//! Invariants: only tests, benchmarks and examples use this crate.
//!
//! # Example
//!
//! ```
//! assert!(test_data::find("no-such-folder").is_none());
//! ```

pub mod golden;

use std::path::{Path, PathBuf};

/// Default data folder, relative to this crate.
const DEFAULT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../../shared/data");

/// Path of a file or folder of the data; `None` when it does not exist.
pub fn find(name: &str) -> Option<PathBuf> {
    let path = root().join(name);
    path.exists().then_some(path)
}

/// Path of a file or folder of the data.
///
/// # Panics
/// When it does not exist, with a sentence that names the environment variable.
pub fn path(name: &str) -> PathBuf {
    let path = root().join(name);
    assert!(
        path.exists(),
        "{} does not exist; set TABULA_DATA to the folder of the development data",
        path.display()
    );
    path
}

fn root() -> PathBuf {
    std::env::var_os("TABULA_DATA").map_or_else(|| Path::new(DEFAULT).to_owned(), PathBuf::from)
}
