//! Status lines on a thread of their own: a terminal that is stopped holds nobody up.

use command_line::Output;
use service::Failure;
use std::sync::mpsc::{SyncSender, sync_channel};

/// Largest number of lines that wait for the terminal; further ones are left out.
const MAX_LINES: usize = 16;

/// Sender of status lines.
#[derive(Debug, Clone)]
pub(crate) struct StatusLines {
    lines: SyncSender<String>,
}

impl StatusLines {
    /// Starts the thread, which ends with the last sender.
    ///
    /// # Errors
    /// When it cannot be started.
    pub(crate) fn start(output: Output) -> Result<Self, Failure> {
        Self::start_with(move |line| output.print_status(line))
    }

    fn start_with(print: impl Fn(&str) + Send + 'static) -> Result<Self, Failure> {
        let (lines, printed) = sync_channel::<String>(MAX_LINES);
        std::thread::Builder::new()
            .name("status".into())
            .spawn(move || printed.iter().for_each(|line| print(&line)))
            .map_err(|error| {
                Failure::general(format!(
                    "could not start a thread: {error}; raise the limit of threads"
                ))
            })?;
        Ok(Self { lines })
    }

    /// Prints a line, unless too many wait.
    pub(crate) fn print(&self, line: String) {
        drop(self.lines.try_send(line));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn status_lines_do_not_wait_for_a_stopped_terminal() {
        let (printed, lines) = sync_channel(0);
        let status = StatusLines::start_with(move |line| {
            drop(printed.send(line.to_owned()));
        });
        let status = status.unwrap();
        for number in 0..100 {
            status.print(number.to_string());
        }
        drop(status);
        let lines: Vec<String> = lines.iter().collect();
        assert_eq!(lines[0], "0");
        assert!(
            (MAX_LINES..=MAX_LINES + 1).contains(&lines.len()),
            "{lines:?}"
        );
    }
}
