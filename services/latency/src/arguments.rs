//! Command-line arguments of `tabula-latency`.

use crate::stop::StopCondition;
use crate::sweep_axis::SweepAxis;
use clap::{Args, Parser, Subcommand};
use service::{CommonArguments, Failure, OptionUse, parse_arguments};
use std::path::{Path, PathBuf};

/// Default number of measured frames.
const DEFAULT_FRAMES: u64 = 1800;
/// Default number of frames in the timeline.
const DEFAULT_TIMELINE: u32 = 100;
/// Default number of warm-up frames.
const DEFAULT_WARM_UP: u64 = 90;
/// Source and number of objects when none is given and no daemon runs.
const DEFAULT_SOURCE: &str = "simulation:isolated";
const DEFAULT_OBJECTS: u32 = 10;

/// Measures the end-to-end latency of frames: in the daemon of the domain, or, with a source or
/// without a daemon, in one that it starts for itself.
#[derive(Debug, Parser)]
#[command(name = "tabula-latency", version)]
pub(crate) struct LatencyArguments {
    #[command(flatten)]
    pub(crate) common: CommonArguments,

    /// Print one JSON document instead of text
    #[arg(long, global = true, help_heading = "Common options")]
    pub(crate) json: bool,

    #[command(flatten)]
    pub(crate) measure: MeasureArguments,

    #[command(subcommand)]
    pub(crate) command: Option<LatencyCommand>,
}

/// Subcommands of `tabula-latency` other than a measurement of frames.
#[derive(Debug, Subcommand)]
pub(crate) enum LatencyCommand {
    /// Measure the system noise of this computer, idle and busy, and under real-time settings
    Machine {
        /// Run for a tenth of the duration
        #[arg(long)]
        short: bool,
        /// Folder for the report and the plot
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
    },
    /// Compare the transport with common alternatives, or the detection with PCL's, in one run;
    /// builds the peers
    Peers {
        /// Run a tenth of the repetitions
        #[arg(long)]
        short: bool,
        /// Script that times PCL's pipelines on scenes and prints CSV
        #[arg(long, value_name = "SCRIPT", requires = "scenes")]
        pcl: Option<PathBuf>,
        /// Scenes on which the detections are compared (.pcd)
        #[arg(requires = "pcl", value_name = "SCENE")]
        scenes: Vec<PathBuf>,
    },
    /// Soak test: run for a long time with objects that come and go, and report growth
    Soak(SoakArguments),
    /// Measure the time from a stop to the braking of the simulated arm, under conditions, each with
    /// a daemon of its own
    Stop(StopArguments),
    /// Sweep one parameter, with a daemon of its own for each value
    Sweep(SweepArguments),
    /// Compare two reports: what is faster, slower, or undecided
    Compare {
        /// Baseline report (JSON)
        before: PathBuf,
        /// Report to compare with the baseline (JSON)
        now: PathBuf,
    },
    /// Merge histogram files of several measurements
    Merge {
        /// Histogram files to merge (.hlog)
        #[arg(required = true)]
        files: Vec<PathBuf>,
        /// Write the merged histograms to this file
        #[arg(long, value_name = "FILE")]
        out: Option<PathBuf>,
    },
}

/// Options of a measurement and its outputs.
#[derive(Debug, Clone, PartialEq, Args)]
pub(crate) struct MeasureArguments {
    #[command(flatten)]
    pub(crate) source: SourceArguments,

    /// Frames to measure
    #[arg(long, value_name = "N", default_value_t = DEFAULT_FRAMES, value_parser = clap::value_parser!(u64).range(10..=10_000_000))]
    pub(crate) frames: u64,

    /// Number of warm-up frames to leave out at the beginning
    #[arg(long, value_name = "N", default_value_t = DEFAULT_WARM_UP)]
    pub(crate) warm_up: u64,

    /// Folder for the report, the plots, the histograms and the timeline
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    /// Number of newest frames in the timeline, in addition to the ten slowest
    #[arg(long, value_name = "N", default_value_t = DEFAULT_TIMELINE, value_parser = clap::value_parser!(u32).range(0..=1_000_000))]
    pub(crate) timeline: u32,

    /// File of limits (TOML); exit code 7 when one is exceeded
    #[arg(long, value_name = "FILE")]
    pub(crate) budget: Option<PathBuf>,

    /// Report (JSON) to compare with; exit code 7 when something is slower
    #[arg(long, value_name = "REPORT")]
    pub(crate) baseline: Option<PathBuf>,
}

/// Options of a parameter sweep.
#[derive(Debug, Clone, Args)]
pub(crate) struct SweepArguments {
    /// Parameter to sweep
    #[arg(value_enum)]
    pub(crate) axis: SweepAxis,

    /// Values to measure, separated by commas [default: five to eight usual ones]
    #[arg(long, value_name = "N,N", value_delimiter = ',')]
    pub(crate) values: Vec<u32>,

    /// Number of frames to measure at each value
    #[arg(long, value_name = "N", default_value_t = 600, value_parser = clap::value_parser!(u64).range(10..=1_000_000))]
    pub(crate) frames: u64,

    /// Folder for the table and the plot
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
}

/// Options of the measurement of stops.
#[derive(Debug, Clone, Args)]
pub(crate) struct StopArguments {
    /// Number of stops under each condition
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) stops: u32,

    /// Conditions to measure, separated by commas [default: all]
    #[arg(long, value_enum, value_name = "NAME,NAME", value_delimiter = ',')]
    pub(crate) conditions: Vec<StopCondition>,

    /// Let the arm's loop run without real-time priority
    #[arg(long)]
    pub(crate) without_real_time: bool,

    /// Folder for the table and the plot
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
}

/// Options of a soak test.
#[derive(Debug, Clone, Args)]
pub(crate) struct SoakArguments {
    /// Number of frames of the whole test
    #[arg(long, value_name = "N", default_value_t = 200_000, value_parser = clap::value_parser!(u64).range(100..=1_000_000_000))]
    pub(crate) frames: u64,

    /// Frames per second
    #[arg(long, value_name = "HZ", default_value_t = 120.0)]
    pub(crate) rate: f64,

    /// Number of objects; a quarter of them is absent at any time
    #[arg(long, value_name = "N", default_value_t = 12, value_parser = clap::value_parser!(u32).range(1..=256))]
    pub(crate) objects: u32,

    /// Folder for the table and the plot
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
}

/// Frame source of a daemon that is started for the measurement.
#[derive(Debug, Clone, Default, PartialEq, Args)]
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

impl LatencyArguments {
    /// Parses and validates the arguments of this process.
    ///
    /// # Errors
    /// If options of a measurement precede a subcommand that does not measure.
    pub(crate) fn checked() -> Result<Self, Failure> {
        let arguments: Self = parse_arguments();
        if arguments.command.is_some() && arguments.measure != MeasureArguments::default() {
            return Err(Failure::usage(
                "options before a subcommand are those of a measurement; put the subcommand's own options after it",
            ));
        }
        Ok(arguments)
    }

    /// Use of the options of every command.
    pub(crate) fn option_use(&self) -> OptionUse {
        match &self.command {
            None if self.measure.source.is_given() => OptionUse::Configuration,
            None => OptionUse::Everything,
            Some(LatencyCommand::Soak(_) | LatencyCommand::Sweep(_)) => OptionUse::Configuration,
            Some(
                LatencyCommand::Machine { .. }
                | LatencyCommand::Peers { .. }
                | LatencyCommand::Stop(_)
                | LatencyCommand::Compare { .. }
                | LatencyCommand::Merge { .. },
            ) => OptionUse::Nothing,
        }
    }
}

impl Default for MeasureArguments {
    /// Measurement when no option is given.
    fn default() -> Self {
        Self {
            source: SourceArguments::default(),
            frames: DEFAULT_FRAMES,
            warm_up: DEFAULT_WARM_UP,
            out: None,
            timeline: DEFAULT_TIMELINE,
            budget: None,
            baseline: None,
        }
    }
}

impl SourceArguments {
    /// Frame source by name, without other options.
    pub(crate) fn of(source: &str) -> Self {
        Self {
            source: Some(source.to_owned()),
            ..Self::default()
        }
    }

    /// Arguments for `tabula run`, with the daemon's configuration if given.
    pub(crate) fn run_arguments(&self, config: Option<&Path>) -> Vec<String> {
        let name = self.source.as_deref().unwrap_or(DEFAULT_SOURCE);
        // A recording is looped, because the measurement determines its length.
        let plays_files = Path::new(name).is_dir();
        let objects = match (self.objects, &self.source) {
            (None, None) => Some(DEFAULT_OBJECTS),
            (given, _) => given,
        };
        let mut arguments = vec![format!("--source={name}")];
        arguments.extend(plays_files.then(|| "--loop".to_owned()));
        arguments.extend(objects.map(|n| format!("--objects={n}")));
        arguments.extend(self.seed.map(|seed| format!("--seed={seed}")));
        arguments.extend(self.rate.map(|rate| format!("--rate={rate}")));
        arguments.extend(config.map(|path| format!("--config={}", path.display())));
        arguments
    }

    /// `true` if any option of the source is given.
    pub(crate) fn is_given(&self) -> bool {
        *self != Self::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(words: &str) -> Result<LatencyArguments, clap::Error> {
        LatencyArguments::try_parse_from(words.split_ascii_whitespace())
    }

    #[test]
    fn default_of_a_measurement_is_that_of_the_command_line() {
        let arguments = parsed("tabula-latency").unwrap();
        assert_eq!(arguments.measure, MeasureArguments::default());
    }

    #[test]
    fn running_daemon_is_measured_without_a_source() {
        let arguments = parsed("tabula-latency --frames 100 --json").unwrap();
        assert!(!arguments.measure.source.is_given());
        assert!(arguments.json && arguments.command.is_none());
        let arguments = parsed("tabula-latency --objects 3").unwrap();
        assert!(arguments.measure.source.is_given());
    }

    #[test]
    fn numbers_out_of_range_are_refused() {
        for words in ["--frames 0", "--frames many", "--timeline -1", "merge"] {
            assert!(
                parsed(&format!("tabula-latency {words}")).is_err(),
                "{words}"
            );
        }
        assert!(parsed("tabula-latency compare a.json b.json --json").is_ok());
    }
}
