//! Printing for people and for scripts.
#![expect(clippy::print_stderr, reason = "this is what the command line is for")]

use serde::Serialize;
use service::Failure;
use std::io::{IsTerminal, Write};

/// Where answers go: text, or one JSON document on standard output.
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
    /// Answers as documents when `json` is true, as text otherwise.
    pub fn new(json: bool) -> Self {
        Self { json }
    }

    /// Whether JSON is wanted.
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
            Ok(line) => print(&line),
            Err(error) => eprintln!("the answer could not be written as JSON: {error}"),
        }
    }

    /// Prints a line for people, which scripts do not get.
    pub fn say(self, text: &str) {
        if !self.json {
            print(text);
        }
    }

    /// Prints what happens meanwhile: for scripts on standard error, where the log is.
    pub fn tell(self, text: &str) {
        if self.json {
            eprintln!("tabula: {text}");
        } else {
            print(text);
        }
    }

    /// Prints why a command failed: on standard error, for scripts also as document.
    pub fn failure(self, failure: &Failure) {
        eprintln!("tabula: {failure}");
        if self.json {
            let document = ErrorDocument {
                error: &failure.sentence,
                exit_code: failure.code,
            };
            print(&serde_json::to_string(&document).unwrap_or_default());
        }
    }
}

/// Replaces what is on the terminal; elsewhere the text is appended.
pub fn redraw(text: &str) {
    if std::io::stdout().is_terminal() {
        // Home, then clear to the end of each line and of the screen: no flicker.
        let lines = text.replace('\n', "\x1b[K\n");
        print(&format!("\x1b[H{lines}\x1b[K\n\x1b[J"));
    } else {
        print(text);
    }
}

/// A reader that has gone away (`tabula objects | head`) is no failure.
fn print(text: &str) {
    let mut out = std::io::stdout().lock();
    let _ = writeln!(out, "{text}").and_then(|()| out.flush());
}
