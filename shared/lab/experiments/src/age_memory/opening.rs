//! Measurement of the opening of a store in a process of its own, so that its peak memory is that
//! of the opening alone.

use super::store_config;
use perceptual_memory::{RetentionLimits, StoreThread};
use serde::{Deserialize, Serialize};
use service::Failure;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

/// Cost and result of opening a store.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Opening {
    /// Wall time of the opening, seconds; the files are in the page cache.
    pub(super) opening_s: f64,
    /// Peak resident memory of the process, megabytes.
    pub(super) peak_rss_mb: f64,
    /// Number of stored views, without forgotten ones.
    pub(super) n_views: u64,
    /// Sequence number of the last history entry.
    pub(super) n_history: u64,
    /// Number of tombstones of purged views.
    pub(super) n_tombstones: u64,
}

impl Opening {
    /// Opens a store in a process of its own, closes it, and returns what it cost.
    pub(super) fn in_own_process(
        folder: &Path,
        clock_ns: u64,
        limits: &RetentionLimits,
    ) -> Result<Self, Failure> {
        let program = std::env::current_exe().map_err(Failure::general)?;
        let printed = Command::new(program)
            .args(["age-memory", "--json", "--clock-ns"])
            .arg(clock_ns.to_string())
            .arg("--views-per-category")
            .arg(limits.max_views_per_category.to_string())
            .arg("--unnamed-views")
            .arg(limits.max_unnamed_views.to_string())
            .arg("--measure-opening")
            .arg(folder)
            .output()
            .map_err(Failure::general)?;
        serde_json::from_slice(&printed.stdout).map_err(|_| {
            let error = String::from_utf8_lossy(&printed.stderr);
            Failure::general(format!("the opening could not be measured: {error}"))
        })
    }
}

/// Opens a store in this process and closes it.
pub(super) fn measure(folder: &Path, limits: RetentionLimits) -> Result<Opening, Failure> {
    let begun = Instant::now();
    let opened = StoreThread::start(store_config(folder, limits));
    let (thread, handle, report) = opened.map_err(Failure::general)?;
    let opening_s = begun.elapsed().as_secs_f64();
    let peak_rss_mb = peak_rss_mb()?;
    if report.is_damage() {
        return Err(Failure::general(report));
    }
    let stats = handle.read_and_wait(|memory| memory.stats());
    let opening = Opening {
        opening_s,
        peak_rss_mb,
        n_views: report.n_views,
        n_history: report.n_history,
        n_tombstones: stats.map_err(Failure::general)?.n_tombstones,
    };
    thread.stop().map_err(Failure::general)?;
    Ok(opening)
}

/// Peak resident memory of this process, megabytes, by the kernel's account.
fn peak_rss_mb() -> Result<f64, Failure> {
    let status = std::fs::read_to_string("/proc/self/status").map_err(Failure::general)?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kb = line.and_then(|line| line.trim().strip_suffix(" kB")?.parse::<f64>().ok());
    kb.map(|kb| kb / 1e3)
        .ok_or_else(|| Failure::general("/proc/self/status has no line VmHWM"))
}
