//! Log set-up: to the journal under systemd, to standard error otherwise.

use std::io::IsTerminal;
use std::os::fd::{AsFd, BorrowedFd};
use tracing_subscriber::EnvFilter;
use tracing_subscriber::layer::SubscriberExt;
use tracing_subscriber::util::SubscriberInitExt;

/// Starts the log. `RUST_LOG` chooses levels as usual; the default is `info`.
pub fn start_log() {
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new("info"));
    let registry = tracing_subscriber::registry().with(filter);
    if is_journal(std::io::stderr().as_fd())
        && let Ok(journal) = tracing_journald::layer()
    {
        // `journalctl TABULA_VERSION=…`; fields of messages become TABULA_..., too.
        let journal = journal
            .with_field_prefix(Some("TABULA".to_owned()))
            .with_custom_fields([("TABULA_VERSION", env!("CARGO_PKG_VERSION"))]);
        let _ = registry.with(journal).try_init();
        return;
    }
    let terminal = tracing_subscriber::fmt::layer()
        .with_writer(std::io::stderr)
        .with_ansi(std::io::stderr().is_terminal())
        .with_target(false);
    let _ = registry.with(terminal).try_init();
}

/// `true` for a stream to the journal: systemd names device and inode of the one that it made, and
/// children whose output goes elsewhere inherit the name (`systemd.exec(5)`, `$JOURNAL_STREAM`).
fn is_journal(stream: BorrowedFd<'_>) -> bool {
    let Ok(stat) = rustix::fs::fstat(stream) else {
        return false;
    };
    let own = format!("{}:{}", stat.st_dev, stat.st_ino);
    std::env::var("JOURNAL_STREAM").is_ok_and(|named| named == own)
}
