//! Controlling terminal of a process: distinction of a closed terminal from a request to reload,
//! since both are a SIGHUP.

use rustix::fs::{Mode, OFlags, open};
use std::time::{Duration, Instant};

/// Time between the loss of the terminal and the SIGHUP for it, in either order, at most. Chosen.
const RELATED: Duration = Duration::from_secs(2);

/// Observer of the controlling terminal. A process that never had one, or has lost it long ago, is
/// a daemon, for which SIGHUP means to reload.
#[derive(Debug)]
pub struct ControllingTerminal {
    last_seen: Option<Instant>,
    hung_up: Option<Instant>,
}

impl ControllingTerminal {
    /// Observer that begins now.
    pub fn new() -> Self {
        let mut terminal = Self {
            last_seen: None,
            hung_up: None,
        };
        terminal.observe(is_there(), Instant::now());
        terminal
    }

    /// Notes a SIGHUP.
    pub fn hang_up(&mut self) {
        self.hung_up = Some(Instant::now());
    }

    /// Looks at the terminal, to be called once a second and after a SIGHUP; true when it was
    /// closed and the process is to stop for that.
    pub fn was_closed(&mut self) -> bool {
        self.last_seen.is_some() && self.observe(is_there(), Instant::now())
    }

    fn observe(&mut self, is_there: bool, now: Instant) -> bool {
        if is_there {
            self.last_seen = Some(now);
            return false;
        }
        let (Some(last_seen), Some(hung_up)) = (self.last_seen, self.hung_up) else {
            return false;
        };
        let apart = hung_up.saturating_duration_since(last_seen);
        apart.max(last_seen.saturating_duration_since(hung_up)) <= RELATED
    }
}

impl Default for ControllingTerminal {
    fn default() -> Self {
        Self::new()
    }
}

fn is_there() -> bool {
    let flags = OFlags::RDONLY | OFlags::NOCTTY | OFlags::NONBLOCK | OFlags::CLOEXEC;
    open("/dev/tty", flags, Mode::empty()).is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn terminal() -> ControllingTerminal {
        ControllingTerminal {
            last_seen: None,
            hung_up: None,
        }
    }

    #[test]
    fn terminal_that_goes_with_a_hang_up_was_closed() {
        let begin = Instant::now();
        for (seen_ms, hung_up_ms) in [(1000, 1500), (1500, 1000)] {
            let at = |ms| begin + Duration::from_millis(ms);
            let mut terminal = terminal();
            assert!(!terminal.observe(true, at(seen_ms)));
            terminal.hung_up = Some(at(hung_up_ms));
            assert!(terminal.observe(false, at(2000)));
        }
    }

    #[test]
    fn hang_up_without_a_terminal_or_beside_an_open_one_closes_nothing() {
        let begin = Instant::now();
        let mut daemon = terminal();
        daemon.hung_up = Some(begin);
        assert!(!daemon.observe(false, begin));
        let mut open = terminal();
        open.hung_up = Some(begin);
        assert!(!open.observe(true, begin + Duration::from_secs(1)));
        // Lost a minute before, as by `nohup`.
        let mut left = terminal();
        assert!(!left.observe(true, begin));
        left.hung_up = Some(begin + Duration::from_secs(60));
        assert!(!left.observe(false, begin + Duration::from_secs(60)));
    }
}
