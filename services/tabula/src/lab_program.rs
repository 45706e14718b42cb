//! Subcommands executed by another program: `tabula-lab`, `tabula-latency`, `tabula-recorder` and
//! `tabula-modeller`.

use crate::arguments::CliArguments;
use service::Failure;
use std::ffi::{OsStr, OsString};
use std::os::unix::process::CommandExt;
use std::process::{Command, ExitCode};

/// Replaces this process by `tabula-lab` with a subcommand and its arguments.
pub(crate) fn become_lab(
    arguments: &CliArguments,
    verb: &str,
    words: &[OsString],
) -> Result<ExitCode, Failure> {
    become_program("tabula-lab", arguments, Some(verb.as_ref()), words)
}

/// Replaces this process by `tabula-latency` with its arguments.
pub(crate) fn become_latency(
    arguments: &CliArguments,
    words: &[OsString],
) -> Result<ExitCode, Failure> {
    become_program("tabula-latency", arguments, None, words)
}

/// Replaces this process by `tabula-recorder` with a subcommand and its arguments.
pub(crate) fn become_recorder(
    arguments: &CliArguments,
    verb: &str,
    words: &[OsString],
) -> Result<ExitCode, Failure> {
    become_program("tabula-recorder", arguments, Some(verb.as_ref()), words)
}

/// Replaces this process by `tabula-modeller` with a subcommand and its arguments.
pub(crate) fn become_modeller(
    arguments: &CliArguments,
    verb: &str,
    words: &[OsString],
) -> Result<ExitCode, Failure> {
    become_program("tabula-modeller", arguments, Some(verb.as_ref()), words)
}

fn become_program(
    program: &str,
    arguments: &CliArguments,
    verb: Option<&OsStr>,
    words: &[OsString],
) -> Result<ExitCode, Failure> {
    let not_there = |error: std::io::Error| {
        let package = program.trim_start_matches("tabula-");
        let sentence = format!(
            "{program} could not be started: {error}; build it with: \
             cargo build --release -p {package}"
        );
        Failure::general(sentence)
    };
    let own = std::env::current_exe().map_err(not_there)?;
    let common = &arguments.common;
    // Options among the words override the environment.
    let error = Command::new(own.with_file_name(program))
        .env("TABULA_DOMAIN", common.domain.to_string())
        .env("TABULA_HOME", common.home().path())
        .args(verb)
        .args(words)
        .args(
            common
                .config
                .iter()
                .flat_map(|path| ["--config".as_ref(), path.as_os_str()]),
        )
        .args(arguments.json.then_some("--json"))
        .exec();
    Err(not_there(error))
}
