//! Output of answers for people (text) and scripts (JSON).
#![expect(
    clippy::print_stderr,
    reason = "command-line output goes to the terminal"
)]

use message::{escape_unprintable_lines, is_unprintable};
use serde::Serialize;
use service::Failure;
use std::fmt::Write as _;
use std::io::{IsTerminal, Write};
use std::process::ExitCode;

/// Output format: text, or one JSON document on standard output.
#[derive(Debug, Clone, Copy)]
pub struct Output {
    json: bool,
}

#[derive(Serialize)]
struct ErrorDocument<'a> {
    error: &'a str,
    exit_code: u8,
}

impl Output {
    /// Creates a JSON output when `json` is true, a text output otherwise.
    pub fn new(json: bool) -> Self {
        Self { json }
    }

    /// `true` if the output is JSON.
    pub fn is_json(self) -> bool {
        self.json
    }

    /// Prints an answer: the document, or its text.
    pub fn answer(self, document: &impl Serialize, text: impl FnOnce() -> String) {
        if !self.json {
            print(&text());
            return;
        }
        match serde_json::to_string(document) {
            Ok(line) => write_line(&escape_json(&line)),
            Err(error) => eprintln!("the answer could not be written as JSON: {error}"),
        }
    }

    /// Prints a line of text; nothing in JSON output.
    pub fn print_text(self, text: &str) {
        if !self.json {
            print(text);
        }
    }

    /// Prints a status message: in JSON output on standard error, where the log is.
    pub fn print_status(self, text: &str) {
        if self.json {
            eprintln!("tabula: {}", escape_unprintable_lines(text));
        } else {
            print(text);
        }
    }

    /// Exit code of a command; its failure is printed on standard error, in JSON output
    /// also as a document.
    pub fn exit_code(self, outcome: Result<ExitCode, Failure>) -> ExitCode {
        outcome.unwrap_or_else(|failure| {
            self.print_failure(&failure);
            ExitCode::from(failure.code)
        })
    }

    fn print_failure(self, failure: &Failure) {
        eprintln!("tabula: {}", escape_unprintable_lines(&failure.to_string()));
        if self.json {
            let document = ErrorDocument {
                error: &failure.sentence,
                exit_code: failure.code,
            };
            let line = serde_json::to_string(&document).unwrap_or_default();
            write_line(&escape_json(&line));
        }
    }
}

/// Redraws the terminal with a text; elsewhere the text is appended.
pub fn redraw_terminal(text: &str) {
    if std::io::stdout().is_terminal() {
        let text = escape_unprintable_lines(text);
        // Home, then clear to the end of each line and of the screen: no flicker.
        let lines = text.replace('\n', "\x1b[K\n");
        write_line(&format!("\x1b[H{lines}\x1b[K\n\x1b[J"));
    } else {
        print(text);
    }
}

/// Prints lines of text. Control characters, which could rewrite the terminal, are escaped.
fn print(text: &str) {
    write_line(&escape_unprintable_lines(text));
}

/// Writes a line. A closed pipe (`tabula objects | head`) is no failure.
fn write_line(text: &str) {
    let mut out = std::io::stdout().lock();
    let _ = writeln!(out, "{text}").and_then(|()| out.flush());
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
    fn json_has_no_control_character_and_the_same_content() {
        let text = "a\u{1b}[2J\n\u{9b}\u{202e}é\u{7f}";
        let line = escape_json(&serde_json::to_string(text).unwrap());
        assert!(!line.chars().any(is_unprintable), "{line}");
        assert_eq!(serde_json::from_str::<String>(&line).unwrap(), text);
    }
}
