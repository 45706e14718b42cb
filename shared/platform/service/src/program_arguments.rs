//! Command-line parsing of every program, with a check of the processor before it.

use crate::failure::exit_code;
use crate::manuals;
use crate::processor::missing_features;
use clap::Parser;
use std::ffi::OsString;
use std::io::{ErrorKind, Write};
use std::path::Path;

/// Option, as the only one, with which a program writes its manual pages and shell completions
/// into a folder: for packages, and not shown in the help.
const WRITE_MANUALS: &str = "--write-manuals";

/// Parses the command line, or ends the process: with a sentence on a processor that this build
/// cannot run on, on wrong arguments, and after `--help`, `--version` or `--write-manuals DIR`.
pub fn parse_arguments<A: Parser>() -> A {
    if let Some(sentence) = missing_features() {
        exit_with(sentence, exit_code::USAGE);
    }
    let words: Vec<OsString> = std::env::args_os().skip(1).collect();
    if let [option, folder] = words.as_slice()
        && option == WRITE_MANUALS
    {
        match manuals::write(A::command(), Path::new(folder)) {
            Ok(()) => std::process::exit(0),
            Err(error) => exit_with(
                &format!("the manual pages could not be written: {error}"),
                exit_code::FAILURE,
            ),
        }
    }
    A::try_parse().unwrap_or_else(|clap_error| exit_telling(&clap_error))
}

/// Prints the help, the version, or the error of the arguments, and ends the process.
fn exit_telling(clap_error: &clap::Error) -> ! {
    let printed = clap_error.print().and_then(|()| std::io::stdout().flush());
    match printed {
        Err(error) if !clap_error.use_stderr() && error.kind() != ErrorKind::BrokenPipe => {
            exit_with(
                &format!(
                    "standard output could not be written: {error}; what it has is incomplete"
                ),
                exit_code::FAILURE,
            )
        }
        _ => std::process::exit(clap_error.exit_code()),
    }
}

/// Prints a sentence where nothing else is printed yet: the log is started later.
fn exit_with(sentence: &str, code: u8) -> ! {
    let _ = writeln!(std::io::stderr(), "{sentence}");
    std::process::exit(code.into())
}
