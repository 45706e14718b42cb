//! Process restart for fakenect, which reads its recording from the environment.

use crate::config::Config;
use crate::source::SourceSpec;
use service::Failure;
use std::os::unix::process::CommandExt;
use std::process::Command;

/// Replaces the process by one with the recording in its environment; does not return
/// then. Must be called before any thread starts.
///
/// # Errors
/// When the folder is no complete recording, or the program cannot be started.
pub fn restart_with_recording(config: &Config) -> Result<(), Failure> {
    let SourceSpec::Fakenect(folder) = &config.source else {
        return Ok(());
    };
    freenect::check_recording(folder).map_err(Failure::general)?;
    match freenect::restart_with_recording(folder).map_err(Failure::general)? {
        None => Ok(()),
        Some(mut command) => Err(Failure::general(format!(
            "could not start again to play {}: {}",
            folder.display(),
            command.exec()
        ))),
    }
}

/// Plays the recording from its beginning by replacing the process: fakenect cannot
/// rewind. Returns only on failure.
pub(crate) fn play_again() -> Failure {
    let started = std::env::current_exe().map(|program| {
        Command::new(program)
            .args(std::env::args_os().skip(1))
            .exec()
    });
    let (Ok(error) | Err(error)) = started;
    Failure::general(format!("could not start again to play on: {error}"))
}
