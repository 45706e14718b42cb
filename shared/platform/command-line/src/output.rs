//! Output of answers for people (text) and scripts (JSON): the one writer of standard output.

use serde::Serialize;
use service::{Failure, exit_code};
use std::fmt::Write as _;
use std::io::{self, ErrorKind, IsTerminal, Write};
use std::process::ExitCode;
use std::sync::{Arc, OnceLock};
use unicode_text::{escape_unprintable_lines, is_unprintable};

/// Output format: text, or one JSON document on standard output; with the end of the output, if it
/// has come.
///
/// The first write that fails ends the output. Its sentence is printed on standard error at once,
/// and [`Output::exit_code`] becomes 1. A closed pipe (`tabula objects | head`) is no failure.
#[derive(Debug, Clone)]
pub struct Output {
    json: bool,
    end: Arc<OnceLock<OutputEnd>>,
}

/// End of an output, after which nothing more is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum OutputEnd {
    /// Pipe that its reader has closed.
    ReaderGone,
    /// Write that has failed, such as one to a full disk.
    Failed,
}

#[derive(Serialize)]
struct ErrorDocument<'a> {
    error: &'a str,
    exit_code: u8,
}

impl Output {
    /// Creates a JSON output when `json` is true, a text output otherwise.
    pub fn new(json: bool) -> Self {
        let end = Arc::default();
        Self { json, end }
    }

    /// `true` if the output is JSON.
    pub fn is_json(&self) -> bool {
        self.json
    }

    /// `true` until a write has failed, or found a closed pipe.
    pub fn is_open(&self) -> bool {
        self.end.get().is_none()
    }

    /// Prints an answer: the document, or its text.
    pub fn answer(&self, document: &impl Serialize, text: impl FnOnce() -> String) {
        if self.json {
            self.write(|| write_line(&escape_json(&serde_json::to_string(document)?)));
        } else {
            self.print(&text());
        }
    }

    /// Prints bytes as they are, without a line feed behind them.
    pub fn print_bytes(&self, bytes: &[u8]) {
        self.write(|| write(bytes));
    }

    /// Prints a line of text; nothing in JSON output.
    pub fn print_text(&self, text: &str) {
        if !self.json {
            self.print(text);
        }
    }

    /// Prints a status message: in JSON output on standard error, where the log is.
    pub fn print_status(&self, text: &str) {
        if self.json {
            print_aside(text);
        } else {
            self.print(text);
        }
    }

    /// Redraws the terminal with a text; elsewhere the text is appended.
    pub fn redraw(&self, text: &str) {
        if io::stdout().is_terminal() {
            let text = escape_unprintable_lines(text);
            // Home, then clear to the end of each line and of the screen: no flicker.
            let lines = text.replace('\n', "\x1b[K\n");
            self.write(|| write_line(&format!("\x1b[H{lines}\x1b[K\n\x1b[J")));
        } else {
            self.print(text);
        }
    }

    /// Exit code of a command; its failure is printed on standard error, in JSON output
    /// also as a document.
    pub fn exit_code(&self, outcome: Result<ExitCode, Failure>) -> ExitCode {
        match outcome {
            Err(failure) => {
                self.print_failure(&failure);
                ExitCode::from(failure.code)
            }
            Ok(_) if self.end.get() == Some(&OutputEnd::Failed) => {
                ExitCode::from(exit_code::FAILURE)
            }
            Ok(code) => code,
        }
    }

    fn print_failure(&self, failure: &Failure) {
        print_aside(&failure.to_string());
        if self.json {
            let document = ErrorDocument {
                error: &failure.sentence,
                exit_code: failure.code,
            };
            let line = serde_json::to_string(&document).unwrap_or_default();
            self.write(|| write_line(&escape_json(&line)));
        }
    }

    /// Prints lines of text. Control characters, which could rewrite the terminal, are escaped.
    fn print(&self, text: &str) {
        self.write(|| write_line(&escape_unprintable_lines(text)));
    }

    fn write(&self, write: impl FnOnce() -> io::Result<()>) {
        if self.is_open() {
            self.note(write());
        }
    }

    /// Notes the end of the output, and prints the sentence of a failure, once.
    fn note(&self, written: io::Result<()>) {
        let Err(error) = written else {
            return;
        };
        let end = match error.kind() {
            ErrorKind::BrokenPipe => OutputEnd::ReaderGone,
            _ => OutputEnd::Failed,
        };
        if self.end.set(end).is_ok() && end == OutputEnd::Failed {
            print_aside(&format!(
                "standard output could not be written: {error}; what it has is incomplete"
            ));
        }
    }
}

/// Prints lines on standard error. There is no other place for the failure of that.
fn print_aside(text: &str) {
    let text = escape_unprintable_lines(text);
    let _ = writeln!(io::stderr(), "tabula: {text}");
}

fn write_line(text: &str) -> io::Result<()> {
    write(format!("{text}\n").as_bytes())
}

fn write(bytes: &[u8]) -> io::Result<()> {
    let mut out = io::stdout().lock();
    out.write_all(bytes)?;
    out.flush()
}

/// JSON with the unprintable characters of its strings as `\u001b`; there are none elsewhere.
fn escape_json(line: &str) -> String {
    let mut escaped = String::with_capacity(line.len());
    for c in line.chars() {
        if is_unprintable(c) {
            // All of them are in the basic multilingual plane.
            let _ = write!(escaped, "\\u{:04x}", u32::from(c));
        } else {
            escaped.push(c);
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn output_ends_with_its_first_failure_and_quietly_at_a_closed_pipe() {
        let success = || Ok(ExitCode::SUCCESS);
        let code = |code: u8| format!("{:?}", ExitCode::from(code));
        for (kind, expected) in [(ErrorKind::BrokenPipe, 0), (ErrorKind::StorageFull, 1)] {
            let output = Output::new(false);
            assert!(output.is_open());
            assert_eq!(format!("{:?}", output.exit_code(success())), code(0));
            let elsewhere = output.clone();
            elsewhere.write(|| Err(kind.into()));
            assert!(!output.is_open());
            output.write(|| panic!("nothing is written after the end"));
            assert_eq!(format!("{:?}", output.exit_code(success())), code(expected));
            let refused = Err(Failure::usage("x"));
            assert_eq!(format!("{:?}", output.exit_code(refused)), code(2));
        }
    }

    #[test]
    fn json_has_no_control_character_and_the_same_content() {
        let text = "a\u{1b}[2J\n\u{9b}\u{202e}é\u{7f}";
        let line = escape_json(&serde_json::to_string(text).unwrap());
        assert!(!line.chars().any(is_unprintable), "{line}");
        assert_eq!(serde_json::from_str::<String>(&line).unwrap(), text);
    }
}
