//! Errors of reading and checking the configuration.

use super::config_layer::MAX_DROP_INS;
use std::io;
use std::path::PathBuf;
use unicode_text::escape_unprintable_lines;

/// Longest cause in a sentence, bytes; the rest of a longer one is left out.
const MAX_CAUSE_BYTES: usize = 400;

/// Error of an unusable configuration.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ConfigError {
    /// Configuration file, or folder of drop-ins, that cannot be read.
    #[error(
        "could not read the configuration {}: {source}; create it, or let the user of the daemon \
         read it",
        .path.display()
    )]
    Unreadable {
        /// Path of the file or folder.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// Configuration file with invalid content.
    #[error("the configuration {} is wrong{}: {cause}", .path.display(), in_line(*.line))]
    Wrong {
        /// Path of the configuration file.
        path: PathBuf,
        /// Line of the error, from 1, where it is known.
        line: Option<usize>,
        /// Section, key and reason.
        cause: String,
    },
    /// Folder with too many drop-ins.
    #[error(
        "the folder {} has more than {MAX_DROP_INS} drop-ins of the configuration; join some of \
         them into one file",
        .folder.display()
    )]
    TooManyDropIns {
        /// Folder of the drop-ins.
        folder: PathBuf,
    },
}

fn in_line(line: Option<usize>) -> String {
    line.map_or_else(String::new, |line| format!(" in line {line}"))
}

/// Text as one line of printable characters.
pub(super) fn printable_line(text: &str) -> String {
    escape_unprintable_lines(&text.trim_end().replace('\n', " ")).into_owned()
}

/// Text of a file as a part of a sentence: one printable line of limited length.
pub(crate) fn one_line(text: &str) -> String {
    let mut line = printable_line(text);
    if line.len() > MAX_CAUSE_BYTES {
        let is_end = |end: &usize| line.is_char_boundary(*end);
        let end = (0..=MAX_CAUSE_BYTES).rev().find(is_end).unwrap_or(0);
        line.truncate(end);
        line.push_str(" …");
    }
    line
}
