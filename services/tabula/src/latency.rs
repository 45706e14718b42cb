//! `tabula latency`: the program `tabula-latency`.

use crate::arguments::Arguments;
use crate::child::common_arguments;
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
    let error = Command::new(own.with_file_name("tabula-latency"))
        .args(common_arguments(&arguments.common))
        .args(arguments.json.then_some("--json"))
        .args(words)
        .exec();
    Err(not_there(error))
}
