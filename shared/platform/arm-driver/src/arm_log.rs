//! Log of the arm's loop, written by a thread of its own: a log whose disk hangs delays no stop.

use crossbeam::channel::{Sender, bounded};
use tracing::Level;

/// Number of sentences that wait for their writer; further ones are left out.
const QUEUE_CAPACITY: usize = 64;

/// Sending end of the log.
#[derive(Debug, Clone)]
pub struct ArmLog(Sender<(Level, String)>);

impl ArmLog {
    /// Starts the writer, which ends with the last sender.
    ///
    /// # Errors
    /// When the thread cannot be started.
    pub fn start() -> std::io::Result<Self> {
        let (sender, sentences) = bounded(QUEUE_CAPACITY);
        let writer = move || {
            for (level, sentence) in sentences {
                match level {
                    Level::ERROR => tracing::error!("{sentence}"),
                    Level::WARN => tracing::warn!("{sentence}"),
                    _ => tracing::info!("{sentence}"),
                }
            }
        };
        std::thread::Builder::new()
            .name("arm log".into())
            .spawn(writer)?;
        Ok(Self(sender))
    }

    /// Writes a sentence, unless the writer is behind.
    pub fn write(&self, level: Level, sentence: impl Into<String>) {
        let _ = self.0.try_send((level, sentence.into()));
    }

    /// Writes a sentence about ordinary events.
    pub fn info(&self, sentence: impl Into<String>) {
        self.write(Level::INFO, sentence);
    }

    /// Writes a warning.
    pub fn warn(&self, sentence: impl Into<String>) {
        self.write(Level::WARN, sentence);
    }
}
