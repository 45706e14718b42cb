//! `tabula latency peers`: benchmark of the transport against alternatives.
//!
//! The peers depend on libraries that the daemon must not have, so they are a separate workspace
//! that is built on demand.

use command_line::Output;
use service::Failure;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

/// Manifest of the peers, relative to the project's folder.
const MANIFEST: &str = "tests/peers/Cargo.toml";

/// Builds and runs the transport benchmark, which prints its result.
pub(crate) fn run(short: bool, output: &Output) -> Result<ExitCode, Failure> {
    let manifest = find(&starting_points()).ok_or_else(|| {
        Failure::usage(format!(
            "the peers are not here: {MANIFEST} is in the project's folder; change into it, \
                 or run the program that was built there"
        ))
    })?;
    let status = Command::new("cargo")
        .args(["run", "--release", "--quiet", "--bin", "transport"])
        .arg("--manifest-path")
        .arg(&manifest)
        .arg("--")
        .args(short.then_some("--short"))
        .args(output.is_json().then_some("--json"))
        .status()
        .map_err(|error| {
            let sentence = format!("cargo, which builds the peers, could not be started: {error}");
            Failure::general(sentence)
        })?;
    if status.success() {
        return Ok(ExitCode::SUCCESS);
    }
    let sentence = format!("the comparison with the peers has ended with {status}, see above");
    Err(Failure::general(sentence))
}

fn starting_points() -> Vec<PathBuf> {
    let places = [std::env::current_dir(), std::env::current_exe()];
    places.into_iter().filter_map(Result::ok).collect()
}

/// Manifest in the nearest ancestor folder of one of the places.
fn find(places: &[PathBuf]) -> Option<PathBuf> {
    let above = places.iter().flat_map(|place| place.ancestors());
    let manifests = above.map(|folder: &Path| folder.join(MANIFEST));
    manifests.into_iter().find(|manifest| manifest.is_file())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_peers_are_found_from_anywhere_in_the_project() {
        let here = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
        let found = find(&[here.join("src/main.rs")]).unwrap();
        assert!(found.ends_with(MANIFEST));
        assert_eq!(find(&[PathBuf::from("/dev")]), None);
    }
}
