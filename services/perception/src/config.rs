//! Configuration section `[perception]`: parsing and validation.

#[cfg(feature = "fault-injection")]
use crate::fault_injection::FaultConfig;
use actor::RestartPolicy;
use channel::topic::{CameraCloud, Topic};
use detection::InvalidConfig;
use message::Text;
use sensor_noise::DepthNoise;
use serde::Deserialize;
use service::{Configuration, Failure};
use std::fmt::Display;
use std::num::NonZeroUsize;
use std::ops::RangeInclusive;
use std::time::Duration;
use tracking::{AssociationConfig, MotionConfig};

/// Largest number of workers. A subscriber may hold a limited number of frames: one for
/// each worker, one for the loop, and one to come.
const MAX_WORKERS: usize = CameraCloud::LIMITS.borrowed - 2;

/// Largest restart limit; every restart within the window is kept in memory.
const RESTARTS_MAX: u32 = 10_000;
const RESTART_WINDOW_MAX_S: f64 = 86_400.0;

/// Restart back-off of a failed actor; doubled by each further failure within the window.
const FIRST_BACKOFF: Duration = Duration::from_millis(50);
const LONGEST_BACKOFF: Duration = Duration::from_secs(1);

/// Name of the section.
const SECTION: &str = "perception";

/// Section `[perception]` as written in TOML.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct RawConfig {
    workers: usize,
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
    fault_panic_every_ms: u64,
    #[cfg(feature = "fault-injection")]
    fault_panic_track_id: u64,
}

impl Default for RawConfig {
    fn default() -> Self {
        let detection = detection::RawConfig::default();
        Self {
            workers: 2,
            known_probability_min: pipeline::Config::KNOWN_PROBABILITY_MIN,
            actor_deadline_ms: 100,
            worker_stall_ms: 2_000,
            actor_restarts_max: 30,
            actor_restart_window_s: 60.0,
            depth_noise: "kinect-v1".to_owned(),
            range_min_m: detection.range_min_m,
            range_max_m: detection.range_max_m,
            object_height_max_m: detection.height_max_m,
            object_side_max_m: detection.side_max_m,
            join_object_parts: detection.joins_parts,
            candidate_rule: detection.rule,
            graspable_side_max_m: detection.graspable_side_max_m,
            rim_distance_m: detection.rim_distance_m,
            robot_margin_m: detection.robot_margin_m,
            person_margin_m: detection.person_margin_m,
            #[cfg(feature = "fault-injection")]
            fault_panic_every_ms: 0,
            #[cfg(feature = "fault-injection")]
            fault_panic_track_id: 1,
        }
    }
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
        let raw: RawConfig = found.section(SECTION)?;
        let wrong = |key: &str, rule: &dyn Display| {
            Failure::from(found.wrong(SECTION, &[key], format!("{key} {rule}")))
        };
        let milliseconds = |key: &str, value: u64, range: RangeInclusive<u64>| {
            if range.contains(&value) {
                return Ok(Duration::from_millis(value));
            }
            let (least, most) = range.into_inner();
            let rule = format!("must lie between {least} and {most}, not {value}");
            Err(wrong(key, &rule))
        };
        let workers = NonZeroUsize::new(raw.workers).filter(|workers| workers.get() <= MAX_WORKERS);
        let workers_rule = format!("must lie between 1 and {MAX_WORKERS}, not {}", raw.workers);
        let (motion, association) = (MotionConfig::default(), AssociationConfig::default());
        Ok(Self {
            workers: workers.ok_or_else(|| wrong("workers", &workers_rule))?,
            actor_deadline: milliseconds("actor_deadline_ms", raw.actor_deadline_ms, 1..=60_000)?,
            worker_stall: milliseconds("worker_stall_ms", raw.worker_stall_ms, 100..=2_000)?,
            actor_restarts_max: restarts_max(&raw)
                .map_err(|rule| wrong("actor_restarts_max", &rule))?,
            actor_restart_window: restart_window(&raw)
                .map_err(|rule| wrong("actor_restart_window_s", &rule))?,
            #[cfg(feature = "fault-injection")]
            fault: FaultConfig {
                panic_every: Duration::from_millis(raw.fault_panic_every_ms),
                track_id: raw.fault_panic_track_id,
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

fn restarts_max(raw: &RawConfig) -> Result<u32, String> {
    let given = raw.actor_restarts_max;
    (given <= RESTARTS_MAX)
        .then_some(given)
        .ok_or_else(|| format!("must lie between 0 and {RESTARTS_MAX}, not {given}"))
}

fn restart_window(raw: &RawConfig) -> Result<Duration, String> {
    let given = raw.actor_restart_window_s;
    // NaN is in no range, and so is refused.
    if (1.0..=RESTART_WINDOW_MAX_S).contains(&given) {
        return Ok(Duration::from_secs_f64(given));
    }
    Err(format!(
        "must lie between 1 and {RESTART_WINDOW_MAX_S}, not {given}"
    ))
}

/// Key of a detection setting that is configured, by the setting's name.
fn key_of(setting: &'static str) -> &'static str {
    match setting {
        "height_max_m" => "object_height_max_m",
        "side_max_m" => "object_side_max_m",
        other => other,
    }
}

/// Validated detection settings, or the invalid key.
fn detection(raw: &RawConfig) -> Result<detection::Config, WrongKey> {
    let depth_noise = DepthNoise::named(&raw.depth_noise).ok_or_else(|| {
        let rule = format!(
            "must be one of {}, not {:?}; the noise on the table is measured while running, so \
             take the law that is nearest",
            DepthNoise::NAMES.join(", "),
            raw.depth_noise
        );
        WrongKey("depth_noise", rule)
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
        InvalidConfig::OutOfRange {
            name,
            value,
            min,
            max,
        } => WrongKey(
            key_of(name),
            format!("must lie between {min} and {max}, not {value}"),
        ),
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

    fn with_rule(rule: &str) -> Result<detection::Config, WrongKey> {
        detection(&RawConfig {
            candidate_rule: rule.into(),
            ..RawConfig::default()
        })
    }

    #[test]
    fn depth_noise_is_a_law_by_name() {
        let of = |name: &str| {
            detection(&RawConfig {
                depth_noise: name.to_owned(),
                ..RawConfig::default()
            })
        };
        assert_eq!(of("stereo").unwrap().get().depth_noise, DepthNoise::STEREO);
        let WrongKey(key, rule) = of("kinect").unwrap_err();
        assert_eq!(key, "depth_noise");
        assert!(rule.contains("kinect-v1, stereo, time-of-flight"), "{rule}");
    }

    #[test]
    fn invalid_restart_limits_are_named() {
        let raw = |max, window| RawConfig {
            actor_restarts_max: max,
            actor_restart_window_s: window,
            ..RawConfig::default()
        };
        assert_eq!(restarts_max(&raw(0, 60.0)), Ok(0));
        assert!(restarts_max(&raw(10_001, 60.0)).is_err());
        assert_eq!(
            restart_window(&raw(5, 1.5)),
            Ok(Duration::from_millis(1500))
        );
        for wrong in [f64::NAN, 0.0, -1.0, f64::INFINITY] {
            let rule = restart_window(&raw(5, wrong)).unwrap_err();
            assert!(rule.contains("between 1 and 86400"), "{rule}");
        }
    }

    #[test]
    fn candidate_rule_is_read_from_the_file() {
        let config = with_rule("table and not image_border").unwrap();
        assert_eq!(config.rule().to_string(), "C_table ∧ ¬C_image_border");
        assert_eq!(
            detection(&RawConfig::default()),
            Ok(detection::Config::default())
        );
    }

    #[test]
    fn invalid_candidate_rules_are_named() {
        for (rule, word) in [
            ("C_table and C_unicorn", "C_unicorn"),
            ("", "empty"),
            (&["table"; 20].join(" and "), "shorter"),
        ] {
            let WrongKey(key, sentence) = with_rule(rule).unwrap_err();
            assert_eq!(key, "candidate_rule");
            assert!(sentence.contains(word), "{sentence}");
        }
    }
}
