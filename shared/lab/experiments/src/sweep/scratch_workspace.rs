//! Scratch copy of the workspace, where scaled constants are built and evaluated.

use super::measurement::{Measurement, Scores};
use crate::output_files::write;
use service::Failure;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Names of folders that are not copied to the scratch workspace.
const LEFT_OUT: [&str; 3] = ["target", ".git", "docs"];

/// Scratch copy of the sources with its own target folder; both are kept for the next sweep.
pub(super) struct ScratchWorkspace {
    source: PathBuf,
    target: PathBuf,
}

impl ScratchWorkspace {
    /// Copies the sources below `target/sweep`; unchanged files keep their times, so that
    /// only what changed is built again.
    pub(super) fn copy(root: &Path) -> Result<Self, Failure> {
        let folder = root.join("target/sweep");
        let scratch = Self {
            source: folder.join("source"),
            target: folder.join("target"),
        };
        mirror(root, &scratch.source).map_err(|error| {
            let source = scratch.source.display();
            Failure::general(format!(
                "the sources could not be copied to {source}: {error}"
            ))
        })?;
        Ok(scratch)
    }

    /// Runs `work` while a file has other content.
    pub(super) fn with_file<T>(
        &self,
        file: &Path,
        text: &str,
        work: impl FnOnce() -> T,
    ) -> Result<T, Failure> {
        let path = self.source.join(file);
        let original = std::fs::read(&path).map_err(Failure::general)?;
        write(&path, text.as_bytes())?;
        let result = work();
        write(&path, &original)?;
        Ok(result)
    }

    /// Builds the copy and runs the evaluation.
    pub(super) fn scores(&self, measure: &Measurement, out: &Path) -> Result<Scores, Failure> {
        let built = Command::new("cargo")
            .args(["build", "--release", "--quiet", "--package", "lab"])
            .current_dir(&self.source)
            .env("CARGO_TARGET_DIR", &self.target)
            // Scores do not depend on link-time optimisation, build times do.
            .env("CARGO_PROFILE_RELEASE_LTO", "off")
            .env("CARGO_PROFILE_RELEASE_CODEGEN_UNITS", "16")
            .env("CARGO_INCREMENTAL", "1")
            .output()
            .map_err(|error| Failure::general(format!("cargo could not be started: {error}")))?;
        if !built.status.success() {
            let errors = String::from_utf8_lossy(&built.stderr);
            let first = errors.lines().find(|line| line.starts_with("error"));
            return Err(Failure::general(format!(
                "the build failed: {}",
                first.unwrap_or("no error was printed")
            )));
        }
        measure.scores(&self.target.join("release/tabula-lab"), &out.join("run"))
    }
}

/// Copies files that differ, and removes files that are gone.
fn mirror(from: &Path, to: &Path) -> io::Result<()> {
    std::fs::create_dir_all(to)?;
    let mut kept = Vec::new();
    for entry in std::fs::read_dir(from)? {
        let entry = entry?;
        let name = entry.file_name();
        if LEFT_OUT.iter().any(|left_out| name == *left_out) {
            continue;
        }
        let (source, copy) = (entry.path(), to.join(&name));
        if entry.file_type()?.is_dir() {
            mirror(&source, &copy)?;
        } else {
            let bytes = std::fs::read(&source)?;
            if std::fs::read(&copy).ok().as_ref() != Some(&bytes) {
                dataset::write_atomic(&copy, bytes).map_err(io::Error::other)?;
            }
        }
        kept.push(name);
    }
    for entry in std::fs::read_dir(to)? {
        let entry = entry?;
        if kept.contains(&entry.file_name()) {
            continue;
        }
        if entry.file_type()?.is_dir() {
            std::fs::remove_dir_all(entry.path())?;
        } else {
            std::fs::remove_file(entry.path())?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mirror_has_the_same_files_and_no_others() {
        let folder = tempfile::tempdir().unwrap();
        let (from, to) = (folder.path().join("from"), folder.path().join("to"));
        std::fs::create_dir_all(from.join("a/target")).unwrap();
        std::fs::create_dir_all(to.join("gone")).unwrap();
        std::fs::write(from.join("a/kept.rs"), "1").unwrap();
        std::fs::write(to.join("gone/old.rs"), "2").unwrap();
        mirror(&from, &to).unwrap();
        assert_eq!(std::fs::read(to.join("a/kept.rs")).unwrap(), b"1");
        assert!(!to.join("gone").exists() && !to.join("a/target").exists());
    }
}
