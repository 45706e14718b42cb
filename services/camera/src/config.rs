//! Configuration section `[camera]`: parsing and validation.

use crate::arguments::CameraArguments;
use crate::source::{Playback, SourceSpec};
use capture::FramePace;
use serde::Deserialize;
use service::{ConfigFile, Failure, has_been_ready};

/// Valid frame rates, hertz.
const RATES_HZ: std::ops::RangeInclusive<f64> = 0.01..=1000.0;

/// Section `[camera]` as written in TOML.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct RawConfig {
    source: Option<String>,
    rate_hz: Option<f64>,
    #[serde(rename = "loop")]
    looped: bool,
    from_frame: Option<usize>,
    to_frame: Option<usize>,
    lockstep: bool,
}

/// Validated configuration of the camera.
#[derive(Debug, Clone, PartialEq)]
pub struct Config {
    /// Source of the camera frames.
    pub(crate) source: SourceSpec,
    /// Playback options.
    pub(crate) playback: Playback,
    /// Pace of the frames: on schedule or in lockstep.
    pub(crate) pace: FramePace,
    /// True if the source was checked before the start, as `tabula run` does, or has been usable
    /// before a restart by systemd: a failure to open it now may pass.
    pub(crate) is_source_checked: bool,
}

impl Config {
    /// Reads the section of the file, overridden by the arguments.
    ///
    /// # Errors
    /// A usage failure that names the value and its rule.
    pub fn new(arguments: &CameraArguments, file: &ConfigFile) -> Result<Self, Failure> {
        let raw: RawConfig = file.section("camera")?;
        let given = &arguments.source;
        // An overridden source may be the simulator's, and is not parsed.
        let written = raw.source.as_deref().filter(|_| given.source.is_none());
        let written = written.map(str::parse::<SourceSpec>).transpose();
        let written = written.map_err(|rule| file.wrong(format!("[camera] source: {rule}")))?;
        let config = Self {
            source: given
                .source
                .clone()
                .or(written)
                .unwrap_or(SourceSpec::Kinect),
            playback: Playback {
                rate_hz: given.rate.or(raw.rate_hz),
                looped: given.looped || raw.looped,
                from: given.from.or(raw.from_frame),
                to: given.to.or(raw.to_frame),
            },
            pace: match (given.lockstep_recorder, given.lockstep || raw.lockstep) {
                (true, _) => FramePace::LockstepWithRecorder,
                (false, true) => FramePace::Lockstep,
                (false, false) => FramePace::Schedule,
            },
            is_source_checked: arguments.process.follow_parent.is_some() || has_been_ready(),
        };
        config.check().map_err(Failure::usage)?;
        Ok(config)
    }

    fn check(&self) -> Result<(), String> {
        let Playback {
            rate_hz, from, to, ..
        } = self.playback;
        if let Some(rate) = rate_hz
            && !RATES_HZ.contains(&rate)
        {
            return Err(format!(
                "--rate must lie between 0.01 and 1000 frames per second, not {rate}"
            ));
        }
        if let (from, Some(to)) = (from.unwrap_or(0), to)
            && from >= to
        {
            return Err(format!(
                "--from {from} --to {to} plays nothing; --to must be the larger"
            ));
        }
        self.check_live()
    }

    /// Rejects playback options for a Kinect, real or played by fakenect: it has its own
    /// rate and no frame numbers.
    fn check_live(&self) -> Result<(), String> {
        let Playback {
            rate_hz,
            looped,
            from,
            to,
        } = self.playback;
        let name = match self.source {
            SourceSpec::Kinect => "kinect",
            SourceSpec::Fakenect(_) => "fakenect",
            _ => return Ok(()),
        };
        let refused = [
            ("--rate", rate_hz.is_some()),
            ("--from", from.is_some()),
            ("--to", to.is_some()),
            ("--lockstep", self.pace.is_lockstep()),
            ("--loop", looped && name == "kinect"),
        ];
        match refused.iter().find(|(_, is_given)| *is_given) {
            None => Ok(()),
            Some((option, _)) => Err(format!(
                "{option} cannot be used with --source {name}: libfreenect plays at the sensor's own pace"
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    fn config(words: &str) -> Result<Config, String> {
        let words = std::iter::once("tabula-camera").chain(words.split_ascii_whitespace());
        let arguments = CameraArguments::try_parse_from(words).map_err(|e| e.to_string())?;
        Config::new(&arguments, &ConfigFile::default()).map_err(|e| e.to_string())
    }

    #[test]
    fn source_is_a_kinect_unless_another_one_is_named() {
        assert_eq!(config("").unwrap().source, SourceSpec::Kinect);
        let named = config("--source synthetic").unwrap();
        assert_eq!(named.source, SourceSpec::Synthetic(0));
    }

    #[test]
    fn source_counts_as_checked_when_tabula_run_has_started_the_camera() {
        assert!(!config("--source kinect").unwrap().is_source_checked);
        let followed = config("--source kinect --follow-parent 1").unwrap();
        assert!(followed.is_source_checked);
    }

    #[test]
    fn impossible_playback_is_refused_with_its_rule() {
        let check = |words: &str, word: &str| {
            let sentence = config(words).unwrap_err();
            assert!(sentence.contains(word), "{sentence}");
        };
        check("--source synthetic --rate 0", "--rate");
        check("--source synthetic --rate NaN", "--rate");
        check("--source synthetic --from 5 --to 5", "plays nothing");
        check("--source kinect --loop", "--loop");
        check("--source fakenect:x --rate 5", "--rate");
        check("--source fakenect:x --from 1", "--from");
        check("--source fakenect:x --to 1", "--to");
        check("--source synthetic:x", "synthetic");
        assert!(config("--source fakenect:x --loop").is_ok());
    }
}
