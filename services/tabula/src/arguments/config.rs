//! Command-line arguments of `tabula config`.

use clap::Subcommand;

/// Verbs of `tabula config`.
#[derive(Debug, Subcommand)]
pub(crate) enum ConfigVerb {
    /// Check the whole configuration, without starting anything
    Check,
    /// Show the value of every key, and the file that it is from
    Show,
    /// Explain a key: meaning, range, default, value, and whether it can change while running
    Explain {
        /// Key, such as perception.workers or workers
        key: String,
    },
    /// Let the running daemon read the configuration again; what was applied, and what needs a
    /// restart
    Reload,
}
