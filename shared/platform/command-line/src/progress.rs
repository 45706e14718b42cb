//! Progress of a long-running command: a bar on a terminal, a line a minute elsewhere.

use crate::Output;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle, WeakProgressBar};
use std::io::{IsTerminal, Write};
use std::time::Duration;

/// Time between two lines of progress where standard error is no terminal.
const LINE_PERIOD: Duration = Duration::from_secs(60);

/// Creates a progress bar on standard error; hidden in JSON output. Where standard error is no
/// terminal, such as a log, a line a minute takes its place.
pub fn progress_bar(n_steps: u64, what: &'static str, output: &Output) -> ProgressBar {
    let is_terminal = std::io::stderr().is_terminal();
    let target = if output.is_json() || !is_terminal {
        ProgressDrawTarget::hidden()
    } else {
        ProgressDrawTarget::stderr()
    };
    let bar = ProgressBar::with_draw_target(Some(n_steps), target);
    let template = "{msg} [{wide_bar}] {pos}/{len}, {per_sec}, {eta} left";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style.progress_chars("=> "));
    }
    if !is_terminal {
        let bar = bar.downgrade();
        std::thread::spawn(move || print_lines(&bar, what));
    }
    bar.with_message(what)
}

/// Prints a line a minute until the bar is finished or gone.
fn print_lines(bar: &WeakProgressBar, what: &str) {
    loop {
        std::thread::sleep(LINE_PERIOD);
        let Some(bar) = bar.upgrade().filter(|bar| !bar.is_finished()) else {
            return;
        };
        let _ = writeln!(std::io::stderr(), "{}", line(&bar, what));
    }
}

/// State of a bar as a line, such as "scenes: 3 of 10 after 12 min".
fn line(bar: &ProgressBar, what: &str) -> String {
    let minutes = bar.elapsed().as_secs() / 60;
    let n_steps = bar.length().unwrap_or_default();
    format!(
        "{what}: {} of {n_steps} after {minutes} min",
        bar.position()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn line_of_progress_tells_steps_and_time() {
        let bar = ProgressBar::hidden().with_elapsed(Duration::from_secs(725));
        bar.set_length(10);
        bar.set_position(3);
        assert_eq!(line(&bar, "scenes"), "scenes: 3 of 10 after 12 min");
    }
}
