//! Configuration section `[perception]`: parsing and validation.

#[cfg(feature = "fault-injection")]
use crate::fault_injection::FaultConfig;
use actor::RestartPolicy;
use detection::InvalidConfig;
use message::Text;
use sensor_noise::DepthNoise;
use serde::Deserialize;
use service::{Configuration, Failure};
use std::fmt::Display;
use std::num::NonZeroUsize;
use std::time::Duration;
use tracking::{AssociationConfig, MotionConfig};

/// Restart back-off of a failed actor; doubled by each further failure within the window.
const FIRST_BACKOFF: Duration = Duration::from_millis(50);
const LONGEST_BACKOFF: Duration = Duration::from_secs(1);

/// Name of the section.
const SECTION: &str = "perception";

/// Section `[perception]` as written in TOML.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawConfig {
    workers: NonZeroUsize,
    known_probability_min: f32,
    actor_deadline_ms: u64,
    worker_stall_ms: u64,
    actor_restarts_max: u32,
    actor_restart_window_s: f64,
    depth_noise: String,
    range_min_m: f64,
    range_max_m: f64,
    object_height_max_m: f64,
    object_side_max_m: f64,
    join_object_parts: bool,
    candidate_rule: String,
    graspable_side_max_m: f64,
    rim_distance_m: f64,
    robot_margin_m: f64,
    person_margin_m: f64,
    #[cfg(feature = "fault-injection")]
    fault_panic_every_ms: Option<u64>,
    #[cfg(feature = "fault-injection")]
    fault_panic_track_id: Option<u64>,
    #[cfg(feature = "fault-injection")]
    fault_panic_frame: Option<u64>,
}

/// Validated configuration of perception.
#[derive(Debug, Clone)]
pub(crate) struct Config {
    /// Number of worker threads of the kernel pool.
    pub(crate) workers: NonZeroUsize,
    /// Deadline of a frame for its actors; none in lockstep.
    pub(crate) actor_deadline: Duration,
    /// Watchdog time: a worker without progress for this long is replaced.
    pub(crate) worker_stall: Duration,
    /// Restart limit of all object actors together within the window.
    pub(crate) actor_restarts_max: u32,
    /// Length of the sliding window in which restarts count.
    pub(crate) actor_restart_window: Duration,
    /// Settings of fault injection.
    #[cfg(feature = "fault-injection")]
    pub(crate) fault: FaultConfig,
    /// Detection settings.
    pub(crate) detection: detection::Config,
    /// Tracking and recognition settings.
    pub(crate) pipeline: pipeline::Config,
}

impl Config {
    /// Reads and validates the section of the configuration.
    pub(crate) fn new(found: &Configuration) -> Result<Self, Failure> {
        let raw: RawConfig = found.section_with_defaults(SECTION)?;
        let wrong = |key: &str, rule: &dyn Display| {
            Failure::from(found.wrong(SECTION, &[key], format!("{key} {rule}")))
        };
        let (motion, association) = (MotionConfig::default(), AssociationConfig::default());
        Ok(Self {
            workers: raw.workers,
            actor_deadline: Duration::from_millis(raw.actor_deadline_ms),
            worker_stall: Duration::from_millis(raw.worker_stall_ms),
            actor_restarts_max: raw.actor_restarts_max,
            actor_restart_window: Duration::from_secs_f64(raw.actor_restart_window_s),
            #[cfg(feature = "fault-injection")]
            fault: FaultConfig {
                panic_every: Duration::from_millis(raw.fault_panic_every_ms.unwrap_or(0)),
                track_id: raw.fault_panic_track_id.unwrap_or(1),
                frame: raw.fault_panic_frame,
            },
            detection: detection(&raw).map_err(|WrongKey(key, rule)| wrong(key, &rule))?,
            pipeline: pipeline::Config::new(motion, association, raw.known_probability_min)
                .map_err(|rule| wrong("known_probability_min", &format!("is invalid: {rule}")))?,
        })
    }

    /// Restart policy of the object actors.
    pub(crate) fn restart_policy(&self) -> Result<RestartPolicy, actor::Error> {
        RestartPolicy::new(
            self.actor_restarts_max,
            self.actor_restart_window,
            FIRST_BACKOFF,
            LONGEST_BACKOFF,
        )
    }
}

/// Key with an invalid value, and the rule: the end of a sentence that begins with the key.
#[derive(Debug, PartialEq)]
struct WrongKey(&'static str, String);

/// Validated detection settings, or the invalid key.
fn detection(raw: &RawConfig) -> Result<detection::Config, WrongKey> {
    let depth_noise = DepthNoise::named(&raw.depth_noise).ok_or_else(|| {
        let names = DepthNoise::NAMES.join(", ");
        WrongKey("depth_noise", format!("must be one of {names}"))
    })?;
    let settings = detection::RawConfig {
        depth_noise,
        range_min_m: raw.range_min_m,
        range_max_m: raw.range_max_m,
        height_max_m: raw.object_height_max_m,
        side_max_m: raw.object_side_max_m,
        joins_parts: raw.join_object_parts,
        rule: raw.candidate_rule.clone(),
        graspable_side_max_m: raw.graspable_side_max_m,
        rim_distance_m: raw.rim_distance_m,
        robot_margin_m: raw.robot_margin_m,
        person_margin_m: raw.person_margin_m,
        ..detection::RawConfig::default()
    };
    let config = detection::Config::new(settings).map_err(|error| match error {
        InvalidConfig::Rule(error) => WrongKey("candidate_rule", format!("is invalid: {error}")),
        other => WrongKey(
            "candidate_rule",
            format!("or another key is invalid: {other}"),
        ),
    })?;
    let length = config.rule().to_string().len();
    if length > Text::CAPACITY {
        let rule = format!(
            "is {length} bytes long when written with ∧ ∨ ¬, and the scene carries {} at most; \
             write a shorter one",
            Text::CAPACITY
        );
        return Err(WrongKey("candidate_rule", rule));
    }
    Ok(config)
}

#[cfg(test)]
mod tests {
    use super::*;
    use channel::topic::{CameraCloud, Topic};
    use learning::{NoveltyPrior, UnknownRule};

    #[cfg(not(feature = "fault-injection"))]
    #[test]
    fn section_agrees_with_the_key_reference() {
        // One rule may be spelt in several ways.
        let read = |found: &Configuration| {
            let config = Config::new(found)?;
            let spelt = format!("{:?}", config.detection.get().rule);
            Ok::<_, Failure>(format!("{config:?}").replace(&spelt, "rule"))
        };
        service::check_section_reference(SECTION, read).unwrap();
    }

    /// Configuration of a file with one setting, or the sentence that refuses it.
    fn with(setting: &str) -> Result<Config, String> {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), format!("[perception]\n{setting}\n")).unwrap();
        let found = Configuration::find(Some(file.path()), file.path());
        let found = found.map_err(|error| error.to_string())?;
        Config::new(&found).map_err(|failure| failure.sentence)
    }

    fn with_rule(rule: &str) -> Result<detection::Config, String> {
        with(&format!("candidate_rule = {rule:?}")).map(|config| config.detection)
    }

    #[test]
    fn defaults_are_those_of_detection_and_recognition() {
        let config = Config::new(&Configuration::default()).unwrap();
        // One rule may be spelt in several ways.
        let built_in = detection::RawConfig {
            rule: config.detection.get().rule.clone(),
            ..detection::RawConfig::default()
        };
        assert_eq!(
            Ok(config.detection.clone()),
            detection::Config::new(built_in)
        );
        assert_eq!(config.detection.rule(), detection::Config::default().rule());
        let unknown_rule = UnknownRule::LessProbableThan {
            probability: pipeline::Config::KNOWN_PROBABILITY_MIN,
            novelty_prior: NoveltyPrior::default().probability(),
        };
        assert_eq!(config.pipeline.unknown_rule(), unknown_rule);
    }

    #[test]
    fn workers_are_as_many_as_a_subscriber_may_hold_frames_for() {
        // One frame for each worker, one for the loop, and one to come.
        let most = CameraCloud::LIMITS.borrowed - 2;
        assert_eq!(
            with(&format!("workers = {most}")).unwrap().workers.get(),
            most
        );
        assert!(with(&format!("workers = {}", most + 1)).is_err());
    }

    #[test]
    fn depth_noise_is_a_law_by_name() {
        for (name, law) in DepthNoise::NAMES.map(|name| (name, DepthNoise::named(name))) {
            let config = with(&format!("depth_noise = {name:?}")).unwrap();
            assert_eq!(Some(config.detection.get().depth_noise), law);
        }
        let sentence = with("depth_noise = \"kinect\"").unwrap_err();
        assert!(sentence.contains("depth_noise"), "{sentence}");
        assert!(
            sentence.contains("kinect-v1, stereo, time-of-flight"),
            "{sentence}"
        );
    }

    #[test]
    fn invalid_restart_limits_are_named() {
        assert_eq!(
            with("actor_restarts_max = 0").unwrap().actor_restarts_max,
            0
        );
        assert!(with("actor_restarts_max = 10001").is_err());
        let window = with("actor_restart_window_s = 1.5")
            .unwrap()
            .actor_restart_window;
        assert_eq!(window, Duration::from_millis(1500));
        for wrong in ["nan", "0.0", "-1.0", "inf"] {
            let sentence = with(&format!("actor_restart_window_s = {wrong}")).unwrap_err();
            assert!(sentence.contains("between 1 and 86400"), "{sentence}");
        }
    }

    #[test]
    fn candidate_rule_is_read_from_the_file() {
        let config = with_rule("table and not image_border").unwrap();
        assert_eq!(config.rule().to_string(), "C_table ∧ ¬C_image_border");
    }

    #[test]
    fn invalid_candidate_rules_are_named() {
        for (rule, word) in [
            ("C_table and C_unicorn", "C_unicorn"),
            ("", "empty"),
            (&["table"; 20].join(" and "), "shorter"),
        ] {
            let sentence = with_rule(rule).unwrap_err();
            assert!(sentence.contains("candidate_rule"), "{sentence}");
            assert!(sentence.contains(word), "{sentence}");
        }
    }
}
