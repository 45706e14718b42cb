//! Restart of the process with a recording's folder in its environment.
//!
//! Fakenect finds its folder only through an environment variable. Changing the environment of a
//! running process is unsafe, since any thread may be reading it. Restarting the same program
//! with the variable set is safe, so the camera process does that before it starts any thread.
//!
//! ```no_run
//! use std::os::unix::process::CommandExt as _;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let folder = std::path::Path::new("recording");
//! if let Some(mut command) = freenect::restart_with_recording(folder)? {
//!     // Only returns when the program could not be started.
//!     return Err(command.exec().into());
//! }
//! // From here on the environment names the folder.
//! # Ok(())
//! # }
//! ```

use crate::RecordingError;
use std::ffi::{OsStr, OsString};
use std::path::Path;
use std::process::Command;
use std::{env, io};

/// Environment variable with fakenect's folder.
pub const FOLDER_VARIABLE: &str = "FAKENECT_PATH";

/// Command that restarts this program to play `folder`, or `None` if the environment already
/// names it.
///
/// Call this, and the command's `exec`, before any thread starts: `exec` ends all other threads.
/// The process keeps its id, so systemd and parents notice nothing. The folder's links are
/// resolved, so that the second start sees the same name and continues.
///
/// # Errors
/// If the folder does not exist, or the path of this program is unknown.
pub fn restart_with_recording(folder: &Path) -> Result<Option<Command>, RecordingError> {
    let no_folder = |_: io::Error| RecordingError::NoFolder {
        folder: folder.to_owned(),
    };
    let folder = folder.canonicalize().map_err(no_folder)?;
    if is_named(&folder, env::var_os(FOLDER_VARIABLE).as_deref()) {
        return Ok(None);
    }
    let program = env::current_exe().map_err(|source| RecordingError::Unreadable {
        file: Path::new("/proc/self/exe").to_owned(),
        source,
    })?;
    Ok(Some(restart(&program, env::args_os(), &folder)))
}

fn is_named(folder: &Path, current: Option<&OsStr>) -> bool {
    current == Some(folder.as_os_str())
}

fn restart(
    program: &Path,
    mut arguments: impl Iterator<Item = OsString>,
    folder: &Path,
) -> Command {
    use std::os::unix::process::CommandExt as _;
    let mut command = Command::new(program);
    if let Some(name) = arguments.next() {
        command.arg0(name);
    }
    command.args(arguments).env(FOLDER_VARIABLE, folder);
    command
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn restart_happens_once() {
        let folder = Path::new("/srv/recording");
        assert!(!is_named(folder, None));
        assert!(!is_named(folder, Some(OsStr::new("/srv/other"))));
        assert!(is_named(folder, Some(folder.as_os_str())));
    }

    #[test]
    fn the_command_keeps_the_arguments_and_adds_the_folder() {
        let arguments = ["tabula-camera", "--config", "a b.toml"].map(OsString::from);
        let command = restart(
            Path::new("/usr/bin/tabula-camera"),
            arguments.into_iter(),
            Path::new("/r"),
        );
        assert_eq!(command.get_program(), "/usr/bin/tabula-camera");
        assert_eq!(
            command.get_args().collect::<Vec<_>>(),
            ["--config", "a b.toml"]
        );
        let variables: Vec<_> = command.get_envs().collect();
        assert_eq!(
            variables,
            [(OsStr::new(FOLDER_VARIABLE), Some(OsStr::new("/r")))]
        );
    }

    #[test]
    fn a_missing_folder_is_refused_before_the_restart() {
        let error = restart_with_recording(Path::new("/nonexistent/recording")).unwrap_err();
        assert!(
            error.to_string().contains("/nonexistent/recording"),
            "{error}"
        );
    }
}
