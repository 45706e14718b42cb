//! Bridge from iceoryx2's log to tracing.

use iceoryx2::prelude::{LogLevel, set_log_level};
use std::fmt::Arguments;
use std::sync::Once;

struct TracingLogger;

static LOGGER: TracingLogger = TracingLogger;
static INSTALLED: Once = Once::new();

impl iceoryx2_log::Log for TracingLogger {
    fn log(&self, _level: LogLevel, origin: Arguments<'_>, message: Arguments<'_>) {
        // Relevant failures come back as error values and are reported there.
        tracing::debug!(target: "iceoryx2", "{origin}: {message}");
    }
}

/// Forwards iceoryx2's errors to tracing; its warnings about ordinary races are left
/// out.
pub(crate) fn install() {
    INSTALLED.call_once(|| {
        set_log_level(LogLevel::Error);
        iceoryx2::prelude::set_logger(&LOGGER);
    });
}
