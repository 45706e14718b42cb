//! iceoryx2's own log lines, at our level of interest.

use iceoryx2::prelude::{LogLevel, set_log_level};
use std::fmt::Arguments;
use std::sync::Once;

struct Bridge;

static BRIDGE: Bridge = Bridge;
static INSTALLED: Once = Once::new();

impl iceoryx2_log::Log for Bridge {
    fn log(&self, _level: LogLevel, origin: Arguments<'_>, message: Arguments<'_>) {
        // What matters to us comes back as an error value and is reported there.
        tracing::debug!(target: "iceoryx2", "{origin}: {message}");
    }
}

/// Sends iceoryx2's errors to tracing; its warnings about ordinary races are
/// left out.
pub(crate) fn install() {
    INSTALLED.call_once(|| {
        set_log_level(LogLevel::Error);
        iceoryx2::prelude::set_logger(&BRIDGE);
    });
}
