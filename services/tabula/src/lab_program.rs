//! Subcommands executed by another program: `tabula-lab`, `tabula-latency`, `tabula-recorder` and
//! `tabula-modeller`.

use crate::arguments::{CliArguments, LabArguments};
use service::{CommonArguments, Failure};
use std::ffi::{OsStr, OsString};
use std::os::unix::process::CommandExt;
use std::path::PathBuf;
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
    (verb, passed): (&str, &LabArguments),
) -> Result<ExitCode, Failure> {
    let verb = Some(verb.as_ref());
    become_program("tabula-modeller", arguments, verb, &passed.words)
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
    // Its own check tells which of these it does not use. Options among the words go before them.
    let error = Command::new(own.with_file_name(program))
        .args(given_options(&arguments.common))
        .args(arguments.json.then_some("--json"))
        .args(verb)
        .args(words)
        .exec();
    Err(not_there(error))
}

/// Options of every command that stand on the command line; the environment is inherited.
fn given_options(common: &CommonArguments) -> Vec<OsString> {
    let domain = OsString::from(common.domain.to_string());
    let path = |path: &Option<PathBuf>| path.clone().unwrap_or_default().into_os_string();
    let given = &common.given;
    let options = [
        (given.domain, "--domain", domain),
        (given.home, "--home", path(&common.home)),
        (given.config, "--config", path(&common.config)),
    ];
    let given = options.into_iter().filter(|(is_given, ..)| *is_given);
    given
        .flat_map(|(_, name, value)| [name.into(), value])
        .collect()
}
