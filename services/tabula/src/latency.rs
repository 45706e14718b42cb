//! `tabula latency`: the program `tabula-latency`.

use crate::arguments::Arguments;
use service::{Failure, exit_code};
use std::ffi::OsString;
use std::os::unix::process::CommandExt;
use std::process::{Command, ExitCode};

/// Becomes `tabula-latency`, with what was said before and after the verb.
pub(crate) fn run(arguments: &Arguments, words: &[OsString]) -> Result<ExitCode, Failure> {
    let not_there = |error: std::io::Error| {
        let sentence = format!(
            "tabula-latency could not be started: {error}; build all programs with: \
             cargo build --release --workspace --bins"
        );
        Failure::new(exit_code::FAILURE, sentence)
    };
    let own = std::env::current_exe().map_err(not_there)?;
    let common = &arguments.common;
    // What is named among the words wins over the environment.
    let error = Command::new(own.with_file_name("tabula-latency"))
        .env("TABULA_DOMAIN", common.domain.to_string())
        .env("TABULA_HOME", common.home().path())
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
