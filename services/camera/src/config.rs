//! Configuration section `[camera]`: parsing and validation.

use crate::arguments::CameraArguments;
use crate::source::{Playback, SourceSpec};
use capture::FramePace;
use serde::Deserialize;
use service::{Configuration, Failure, KeyReference, is_service};

/// Name of the section.
const SECTION: &str = "camera";

/// Keys whose values are refused, and the reason.
type Violation = (&'static [&'static str], String);

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
    /// True if the source was checked before the start, as `tabula run` does, or the camera is a
    /// service, whose source may be mounted later: a failure to open it now may pass.
    pub(crate) is_source_awaited: bool,
}

impl Config {
    /// Reads the section of the configuration, overridden by the arguments.
    ///
    /// # Errors
    /// A usage failure that names the value and its rule.
    pub fn new(arguments: &CameraArguments, found: &Configuration) -> Result<Self, Failure> {
        let raw: RawConfig = found.section(SECTION)?;
        let given = &arguments.source;
        if let Some(rate) = given.rate {
            KeyReference::check_option(SECTION, "rate_hz", "--rate", rate)?;
        }
        // An overridden source may be the simulator's, and is not parsed.
        let written = raw.source.as_deref().filter(|_| given.source.is_none());
        let written = written.map(str::parse::<SourceSpec>).transpose();
        let written =
            written.map_err(|rule| found.wrong(SECTION, &["source"], format!("source: {rule}")))?;
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
            pace: FramePace::new(given.lockstep || raw.lockstep, &given.lockstep_with),
            is_source_awaited: arguments.process.follow_parent.is_some() || is_service(),
        };
        config.check().map_err(|(keys, sentence)| {
            let is_written = |key: &&str| !given.has(key) && found.setting(SECTION, key).is_some();
            let written: Vec<&str> = keys.iter().copied().filter(is_written).collect();
            match written.as_slice() {
                [] => Failure::usage(sentence),
                keys => found.wrong(SECTION, keys, sentence).into(),
            }
        })?;
        Ok(config)
    }

    /// First rule that the options and keys violate together, with the keys that it is about.
    fn check(&self) -> Result<(), Violation> {
        let Playback { from, to, .. } = self.playback;
        if let (from, Some(to)) = (from.unwrap_or(0), to)
            && from >= to
        {
            let sentence =
                format!("--from {from} --to {to} plays nothing; --to must be the larger");
            return Err((&["to_frame", "from_frame"], sentence));
        }
        self.check_live()
    }

    /// Rejects playback options for a Kinect, real or played by fakenect: it has its own
    /// rate and no frame numbers.
    fn check_live(&self) -> Result<(), Violation> {
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
        let refused: [(&str, &'static [&'static str], bool); 5] = [
            ("--rate", &["rate_hz"], rate_hz.is_some()),
            ("--from", &["from_frame"], from.is_some()),
            ("--to", &["to_frame"], to.is_some()),
            ("--lockstep", &["lockstep"], self.pace.is_lockstep()),
            ("--loop", &["loop"], looped && name == "kinect"),
        ];
        match refused.into_iter().find(|(.., is_given)| *is_given) {
            None => Ok(()),
            Some((option, keys, _)) => {
                let sentence = format!(
                    "{option} cannot be used with --source {name}: libfreenect plays at the \
                     sensor's own pace"
                );
                Err((keys, sentence))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::DEFAULT_RATE_HZ;
    use clap::Parser;

    fn arguments(words: &str) -> Result<CameraArguments, String> {
        let words = std::iter::once("tabula-camera").chain(words.split_ascii_whitespace());
        CameraArguments::try_parse_from(words).map_err(|e| e.to_string())
    }

    fn config(words: &str) -> Result<Config, String> {
        Config::new(&arguments(words)?, &Configuration::default()).map_err(|e| e.to_string())
    }

    #[test]
    fn section_agrees_with_the_key_reference() {
        let arguments = arguments("--source synthetic").unwrap();
        // Values that are not given are those that the source takes.
        let read = |found: &Configuration| {
            let mut config = Config::new(&arguments, found)?;
            config.playback.rate_hz.get_or_insert(DEFAULT_RATE_HZ);
            config.playback.from.get_or_insert(0);
            Ok::<_, Failure>(config)
        };
        service::check_section_reference(SECTION, read).unwrap();
    }

    #[test]
    fn refused_key_is_named_with_its_file_unless_an_option_overrides_it() {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), "[camera]\nrate_hz = 5.0\nto_frame = 3\n").unwrap();
        let found = Configuration::find(Some(file.path()), file.path()).unwrap();
        let sentence = |words: &str| {
            let failure = Config::new(&arguments(words).unwrap(), &found).unwrap_err();
            failure.sentence
        };
        let name = file.path().display().to_string();
        let frames = sentence("--source synthetic --from 4");
        assert!(
            frames.contains(&name) && frames.contains("line 3"),
            "{frames}"
        );
        let kinect = sentence("--source kinect");
        assert!(
            kinect.contains(&name) && kinect.contains("line 2"),
            "{kinect}"
        );
        assert!(!sentence("--source synthetic --rate 0").contains(&name));
    }

    #[test]
    fn source_is_a_kinect_unless_another_one_is_named() {
        assert_eq!(config("").unwrap().source, SourceSpec::Kinect);
        let named = config("--source synthetic").unwrap();
        assert_eq!(named.source, SourceSpec::Synthetic(0));
    }

    #[test]
    fn source_counts_as_checked_when_tabula_run_has_started_the_camera() {
        assert!(!config("--source kinect").unwrap().is_source_awaited);
        let followed = config("--source kinect --follow-parent 1").unwrap();
        assert!(followed.is_source_awaited);
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
