//! Configuration section `[memory]`: parsing and validation.

use memory_requests::UploadLimits;
use perceptual_memory::{HistoryLimits, RetentionLimits, WRITE_BUFFER_BYTES};
use serde::Deserialize;
use service::{BrokenRule, Configuration, Failure, check_rules};
use std::time::Duration;
use working_memory::WorldConfig;

/// Resolution on disk of the time at which an object was last seen, nanoseconds. Chosen.
const SEEN_PERIOD_NS: u64 = 10_000_000_000;

/// Nanoseconds of a day.
const NS_PER_DAY: u64 = 24 * 3600 * 1_000_000_000;

/// Section `[memory]` as written in TOML.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct RawConfig {
    queue_requests: usize,
    max_views_per_category: usize,
    max_unnamed_views: usize,
    write_buffer_mb: usize,
    forgotten_kept_days: u64,
    import_max_mb: u64,
    free_disk_min_mb: u64,
    tombstones_kept_days: u64,
    history_recent_entries: u64,
    history_archive_max_mb: u64,
    request_ids_kept_days: u64,
    world_period_ms: u64,
    world_move_min_m: f64,
    world_turn_min_deg: f64,
    world_keep_hours: f64,
    world_kept_max: usize,
}

impl Default for RawConfig {
    fn default() -> Self {
        Self {
            queue_requests: 1024,
            max_views_per_category: 1000,
            max_unnamed_views: 20_000,
            write_buffer_mb: WRITE_BUFFER_BYTES >> 20,
            forgotten_kept_days: 30,
            import_max_mb: 4096,
            free_disk_min_mb: 256,
            tombstones_kept_days: 400,
            history_recent_entries: HistoryLimits::CONFIGURED.kept_entries,
            history_archive_max_mb: HistoryLimits::CONFIGURED.archive_max_bytes >> 20,
            request_ids_kept_days: HistoryLimits::CONFIGURED.answered_kept_ns / NS_PER_DAY,
            world_period_ms: 250,
            world_move_min_m: 0.02,
            world_turn_min_deg: 30.0,
            world_keep_hours: 168.0,
            world_kept_max: 50_000,
        }
    }
}

/// Validated configuration of the memory.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Config {
    /// Capacity of the store's request queue; further requests are refused.
    pub(crate) queue_requests: usize,
    /// Retention limits of the perceptual memory.
    pub(crate) limits: RetentionLimits,
    /// Write buffer of the perceptual memory, bytes; when full, the database makes a
    /// table of it.
    pub(crate) write_buffer_bytes: usize,
    /// Retention time of forgotten views, during which they can be restored.
    pub(crate) forgotten_kept: Duration,
    /// Limits of the files of imports.
    pub(crate) uploads: UploadLimits,
    /// Retention time of the tombstones of purged views, during which no merge restores them.
    pub(crate) tombstones_kept: Duration,
    /// Period of updates of the world model, and of its writes to disk.
    pub(crate) world_period: Duration,
    /// Retention limits of the working memory.
    pub(crate) world: WorldConfig,
}

impl Config {
    /// Reads and validates the section of the configuration.
    pub(crate) fn new(found: &Configuration) -> Result<Self, Failure> {
        let raw: RawConfig = found.section("memory")?;
        raw.check()
            .map_err(|broken| found.wrong("memory", &[broken.key], broken))?;
        Ok(Self {
            queue_requests: raw.queue_requests,
            limits: RetentionLimits {
                max_views_per_category: raw.max_views_per_category,
                max_unnamed_views: raw.max_unnamed_views,
                history: HistoryLimits {
                    kept_entries: raw.history_recent_entries,
                    segment_entries: HistoryLimits::SEGMENT_ENTRIES,
                    archive_max_bytes: raw.history_archive_max_mb << 20,
                    answered_kept_ns: raw.request_ids_kept_days * NS_PER_DAY,
                },
            },
            write_buffer_bytes: raw.write_buffer_mb << 20,
            uploads: UploadLimits {
                max_bytes: raw.import_max_mb << 20,
                free_disk_min_bytes: raw.free_disk_min_mb << 20,
            },
            forgotten_kept: Duration::from_nanos(raw.forgotten_kept_days * NS_PER_DAY),
            tombstones_kept: Duration::from_nanos(raw.tombstones_kept_days * NS_PER_DAY),
            world_period: Duration::from_millis(raw.world_period_ms),
            world: WorldConfig {
                move_min_m: raw.world_move_min_m,
                turn_min_rad: raw.world_turn_min_deg.to_radians(),
                keep_ns: (raw.world_keep_hours * 3.6e12) as u64,
                n_kept_most: raw.world_kept_max,
                seen_period_ns: SEEN_PERIOD_NS,
                write_buffer_bytes: raw.write_buffer_mb << 20,
            },
        })
    }
}

impl RawConfig {
    /// First violated rule, if any. NaN violates every range.
    fn check(&self) -> Result<(), BrokenRule> {
        self.check_perceptual_memory()?;
        self.check_working_memory()
    }

    fn check_perceptual_memory(&self) -> Result<(), BrokenRule> {
        check_rules([
            (
                (1..=1_000_000).contains(&self.queue_requests),
                "queue_requests",
                "must lie between 1 and 1000000",
            ),
            (
                (10..=10_000).contains(&self.max_views_per_category),
                "max_views_per_category",
                "must lie between 10 and 10000",
            ),
            (
                (100..=1_000_000).contains(&self.max_unnamed_views),
                "max_unnamed_views",
                "must lie between 100 and 1000000",
            ),
            (
                (1..=256).contains(&self.write_buffer_mb),
                "write_buffer_mb",
                "must lie between 1 and 256",
            ),
            (
                self.forgotten_kept_days <= 36_500,
                "forgotten_kept_days",
                "must lie between 0 and 36500",
            ),
            (
                (1..=1_000_000).contains(&self.import_max_mb),
                "import_max_mb",
                "must lie between 1 and 1000000",
            ),
            (
                self.free_disk_min_mb <= 1_000_000,
                "free_disk_min_mb",
                "must lie between 0 and 1000000",
            ),
            (
                (400..=36_500).contains(&self.tombstones_kept_days),
                "tombstones_kept_days",
                "must lie between 400 and 36500",
            ),
            (
                (1000..=1_000_000).contains(&self.history_recent_entries),
                "history_recent_entries",
                "must lie between 1000 and 1000000",
            ),
            (
                (16..=16_777_216).contains(&self.history_archive_max_mb),
                "history_archive_max_mb",
                "must lie between 16 and 16777216",
            ),
            (
                (1..=36_500).contains(&self.request_ids_kept_days),
                "request_ids_kept_days",
                "must lie between 1 and 36500",
            ),
        ])
    }

    fn check_working_memory(&self) -> Result<(), BrokenRule> {
        check_rules([
            (
                (50..=60_000).contains(&self.world_period_ms),
                "world_period_ms",
                "must lie between 50 and 60000",
            ),
            (
                (0.001..=1.0).contains(&self.world_move_min_m),
                "world_move_min_m",
                "must lie between 0.001 and 1",
            ),
            (
                (1.0..=180.0).contains(&self.world_turn_min_deg),
                "world_turn_min_deg",
                "must lie between 1 and 180",
            ),
            (
                (0.001..=87_600.0).contains(&self.world_keep_hours),
                "world_keep_hours",
                "must lie between 0.001 and 87600",
            ),
            (
                (100..=1_000_000).contains(&self.world_kept_max),
                "world_kept_max",
                "must lie between 100 and 1000000",
            ),
        ])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn section_agrees_with_the_key_reference() {
        service::check_section_reference("memory", Config::new).unwrap();
    }

    #[test]
    fn numbers_out_of_range_and_nan_violate_a_rule() {
        assert_eq!(RawConfig::default().check(), Ok(()));
        let violates = |change: &dyn Fn(&mut RawConfig)| {
            let mut raw = RawConfig::default();
            change(&mut raw);
            raw.check().is_err()
        };
        assert!(violates(&|raw| raw.queue_requests = 0));
        assert!(violates(&|raw| raw.max_views_per_category = 9));
        assert!(violates(&|raw| raw.max_unnamed_views = 99));
        assert!(violates(&|raw| raw.write_buffer_mb = 0));
        assert!(violates(&|raw| raw.forgotten_kept_days = 36_501));
        assert!(violates(&|raw| raw.import_max_mb = 0));
        assert!(violates(&|raw| raw.free_disk_min_mb = 1_000_001));
        assert!(violates(&|raw| raw.tombstones_kept_days = 399));
        assert!(violates(&|raw| raw.history_recent_entries = 999));
        assert!(violates(&|raw| raw.history_archive_max_mb = 15));
        assert!(violates(&|raw| raw.request_ids_kept_days = 0));
        assert!(violates(&|raw| raw.world_period_ms = 49));
        assert!(violates(&|raw| raw.world_move_min_m = f64::NAN));
        assert!(violates(&|raw| raw.world_turn_min_deg = 0.0));
        assert!(violates(&|raw| raw.world_keep_hours = f64::NAN));
        assert!(violates(&|raw| raw.world_kept_max = 0));
    }
}
