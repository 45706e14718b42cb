//! The command line.

use clap::{Args, Parser, Subcommand};
use service::CommonArguments;
use std::path::PathBuf;

/// Measures where the time of frames goes: in the daemon of the domain, or, with a
/// source or without a daemon, in one that it starts for itself.
#[derive(Debug, Parser)]
#[command(
    name = "tabula-latency",
    version,
    args_conflicts_with_subcommands = true
)]
pub(crate) struct Arguments {
    #[command(flatten)]
    pub(crate) common: CommonArguments,

    /// Print one JSON document instead of text
    #[arg(long, global = true)]
    pub(crate) json: bool,

    #[command(flatten)]
    pub(crate) measure: MeasureArguments,

    #[command(subcommand)]
    pub(crate) verb: Option<Verb>,
}

/// What to do, if not to measure frames.
#[derive(Debug, Subcommand)]
pub(crate) enum Verb {
    /// Measure what this computer adds to every latency, and what could be done about it
    Machine {
        /// A tenth of everything
        #[arg(long)]
        short: bool,
        /// Folder for the report and the plot
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
    },
    /// Compare two reports: what is faster, slower, or undecided
    Compare {
        /// The report before (JSON)
        before: PathBuf,
        /// The report now (JSON)
        now: PathBuf,
    },
    /// Merge histogram files of several measurements
    Merge {
        /// The files (.hlog)
        #[arg(required = true)]
        files: Vec<PathBuf>,
        /// Write the merged histograms here
        #[arg(long, value_name = "FILE")]
        out: Option<PathBuf>,
    },
}

/// What is measured, and where the results go.
#[derive(Debug, Clone, Args)]
pub(crate) struct MeasureArguments {
    #[command(flatten)]
    pub(crate) source: SourceArguments,

    /// Frames to measure
    #[arg(long, value_name = "N", default_value_t = 1800, value_parser = clap::value_parser!(u64).range(10..=10_000_000))]
    pub(crate) frames: u64,

    /// Frames to leave out at the beginning
    #[arg(long, value_name = "N", default_value_t = 90)]
    pub(crate) warm_up: u64,

    /// Folder for the report, the plots, the histograms and the timeline
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    /// How many of the newest frames the timeline shows, besides the ten worst
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(0..=1_000_000))]
    pub(crate) timeline: u32,

    /// File of limits (TOML); exit code 7 when one is exceeded
    #[arg(long, value_name = "FILE")]
    pub(crate) budget: Option<PathBuf>,

    /// Report (JSON) to compare with; exit code 7 when something is slower
    #[arg(long, value_name = "REPORT")]
    pub(crate) baseline: Option<PathBuf>,
}

/// What an own daemon gets its frames from.
#[derive(Debug, Clone, Args)]
pub(crate) struct SourceArguments {
    /// Start a daemon on this source, as `tabula run --source` does [without a daemon: simulation:isolated]
    #[arg(long, value_name = "SOURCE")]
    pub(crate) source: Option<String>,

    /// Objects of a simulated scene [without a daemon: 10]
    #[arg(long, value_name = "N")]
    pub(crate) objects: Option<u32>,

    /// Seed of a simulated scene
    #[arg(long, value_name = "S")]
    pub(crate) seed: Option<u64>,

    /// Frames per second [default: 30]
    #[arg(long, value_name = "HZ")]
    pub(crate) rate: Option<f64>,
}

impl SourceArguments {
    /// Whether anything is said of a source.
    pub(crate) fn is_given(&self) -> bool {
        self.source.is_some()
            || self.objects.is_some()
            || self.seed.is_some()
            || self.rate.is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(words: &str) -> Result<Arguments, clap::Error> {
        Arguments::try_parse_from(words.split_ascii_whitespace())
    }

    #[test]
    fn without_a_source_the_running_daemon_is_measured() {
        let arguments = parsed("tabula-latency --frames 100 --json").unwrap();
        assert!(!arguments.measure.source.is_given());
        assert!(arguments.json && arguments.verb.is_none());
        let arguments = parsed("tabula-latency --objects 3").unwrap();
        assert!(arguments.measure.source.is_given());
    }

    #[test]
    fn impossible_numbers_are_refused() {
        for words in ["--frames 0", "--frames many", "--timeline -1", "merge"] {
            assert!(
                parsed(&format!("tabula-latency {words}")).is_err(),
                "{words}"
            );
        }
        assert!(parsed("tabula-latency compare a.json b.json --json").is_ok());
    }
}
