//! Standard output of every kind of command: what cannot be written is a failure, a closed pipe is
//! a quiet end.

use crate::daemon::{Sandbox, WATCHDOG, wait_for_end};
use crate::file_writers::{code, is_of_program};
use crate::language::{root, workspace};
use crate::skeleton::wait_for_all;
use std::fs::File;
use std::io::{BufRead, BufReader, PipeWriter, Read, pipe};
use std::process::{Command, Stdio};

/// Sentence about a standard output that could not be written.
const SENTENCE: &str = "standard output could not be written";

/// Sources that may name standard output.
const OWNERS: [&str; 3] = [
    "shared/platform/command-line/src/output.rs",
    // Its reader, not its content.
    "shared/platform/command-line/src/reader_watch.rs",
    // Help and version, before the arguments are known.
    "shared/platform/service/src/program_arguments.rs",
];

/// Commands of each kind and program, for a daemon that has a document `notes`.
const COMMANDS: [&str; 30] = [
    "--help",
    "--version",
    "objects",
    "objects --json",
    "objects --watch",
    "objects --watch --json",
    "ask --teach-me",
    "status",
    "categories --json",
    "memory stats",
    "memory inspect",
    "memory history --json",
    "memory verify",
    "knowledge list",
    "knowledge get notes",
    "knowledge get notes --json",
    "model list",
    "world",
    "world history --json",
    "world events",
    "config check",
    "config show",
    "config explain camera.rate_hz",
    "doctor",
    "run --check-config --source synthetic:0",
    "simulate categories",
    "evaluate --help",
    "latency --frames 10 --warm-up 0",
    "record --frames 3 --foxglove-hz 0",
    "view plan --json",
];

/// Commands that print until they are stopped.
const ENDLESS: [&str; 5] = [
    "objects --watch",
    "objects --watch --json",
    "world events --follow",
    "world events --follow --json",
    "view plan --watch --json",
];

fn command(sandbox: &Sandbox, words: &str) -> Command {
    let mut command = sandbox.command("tabula");
    command
        .args(words.split_ascii_whitespace())
        .current_dir(sandbox.home());
    command
}

/// Exit code of a command that writes into `stdout`, and its standard error.
fn ended(mut command: Command, stdout: impl Into<Stdio>) -> (Option<i32>, String) {
    let child = command.stdout(stdout).stderr(Stdio::piped()).spawn();
    let mut child = child.unwrap();
    let mut stderr = child.stderr.take().unwrap();
    let told = std::thread::spawn(move || {
        let mut told = String::new();
        stderr.read_to_string(&mut told).unwrap();
        told
    });
    let status = wait_for_end(&mut child, WATCHDOG);
    if status.is_none() {
        child.kill().unwrap();
        child.wait().unwrap();
    }
    let told = told.join().unwrap();
    let status = status.unwrap_or_else(|| panic!("{command:?} does not end: {told}"));
    assert!(!told.contains("panicked"), "{command:?}: {told}");
    (status.code(), told)
}

/// Pipe without a reader.
fn closed_pipe() -> PipeWriter {
    let (reader, writer) = pipe().unwrap();
    drop(reader);
    writer
}

#[test]
fn standard_output_that_fails_ends_every_command_with_a_sentence() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&["--source", "synthetic:0"]);
    wait_for_all(&daemon, 0);
    let notes = sandbox.home().join("notes");
    std::fs::write(&notes, "cups go to the upper shelf\n".repeat(100_000)).unwrap();
    daemon.ask(&["knowledge", "put", "notes", notes.to_str().unwrap()]);
    for words in COMMANDS {
        let full = File::options().write(true).open("/dev/full").unwrap();
        let (code, told) = ended(command(&sandbox, words), full);
        assert_eq!(code, Some(1), "{words}: {told}");
        assert_eq!(told.matches(SENTENCE).count(), 1, "{words}: {told}");

        let (code, told) = ended(command(&sandbox, words), closed_pipe());
        // Its findings, not the pipe, decide about the code of the doctor.
        assert!(code == Some(0) || words == "doctor", "{words}: {told}");
        assert!(!told.contains(SENTENCE), "{words}: {told}");
    }
    daemon.stop();
}

#[test]
fn standard_output_without_a_reader_ends_a_watching_command() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&["--source", "synthetic:0"]);
    wait_for_all(&daemon, 0);
    for words in ENDLESS {
        let (reader, writer) = pipe().unwrap();
        let command = command(&sandbox, words);
        let watching = std::thread::spawn(move || ended(command, writer));
        // Nothing happens on this table, so a command that follows events prints nothing.
        if !words.contains("events") {
            let mut line = String::new();
            BufReader::new(&reader).read_line(&mut line).unwrap();
            assert!(!line.is_empty(), "{words}");
        }
        drop(reader);
        let (code, told) = watching.join().unwrap();
        assert_eq!(code, Some(0), "{words}: {told}");
        assert!(!told.contains(SENTENCE), "{words}: {told}");
    }
    daemon.stop();
}

#[test]
fn standard_output_has_one_writer() {
    let mut strangers = Vec::new();
    for (path, text) in workspace() {
        let path = path.strip_prefix(root()).unwrap();
        if !is_of_program(path) || OWNERS.iter().any(|owner| path.ends_with(owner)) {
            continue;
        }
        let calls = ["io::stdout(", "println!(", "print!("];
        for (number, line) in code(&text) {
            let names = |call: &&str| line.contains(*call) && !line.contains("eprint");
            if calls.iter().any(names) {
                strangers.push(format!("{}:{number}: {}", path.display(), line.trim()));
            }
        }
    }
    assert!(
        strangers.is_empty(),
        "answers are printed by command_line::Output, which notices what cannot be written:\n{}",
        strangers.join("\n")
    );
}
