//! Ageing of a perceptual memory: years of changes through its own write path in simulated time,
//! with opening time, peak memory and disk space at given numbers of changes.
//!
//! The simulated robot makes twenty changes a minute. Its clock is simulated, so that retention
//! limits act as after years; its disk is real, and every group of changes is synced.

mod opening;
mod report;
#[cfg(test)]
mod tests;
mod workload;

use crate::arguments::AgeMemoryArguments;
use crate::output_files::create_folder;
use command_line::{Output, progress_bar};
use opening::Opening;
use perceptual_memory::{
    Error, PerceptualMemory, RetentionLimits, StoreChange, StoreConfig, StoreHandle, StoreThread,
    WRITE_BUFFER_BYTES,
};
use report::{AgeingReport, AgeingRow};
use service::Failure;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;
use workload::{CHANGE_PERIOD_NS, START_NS, Workload};

/// Number of changes requested at once.
const GROUP_CHANGES: u64 = 256;
/// Number of track-ids leased at once.
const LEASE_IDS: u64 = 4096;
/// Simulated day, nanoseconds.
const DAY_NS: u64 = 24 * 3600 * 1_000_000_000;

/// Retention times of forgotten views and of tombstones, as configured by default.
const FORGOTTEN_KEPT_NS: u64 = 30 * DAY_NS;
const TOMBSTONES_KEPT_NS: u64 = 400 * DAY_NS;

/// Simulated clock of the store, nanoseconds since 1970.
static CLOCK_NS: AtomicU64 = AtomicU64::new(START_NS);

fn simulated_clock() -> u64 {
    CLOCK_NS.load(Ordering::Relaxed)
}

/// Ages a new store in the output folder, or measures the opening of an old one.
///
/// # Errors
/// When the store fails, or the output cannot be written.
pub fn run(arguments: &AgeMemoryArguments, output: &Output) -> Result<ExitCode, Failure> {
    if let Some(folder) = &arguments.measure_opening {
        CLOCK_NS.store(arguments.clock_ns, Ordering::Relaxed);
        let opening = opening::measure(folder, arguments.limits())?;
        output.answer(&opening, || format!("opened in {:.3} s", opening.opening_s));
        return Ok(ExitCode::SUCCESS);
    }
    let out = arguments
        .out
        .as_deref()
        .ok_or_else(|| Failure::usage("the output folder is missing: name it with --out DIR"))?;
    create_folder(out)?;
    let folder = arguments.store.clone().unwrap_or_else(|| out.join("store"));
    if folder.join("database").exists() {
        let sentence = format!("{} holds a store already: remove it", folder.display());
        return Err(Failure::usage(sentence));
    }
    let workload = Workload::new(arguments.seed, arguments.categories);
    let workload = workload.map_err(Failure::general)?;
    let mut ageing = Ageing::new(folder, arguments.limits(), workload);
    let mut report = AgeingReport::default();
    let mut changes = arguments.changes.clone();
    changes.sort_unstable();
    let last = changes.last().copied().unwrap_or(0);
    let bar = progress_bar(last, "changes", output);
    for n_changes in changes {
        let row = ageing.row_at(n_changes, &bar)?;
        report.push(row);
        // Written after every row: a long run that is stopped has what it did.
        report.write(out)?;
    }
    bar.finish_and_clear();
    output.answer(&report, || report.text());
    Ok(ExitCode::SUCCESS)
}

/// Store that ages, closed between two measurements.
struct Ageing {
    folder: PathBuf,
    limits: RetentionLimits,
    workload: Workload,
    /// Simulated time between two changes, nanoseconds.
    period_ns: u64,
    n_changes: u64,
    ageing_s: f64,
}

impl Ageing {
    fn new(folder: PathBuf, limits: RetentionLimits, workload: Workload) -> Self {
        Self {
            folder,
            limits,
            workload,
            period_ns: CHANGE_PERIOD_NS,
            n_changes: 0,
            ageing_s: 0.0,
        }
    }

    /// Ages the store to a number of changes and measures its opening in a process of its own.
    fn row_at(
        &mut self,
        n_changes: u64,
        bar: &indicatif::ProgressBar,
    ) -> Result<AgeingRow, Failure> {
        let begun = Instant::now();
        let aged = self.age(n_changes, |n| bar.set_position(n));
        aged.map_err(Failure::general)?;
        self.ageing_s += begun.elapsed().as_secs_f64();
        let opening = Opening::in_own_process(&self.folder, simulated_clock(), &self.limits)?;
        Ok(AgeingRow {
            n_changes,
            simulated_days: (simulated_clock() - START_NS) as f64 / DAY_NS as f64,
            ageing_s: self.ageing_s,
            disk_mb: size_mb(&self.folder)?,
            opening,
        })
    }

    /// Ages the store to a number of changes; `progress` gets the number so far.
    fn age(&mut self, n_changes: u64, progress: impl Fn(u64)) -> Result<(), Error> {
        let (thread, handle, _) = StoreThread::start(store_config(&self.folder, self.limits))?;
        while self.n_changes < n_changes {
            let n = GROUP_CHANGES.min(n_changes - self.n_changes);
            self.change(&handle, n)?;
            self.n_changes += n;
            progress(self.n_changes);
        }
        thread.stop()
    }

    /// Requests a group of changes and waits until it is on disk.
    fn change(&mut self, handle: &StoreHandle, n: u64) -> Result<(), Error> {
        while self.workload.n_leased() < GROUP_CHANGES {
            let first = handle.lease_track_ids_and_wait(LEASE_IDS)?;
            self.workload.lease(first, LEASE_IDS);
        }
        for _ in 0..n {
            let wall_ns = CLOCK_NS.fetch_add(self.period_ns, Ordering::Relaxed);
            // A refusal is an answer, too: a track may have been pruned meanwhile.
            handle.mutate(self.workload.next(wall_ns), |_| {});
        }
        if self.workload.is_purge_due(simulated_clock()) {
            self.purge(handle)?;
            // The store of a robot does this when it is idle, which this one never is.
            for step in 0..PerceptualMemory::N_RECORD_STEPS {
                handle.compact_and_wait(step)?;
            }
        }
        // A read waits for all changes requested before it.
        handle.read_and_wait(|_| Ok(()))
    }

    /// Purges all that is due, a part at a time.
    fn purge(&mut self, handle: &StoreHandle) -> Result<(), Error> {
        let now_ns = simulated_clock();
        let before_ns = now_ns.saturating_sub(FORGOTTEN_KEPT_NS);
        while handle.read_and_wait(move |memory| Ok(memory.has_purgeable(before_ns)))? {
            let purge = StoreChange::Purge { before_ns };
            handle.mutate_and_wait(self.workload.upkeep(now_ns, purge))?;
        }
        let before_ns = now_ns.saturating_sub(TOMBSTONES_KEPT_NS);
        while handle.read_and_wait(move |memory| Ok(memory.has_purgeable_tombstones(before_ns)))? {
            let purge = StoreChange::PurgeTombstones { before_ns };
            handle.mutate_and_wait(self.workload.upkeep(now_ns, purge))?;
        }
        Ok(())
    }
}

/// Configuration of a store with the simulated clock.
fn store_config(folder: &Path, limits: RetentionLimits) -> StoreConfig {
    StoreConfig {
        folder: folder.to_owned(),
        queue_capacity: 2 * GROUP_CHANGES as usize,
        limits,
        write_buffer_bytes: WRITE_BUFFER_BYTES,
        wall_clock: simulated_clock,
        on_reopened: Box::new(|_| {}),
        on_notice: Box::new(|_| {}),
    }
}

/// Total size of the files in a folder and its subfolders, megabytes.
fn size_mb(folder: &Path) -> Result<f64, Failure> {
    let mut n_bytes = 0;
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).map_err(Failure::general)? {
            let entry = entry.map_err(Failure::general)?;
            let metadata = entry.metadata().map_err(Failure::general)?;
            if metadata.is_dir() {
                folders.push(entry.path());
            } else {
                n_bytes += metadata.len();
            }
        }
    }
    Ok(n_bytes as f64 / 1e6)
}
