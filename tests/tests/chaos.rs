//! Chaos test: faults drawn at random in a running daemon. Nothing acknowledged is lost, every
//! fault is recovered from, a starved process is never ended, and nothing grows.

mod document_writer;
mod fake_clock;
mod fault;
mod picture;
mod scene_watch;

use crate::daemon::{Daemon, Sandbox, WATCHDOG, eventually, with_mounts};
use crate::skeleton::{id, wait_for_all};
use document_writer::DocumentWriter;
use fault::Fault;
use random::Random;
use scene_watch::SceneWatch;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

/// The synthetic table at a low rate, since several daemons share the cores.
const TABLE: [&str; 4] = ["--source", "synthetic:0", "--rate", "15"];
/// The memory is found as fast as the others, which are found in the default time.
/// With a small write buffer the memory has tables soon.
const CONFIGURATION: &str = "[run]\nmemory_watchdog_s = 4.0\nrestart_delay_max_s = 0.5\n\
                             [memory]\nwrite_buffer_mb = 1\n";
/// Size of the daemon's disk, MB: room for two damaged copies beside the store.
const DISK_MB: u32 = 512;
/// Objects that are taught.
const N_TAUGHT: usize = 2;
/// Good scenes that end a fault.
const N_GOOD: u64 = 15;
/// Duration of the long test: an hour, or what `TABULA_CHAOS_S` says, seconds. With
/// `TABULA_CHAOS_ONLY` only faults with that text in their names are drawn.
const LONG: Duration = Duration::from_secs(3600);

/// Recovery from one fault.
#[derive(Debug, Clone, Copy)]
struct Recovery {
    /// Time until the fault was found, of a stopped process.
    found_after: Option<Duration>,
    /// Longest time without a good scene.
    without_scene: Duration,
    /// Time until a request is acknowledged after the fault is over.
    until_acknowledged: Duration,
}

/// Daemon under chaos.
struct Chaos<'a> {
    daemon: Daemon<'a>,
    scenes: SceneWatch,
    writer: DocumentWriter,
}

impl<'a> Chaos<'a> {
    fn start(sandbox: &'a Sandbox) -> Self {
        let daemon = sandbox.start(&TABLE);
        let objects = wait_for_all(&daemon, 0);
        for object in &objects[..N_TAUGHT] {
            let track = id(object);
            daemon.ask(&["teach", &track, &format!("thing {track}")]);
        }
        let scenes = SceneWatch::start(sandbox, N_TAUGHT);
        let chaos = Self {
            daemon,
            scenes,
            writer: DocumentWriter::start(sandbox),
        };
        chaos.wait_for_good();
        chaos
    }

    fn wait_for_good(&self) {
        let good = self.scenes.wait_for_good(N_GOOD, WATCHDOG);
        good.unwrap_or_else(|| panic!("no good scene comes\n{}", self.end_of_log()));
    }

    /// Last lines of the daemon's log.
    fn end_of_log(&self) -> String {
        const N_LINES: usize = 80;
        let log = self.daemon.log();
        let lines: Vec<&str> = log.lines().collect();
        lines[lines.len().saturating_sub(N_LINES)..].join("\n")
    }

    fn inject(&self, fault: Fault) -> Recovery {
        self.scenes.begin();
        let found_after = fault.inject(&self.daemon);
        let until_acknowledged = self.writer.time_to_acknowledgement(WATCHDOG);
        let until_acknowledged = until_acknowledged.unwrap_or_else(|| {
            panic!(
                "after {} the memory does not answer\n{}",
                fault.name(),
                self.end_of_log()
            )
        });
        self.wait_for_good();
        let without_scene = self.scenes.longest_pause();
        eventually("all processes work", || {
            let status = self.daemon.sandbox.tabula(&["status", "--json"]);
            status.status.success()
        });
        Recovery {
            found_after,
            without_scene,
            until_acknowledged,
        }
    }

    /// Stops the daemon and checks that nothing was lost.
    fn stop(self) {
        let n_acknowledged = self.writer.n_acknowledged();
        let lost = self.writer.stop();
        assert!(lost.is_empty(), "acknowledged and lost: {lost:?}");
        let verified = self.daemon.ask(&["memory", "verify"]);
        assert_eq!(verified["n_findings"], 0, "{verified}");
        drop(self.scenes);
        self.daemon.stop();
        eprintln!("{n_acknowledged} documents were acknowledged, none is lost");
    }
}

/// Sandbox, and the faults that can be injected into it.
fn sandbox() -> (Sandbox, Vec<Fault>) {
    let mut faults = Fault::FOR_ALL.to_vec();
    let sandbox = fake_clock::sandbox().map_or_else(
        || {
            eprintln!("SKIPPED: jumps of the clock, which need libfaketime");
            Sandbox::new()
        },
        |sandbox| {
            faults.push(Fault::ClockJumps);
            sandbox
        },
    );
    let sandbox = if has_own_shared_memory() {
        faults.extend(Fault::FOR_ROOT);
        sandbox.with_own_disk(DISK_MB, CONFIGURATION)
    } else {
        eprintln!("SKIPPED: faults of disk and shared memory, which need root");
        sandbox.configure(CONFIGURATION);
        sandbox
    };
    if fault::can_strace() {
        faults.extend(Fault::BY_STRACE);
    } else {
        eprintln!("SKIPPED: errors of the medium, which need strace and may not trace");
    }
    (sandbox, faults)
}

/// Variable that is set in a test process with shared memory of its own.
const OWN_SHARED_MEMORY: &str = "TABULA_CHAOS_OWN_SHARED_MEMORY";

fn has_own_shared_memory() -> bool {
    std::env::var_os(OWN_SHARED_MEMORY).is_some()
}

/// Runs a test again, as root in a process of its own with shared memory of its own, which can be
/// filled without harm to others; elsewhere here. `body` is the test.
fn with_own_shared_memory(test: &str, body: fn()) {
    if has_own_shared_memory() || !rustix::process::geteuid().is_root() {
        return body();
    }
    let mut again = Command::new(std::env::current_exe().unwrap());
    again
        .args([test, "--exact", "--include-ignored", "--nocapture"])
        .env(OWN_SHARED_MEMORY, "1");
    let mounts = "mount -t tmpfs -o size=700m tmpfs /dev/shm";
    let status = with_mounts(&again, mounts).status().unwrap();
    assert!(status.success(), "{test} failed");
}

#[test]
fn chaos_of_a_minute_is_recovered_from_and_loses_nothing() {
    with_own_shared_memory(
        "chaos::chaos_of_a_minute_is_recovered_from_and_loses_nothing",
        chaos_of_a_minute,
    );
}

/// Each fault once, in an order of their own, and one starved process.
fn chaos_of_a_minute() {
    let (sandbox, mut faults) = sandbox();
    let mut random = Random::from_seed(23);
    random.shuffle(&mut faults);
    faults.push(Fault::STARVATION[random.below(Fault::STARVATION.len())]);
    let chaos = Chaos::start(&sandbox);
    for fault in faults {
        let recovery = chaos.inject(fault);
        eprintln!("{}: {recovery:?}", fault.name());
    }
    chaos.stop();
}

#[test]
#[ignore = "long"]
fn long_chaos_of_an_hour_is_recovered_from_and_loses_nothing() {
    with_own_shared_memory(
        "chaos::long_chaos_of_an_hour_is_recovered_from_and_loses_nothing",
        chaos_of_an_hour,
    );
}

/// Faults at random.
fn chaos_of_an_hour() {
    let seconds = std::env::var("TABULA_CHAOS_S").ok();
    let duration = seconds.map_or(LONG, |s| Duration::from_secs(s.parse().unwrap()));
    let seed = std::env::var("TABULA_CHAOS_SEED").map_or(1, |seed| seed.parse().unwrap());
    let (sandbox, mut faults) = sandbox();
    faults.extend(Fault::STARVATION);
    if let Ok(only) = std::env::var("TABULA_CHAOS_ONLY") {
        faults.retain(|fault| fault.name().contains(&only));
    }
    let chaos = Chaos::start(&sandbox);
    let before = Holdings::of(&chaos.daemon);
    let (mut random, begin) = (Random::from_seed(seed), Instant::now());
    let mut recoveries: BTreeMap<String, Vec<Recovery>> = BTreeMap::new();
    while begin.elapsed() < duration {
        let fault = *random.choice(&faults).unwrap();
        let recovery = chaos.inject(fault);
        println!(
            "chaos {:.1} s, {}: found {:.2} s, scene {:.2} s, acknowledged {:.2} s",
            begin.elapsed().as_secs_f64(),
            fault.name(),
            recovery.found_after.unwrap_or_default().as_secs_f64(),
            recovery.without_scene.as_secs_f64(),
            recovery.until_acknowledged.as_secs_f64()
        );
        recoveries.entry(fault.name()).or_default().push(recovery);
    }
    print_table(&recoveries);
    if let Some(folder) = std::env::var_os("TABULA_CHAOS_OUT") {
        picture::write(Path::new(&folder), &recoveries);
    }
    let after = Holdings::of(&chaos.daemon);
    assert!(after.is_no_growth_since(&before), "{before:?} -> {after:?}");
    chaos.stop();
}

/// Files that a daemon holds.
#[derive(Debug, Clone, Copy)]
struct Holdings {
    /// Files of its domain in shared memory.
    n_shared: usize,
    /// Descriptors of `tabula run`, which lives through all faults.
    n_descriptors: usize,
}

impl Holdings {
    fn of(daemon: &Daemon<'_>) -> Self {
        let descriptors = std::fs::read_dir(format!("/proc/{}/fd", daemon.parent_id()));
        Self {
            n_shared: daemon.sandbox.shared_memory_files().len(),
            n_descriptors: descriptors.unwrap().count(),
        }
    }

    /// Connections with processes that have just ended remain for a while: a constant number,
    /// however many faults there were.
    fn is_no_growth_since(&self, before: &Self) -> bool {
        const CONNECTIONS: usize = 16;
        self.n_shared <= before.n_shared + CONNECTIONS
            && self.n_descriptors <= before.n_descriptors + CONNECTIONS
    }
}

/// Prints a line for each fault: median, 99th percentile and maximum of the recoveries.
fn print_table(recoveries: &BTreeMap<String, Vec<Recovery>>) {
    println!("| fault | n | found p50/max | without scene p50/p99/max | acknowledged p50/max |");
    println!("|---|---|---|---|---|");
    for (fault, all) in recoveries {
        let sorted = |get: &dyn Fn(&Recovery) -> Duration| {
            let mut times: Vec<f64> = all.iter().map(|r| get(r).as_secs_f64()).collect();
            times.sort_by(f64::total_cmp);
            move |share: f64| times[((times.len() - 1) as f64 * share).ceil() as usize]
        };
        let found = sorted(&|r| r.found_after.unwrap_or_default());
        let scene = sorted(&|r| r.without_scene);
        let acknowledged = sorted(&|r| r.until_acknowledged);
        println!(
            "| {fault} | {} | {:.2}/{:.2} s | {:.2}/{:.2}/{:.2} s | {:.2}/{:.2} s |",
            all.len(),
            found(0.5),
            found(1.0),
            scene(0.5),
            scene(0.99),
            scene(1.0),
            acknowledged(0.5),
            acknowledged(1.0)
        );
    }
}
