//! Log-once flag: a condition that lasts is logged when it begins, not at every repetition.

/// Flag that a lasting condition has been logged.
#[derive(Debug, Default)]
pub(crate) struct LogOnce {
    is_logged: bool,
}

impl LogOnce {
    /// True on the first call since the last reset, when the message should be logged.
    pub(crate) fn is_first(&mut self) -> bool {
        !std::mem::replace(&mut self.is_logged, true)
    }

    /// Ends the condition whose messages are logged once; true if it was logged.
    pub(crate) fn reset(&mut self) -> bool {
        std::mem::take(&mut self.is_logged)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_condition_is_logged_once_until_it_ends() {
        let mut log = LogOnce::default();
        assert!(!log.reset());
        assert!(log.is_first() && !log.is_first());
        assert!(log.reset() && log.is_first());
    }
}
