//! Configuration section `[memory]`: parsing and validation.

use memory_requests::UploadLimits;
use perceptual_memory::{HistoryLimits, RetentionLimits};
use serde::Deserialize;
use service::{Configuration, Failure};
use std::time::Duration;
use working_memory::WorldConfig;

/// Resolution on disk of the time at which an object was last seen, nanoseconds. Chosen.
const SEEN_PERIOD_NS: u64 = 10_000_000_000;

/// Nanoseconds of a day.
const NS_PER_DAY: u64 = 24 * 3600 * 1_000_000_000;

/// Section `[memory]` as written in TOML.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
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
        let raw: RawConfig = found.section_with_defaults("memory")?;
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

#[cfg(test)]
mod tests {
    use super::*;
    use perceptual_memory::WRITE_BUFFER_BYTES;

    #[test]
    fn section_agrees_with_the_key_reference() {
        service::check_section_reference("memory", Config::new).unwrap();
    }

    #[test]
    fn defaults_are_those_of_the_stores() {
        let config = Config::new(&Configuration::default()).unwrap();
        assert_eq!(config.limits.history, HistoryLimits::CONFIGURED);
        assert_eq!(config.write_buffer_bytes, WRITE_BUFFER_BYTES);
    }

    #[test]
    fn numbers_out_of_range_and_nan_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        for setting in [
            "queue_requests = 0",
            "max_views_per_category = 9",
            "max_unnamed_views = 99",
            "write_buffer_mb = 0",
            "forgotten_kept_days = 36501",
            "import_max_mb = 0",
            "free_disk_min_mb = 1000001",
            "tombstones_kept_days = 399",
            "history_recent_entries = 999",
            "history_archive_max_mb = 15",
            "request_ids_kept_days = 0",
            "world_period_ms = 49",
            "world_move_min_m = nan",
            "world_turn_min_deg = 0.0",
            "world_keep_hours = nan",
            "world_kept_max = 0",
        ] {
            let file = folder.path().join("tabula.toml");
            std::fs::write(&file, format!("[memory]\n{setting}\n")).unwrap();
            let sentence = Configuration::find(Some(&file), folder.path())
                .unwrap_err()
                .to_string();
            let (key, value) = setting.split_once(" = ").unwrap();
            for word in [key, value, "line 2", "must lie between"] {
                assert!(sentence.contains(word), "{word}: {sentence}");
            }
        }
    }
}
