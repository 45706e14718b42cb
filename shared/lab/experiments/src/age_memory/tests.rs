//! Ageing tests: what a store holds and reads at its opening is in proportion to its live content,
//! not to the number of changes made.

use super::workload::Workload;
use super::{Ageing, DAY_NS, simulated_clock, store_config};
use perceptual_memory::{HistoryLimits, OpenReport, RetentionLimits, Stats, StoreThread};
use std::sync::Mutex;

/// The simulated clock is one of the process: the tests take turns.
static CLOCK: Mutex<()> = Mutex::new(());

const CATEGORIES: u32 = 5;
const LIMITS: RetentionLimits = RetentionLimits {
    max_views_per_category: 100,
    max_unnamed_views: 1000,
    history: HistoryLimits {
        kept_entries: 2000,
        segment_entries: 500,
        answered_kept_ns: 10 * DAY_NS,
        ..HistoryLimits::CONFIGURED
    },
};

/// State of an aged store that was opened again.
struct Aged {
    report: OpenReport,
    stats: Stats,
    /// Number of records in the database, which an opening may read.
    n_records: u64,
    /// Sequence numbers of the first history entries.
    first_entries: Vec<u64>,
}

fn open(ageing: &Ageing) -> Aged {
    let config = store_config(&ageing.folder, ageing.limits);
    let (thread, handle, report) = StoreThread::start(config).unwrap();
    let read = handle.read_and_wait(|memory| {
        let mut n_records = 0;
        memory.visit_records(|_, _| n_records += 1)?;
        let first_entries = memory.history(1, 10)?;
        let sequences = first_entries.iter().map(|entry| entry.sequence).collect();
        Ok((memory.stats_at(simulated_clock())?, n_records, sequences))
    });
    thread.stop().unwrap();
    let (stats, n_records, first_entries) = read.unwrap();
    Aged {
        report,
        stats,
        n_records,
        first_entries,
    }
}

/// Ages a store and checks after each part that only the archive has grown.
fn check_ageing(changes: &[u64], period_ns: u64, limits: RetentionLimits, categories: u32) {
    let _turn = CLOCK.lock().unwrap();
    let folder = tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir());
    let folder = folder.unwrap();
    let workload = Workload::new(1, categories).unwrap();
    let mut ageing = Ageing::new(folder.path().join("store"), limits, workload);
    ageing.period_ns = period_ns;
    let mut last_archived = 0;
    for &n_changes in changes {
        ageing.age(n_changes, |_| {}).unwrap();
        let Aged {
            report,
            stats,
            n_records,
            first_entries,
        } = open(&ageing);
        assert!(!report.is_damage(), "{report}");
        assert_eq!(first_entries, (1..=10).collect::<Vec<_>>());
        let n_recent = stats.sequence - stats.n_archived_entries;
        let most_recent = limits.history.kept_entries + 3 * limits.history.segment_entries;
        assert!(
            n_recent <= most_recent,
            "{n_recent} entries are in the database"
        );
        // A view has a row, metadata, a descriptor and perhaps a cloud.
        let n_views = stats.n_named + stats.n_unnamed + stats.n_forgotten;
        let n_content = 4 * n_views + stats.n_tombstones;
        // Every hundredth change replaces a document, whose earlier version is kept for a month.
        let n_versions = 40 * DAY_NS / period_ns / 100;
        let n_most = n_content + 2 * n_versions + n_recent + 100;
        assert!(
            n_records <= n_most,
            "{n_records} records, of which {n_most} are live"
        );
        assert!(
            stats.n_archived_entries > last_archived,
            "the archive grows"
        );
        last_archived = stats.n_archived_entries;
    }
}

#[test]
fn aged_memory_is_in_proportion_to_its_live_views() {
    // Almost six years, so that purges and the expiry of idempotency keys take part.
    check_ageing(&[8_000, 32_000], 5_625_000_000_000, LIMITS, CATEGORIES);
}

/// The same time with 400,000 changes.
#[test]
#[ignore = "long"]
fn long_memory_of_400_000_changes_is_in_proportion_to_its_live_views() {
    check_ageing(&[100_000, 400_000], 450_000_000_000, LIMITS, CATEGORIES);
}

/// The same time with a million changes.
#[test]
#[ignore = "long"]
fn long_memory_of_a_million_changes_is_in_proportion_to_its_live_views() {
    check_ageing(&[100_000, 1_000_000], 180_000_000_000, LIMITS, CATEGORIES);
}

/// Ten years of twenty changes a minute with 200,000 live views. It takes some seven hours in a
/// release build on two busy cores, by an extrapolation of a million changes, and 25 GB in the
/// folder for temporary files.
#[test]
#[ignore = "long"]
fn long_memory_of_a_hundred_million_changes_is_in_proportion_to_its_live_views() {
    let limits = RetentionLimits {
        max_views_per_category: 1000,
        max_unnamed_views: 20_000,
        history: HistoryLimits::CONFIGURED,
    };
    let changes: Vec<u64> = (1..=10).map(|year| year * 10_000_000).collect();
    check_ageing(&changes, super::CHANGE_PERIOD_NS, limits, 180);
}
