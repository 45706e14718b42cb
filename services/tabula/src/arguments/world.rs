//! Arguments of `tabula world`.

use clap::{Args, Subcommand};
use control_client::TrackReference;

/// Arguments of `tabula world`: queries of the world model.
#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true)]
pub(crate) struct WorldArguments {
    #[command(subcommand)]
    pub(crate) verb: Option<WorldVerb>,
}

/// Queries of the world model other than its present state.
#[derive(Debug, Subcommand)]
pub(crate) enum WorldVerb {
    /// Show past facts with their beginning and end, newest first
    History(HistoryArguments),
    /// Show the events of the world model, oldest first
    Events(EventsArguments),
    /// Show the robot's tasks, newest first
    Tasks {
        /// Maximum number of tasks
        #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..))]
        limit: u32,
    },
}

/// Filter of `tabula world history`.
#[derive(Debug, Args)]
#[command(after_help = TIME_HELP)]
pub(crate) struct HistoryArguments {
    /// Only facts of this track: its track-id, or words that mean exactly one object
    #[arg(long, value_name = "TRACK")]
    pub(crate) track: Option<TrackReference>,
    /// Only while the object had this label
    #[arg(long, value_name = "NAME")]
    pub(crate) label: Option<String>,
    /// Only while the object's centre was near this point of the world, metres
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true, requires = "radius")]
    pub(crate) near: Option<WorldPoint>,
    /// Radius around the point of --near, metres
    #[arg(long, value_name = "R", value_parser = radius, requires = "near")]
    pub(crate) radius: Option<f64>,
    /// Only facts that held at this time
    #[arg(long, value_name = "TIME", value_parser = time, allow_hyphen_values = true, conflicts_with_all = ["since", "until"])]
    pub(crate) at: Option<TimeArgument>,
    /// Only facts that held at this time or later
    #[arg(long, value_name = "TIME", value_parser = time, allow_hyphen_values = true)]
    pub(crate) since: Option<TimeArgument>,
    /// Only facts that held at this time or earlier
    #[arg(long, value_name = "TIME", value_parser = time, allow_hyphen_values = true)]
    pub(crate) until: Option<TimeArgument>,
    /// Maximum number of facts
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) limit: u32,
}

/// Arguments of `tabula world events`.
#[derive(Debug, Args)]
pub(crate) struct EventsArguments {
    /// Continue with each new event until Ctrl-C, or until the reader has gone
    #[arg(long)]
    pub(crate) follow: bool,
    /// Only events after this one [default: all; with --follow those from now on]
    #[arg(long, value_name = "SEQUENCE")]
    pub(crate) since: Option<u64>,
}

const TIME_HELP: &str = "TIME is a time ago: -90s, -10m, -2h, -3d; or seconds since 1970: \
                         1735689600, as `date +%s` prints them.";

/// Position in the world frame, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct WorldPoint(pub(crate) [f64; 3]);

/// Point in time as given on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TimeArgument {
    /// Relative time: nanoseconds before now.
    Ago(u64),
    /// Absolute time: nanoseconds since 1970.
    Absolute(u64),
}

impl TimeArgument {
    /// Nanoseconds since 1970, relative to the present time `now_ns`.
    pub(crate) fn at(self, now_ns: u64) -> u64 {
        match self {
            Self::Ago(ns) => now_ns.saturating_sub(ns),
            Self::Absolute(ns) => ns,
        }
    }
}

fn point(text: &str) -> Result<WorldPoint, String> {
    let values: Result<Vec<f64>, _> = text.split(',').map(|value| value.trim().parse()).collect();
    let values = values.unwrap_or_default();
    match <[f64; 3]>::try_from(values) {
        Ok(point) if point.iter().all(|value| value.is_finite()) => Ok(WorldPoint(point)),
        _ => Err("a point is three numbers with commas between them: 0.1,-0.2,0.75".into()),
    }
}

fn radius(text: &str) -> Result<f64, String> {
    let value = text.parse().unwrap_or(f64::NAN);
    if (0.0..=1e6).contains(&value) {
        return Ok(value);
    }
    Err("a radius is a number of metres, 0 or more".into())
}

fn time(text: &str) -> Result<TimeArgument, String> {
    parse_time(text).ok_or_else(|| {
        "a time is -90s, -10m, -2h or -3d for a time ago, or seconds since 1970".into()
    })
}

fn parse_time(text: &str) -> Option<TimeArgument> {
    const LATEST_S: f64 = 1e10;
    let seconds_in = |value: &str, unit_s: f64| {
        let seconds = value.parse::<f64>().ok()? * unit_s;
        (0.0..=LATEST_S)
            .contains(&seconds)
            .then_some((seconds * 1e9) as u64)
    };
    let Some(ago) = text.strip_prefix('-') else {
        return seconds_in(text, 1.0).map(TimeArgument::Absolute);
    };
    let unit = ago.chars().last()?;
    let unit_s = match unit {
        's' => 1.0,
        'm' => 60.0,
        'h' => 3600.0,
        'd' => 86_400.0,
        _ => return None,
    };
    seconds_in(&ago[..ago.len() - unit.len_utf8()], unit_s).map(TimeArgument::Ago)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_offsets_or_seconds() {
        let second = 1_000_000_000;
        assert_eq!(time("-90s"), Ok(TimeArgument::Ago(90 * second)));
        assert_eq!(time("-1.5m"), Ok(TimeArgument::Ago(90 * second)));
        assert_eq!(time("-2h"), Ok(TimeArgument::Ago(7200 * second)));
        assert_eq!(time("-3d"), Ok(TimeArgument::Ago(3 * 86_400 * second)));
        assert_eq!(
            time("1735689600"),
            Ok(TimeArgument::Absolute(1_735_689_600 * second))
        );
        for wrong in [
            "", "-", "-m", "-10", "-10é", "noon", "nan", "-infs", "1e300",
        ] {
            assert!(time(wrong).is_err(), "{wrong}");
        }
        assert_eq!(TimeArgument::Ago(5).at(3), 0);
        assert_eq!(
            (TimeArgument::Ago(5).at(8), TimeArgument::Absolute(5).at(8)),
            (3, 5)
        );
    }

    #[test]
    fn points_are_three_numbers() {
        assert_eq!(point("0.1,-0.2, 0.75"), Ok(WorldPoint([0.1, -0.2, 0.75])));
        for wrong in ["", "1,2", "1,2,3,4", "1,2,nan", "a,b,c"] {
            assert!(point(wrong).is_err(), "{wrong}");
        }
        assert!(radius("-1").is_err() && radius("nan").is_err() && radius("0.5") == Ok(0.5));
    }
}
