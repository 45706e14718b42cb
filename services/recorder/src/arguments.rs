//! Command-line arguments of `tabula-recorder`.

use clap::{Args, Parser, Subcommand};
use service::{CommonArguments, Failure, OptionUse};
use std::path::PathBuf;

/// Largest rate of what is written for Foxglove, hertz.
const FOXGLOVE_HZ_MAX: f64 = 100.0;

/// Records a running daemon to MCAP files; describes, recovers and replays recordings.
#[derive(Debug, Parser)]
#[command(name = "tabula-recorder", version, propagate_version = true)]
pub(crate) struct RecorderArguments {
    #[command(flatten)]
    pub(crate) common: CommonArguments,

    /// Print one JSON document instead of text
    #[arg(long, global = true, help_heading = "Common options")]
    pub(crate) json: bool,

    #[command(subcommand)]
    pub(crate) verb: RecorderVerb,
}

/// Subcommands of `tabula-recorder`.
#[derive(Debug, Subcommand)]
pub(crate) enum RecorderVerb {
    /// Record the daemon of the domain until Ctrl-C; describe or recover a recording
    Record(RecordArguments),
    /// Replay a recording in a daemon
    Replay(ReplayArguments),
}

impl RecorderVerb {
    /// Use of the options of every command.
    pub(crate) fn option_use(&self) -> OptionUse {
        match self {
            Self::Record(record) if record.recover.is_some() || record.info.is_some() => {
                OptionUse::Nothing
            }
            Self::Record(_) => OptionUse::Daemon,
            // In a daemon of its own, which ends with the recording.
            Self::Replay(replay) if replay.events.is_some() => OptionUse::Configuration,
            Self::Replay(_) => OptionUse::Everything,
        }
    }
}

/// Options of a recording.
#[derive(Debug, Clone, Args)]
pub(crate) struct RecordArguments {
    /// Folder of the recordings; with --recover, the new file [default: the present folder]
    #[arg(long, value_name = "PATH")]
    pub(crate) out: Option<PathBuf>,
    /// Size at which a new file is begun, megabytes
    #[arg(long, value_name = "MB", default_value_t = 1000, value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) rotate_mb: u64,
    /// Duration at which a new file is begun, seconds
    #[arg(long, value_name = "S", default_value_t = 300, value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) rotate_s: u64,
    /// Total size of this domain's recordings in the folder, above which the oldest are deleted, megabytes
    /// [default: none]
    #[arg(long, value_name = "MB", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) keep_mb: Option<u64>,
    /// Free disk space below which the recording stops, megabytes
    #[arg(long, value_name = "MB", default_value_t = 1000)]
    pub(crate) min_free_mb: u64,
    /// Stop after this time, seconds
    #[arg(long, value_name = "S", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) duration_s: Option<u64>,
    /// Stop after this number of frames
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) frames: Option<u64>,
    /// Points and images a second for Foxglove and Lichtblick; 0 leaves all messages for them out
    #[arg(long, value_name = "HZ", default_value_t = 2.0)]
    pub(crate) foxglove_hz: f64,
    /// Largest number of points of a cloud for Foxglove
    #[arg(long, value_name = "N", default_value_t = 20_000)]
    pub(crate) foxglove_points: usize,
    /// Recover a recording that was cut or damaged: write all that is intact into a new file
    #[arg(long, value_name = "FILE")]
    pub(crate) recover: Option<PathBuf>,
    /// Describe a recording: time range, topics, gaps between frames, damage
    #[arg(long, value_name = "FILE", conflicts_with = "recover")]
    pub(crate) info: Option<PathBuf>,
}

/// Options of a replay.
#[derive(Debug, Clone, Args)]
pub(crate) struct ReplayArguments {
    /// Recording to replay (.mcap)
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,
    /// Frames per second [default: as recorded]
    #[arg(long, value_name = "HZ", allow_hyphen_values = true)]
    pub(crate) rate: Option<String>,
    /// Start the recording again when it ends
    #[arg(long = "loop", conflicts_with = "events")]
    pub(crate) looped: bool,
    /// First frame of the recording, counted from 0
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub(crate) from: Option<String>,
    /// Frame number before which the replay ends
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    pub(crate) to: Option<String>,
    /// Send a frame only when perception and memory have finished the previous one
    #[arg(long)]
    pub(crate) lockstep: bool,
    /// Write the canonical events of a replay with an empty memory, print their digest, and stop
    #[arg(long, value_name = "OUT", requires = "lockstep")]
    pub(crate) events: Option<PathBuf>,
}

impl RecordArguments {
    /// Checks the values that the parser cannot check.
    ///
    /// # Errors
    /// A usage failure that names the value and its rule.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        if !(0.0..=FOXGLOVE_HZ_MAX).contains(&self.foxglove_hz) {
            return Err(Failure::usage(format!(
                "--foxglove-hz must lie between 0 and {FOXGLOVE_HZ_MAX}, not {}",
                self.foxglove_hz
            )));
        }
        Ok(())
    }
}

impl ReplayArguments {
    /// Arguments of `tabula run` for this replay.
    pub(crate) fn run_arguments(&self) -> Vec<String> {
        let values = [
            ("--rate", &self.rate),
            ("--from", &self.from),
            ("--to", &self.to),
        ];
        let values = values
            .into_iter()
            .filter_map(|(name, value)| Some(format!("{name}={}", value.as_ref()?)));
        let flags = [("--loop", self.looped), ("--lockstep", self.lockstep)];
        let flags = flags.into_iter().filter(|(_, is_set)| *is_set);
        std::iter::once(format!("--source={}", self.file.display()))
            .chain(values)
            .chain(flags.map(|(name, _)| name.to_owned()))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(words: &str) -> Result<RecorderVerb, String> {
        let words = std::iter::once("tabula-recorder").chain(words.split_ascii_whitespace());
        let arguments = RecorderArguments::try_parse_from(words);
        arguments
            .map(|arguments| arguments.verb)
            .map_err(|error| error.to_string())
    }

    #[test]
    fn replay_passes_its_options_on() {
        let Ok(RecorderVerb::Replay(replay)) = parse("replay a.mcap --rate 5 --lockstep") else {
            panic!("no replay");
        };
        assert_eq!(
            replay.run_arguments(),
            ["--source=a.mcap", "--rate=5", "--lockstep"]
        );
    }

    #[test]
    fn events_need_lockstep_and_an_end() {
        assert!(parse("replay a.mcap --events e").is_err());
        assert!(parse("replay a.mcap --lockstep --events e --loop").is_err());
        assert!(parse("replay a.mcap --lockstep --events e").is_ok());
    }

    #[test]
    fn impossible_limits_are_refused() {
        for wrong in [
            "--rotate-mb 0",
            "--rotate-s 0",
            "--keep-mb 0",
            "--duration-s 0",
            "--frames 0",
        ] {
            assert!(parse(&format!("record {wrong}")).is_err(), "{wrong}");
        }
        let Ok(RecorderVerb::Record(record)) = parse("record --foxglove-hz NaN") else {
            panic!("no recording");
        };
        assert!(record.check().is_err());
    }
}
