//! End-to-end test of the system-noise measurement: every probe ends, every setting is reverted.
#![expect(clippy::unwrap_used, reason = "helpers of tests panic as tests do")]

use parking_lot::Mutex;
use std::collections::BTreeSet;
use std::sync::mpsc;
use std::time::Duration;
use system_noise::probe::transport::{Payload, ReceiveMode, transport_latency};
use system_noise::{MachineReport, MeasurementPlan, latency_histograms, measure, report};

/// Serialises the tests, which check the state of the whole process.
static SERIALISED: Mutex<()> = Mutex::new(());

const BRIEF: MeasurementPlan = MeasurementPlan {
    probe: Duration::from_millis(50),
    clock: Duration::from_millis(5),
    transport: Duration::from_millis(100),
    trial: Duration::from_millis(30),
    n_rounds: 2,
    buffer_bytes: Some(4 << 20),
};

fn watched<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> T {
    let (sender, receiver) = mpsc::channel();
    std::thread::spawn(move || sender.send(work()));
    let done = receiver.recv_timeout(Duration::from_secs(60));
    done.expect("the measurement failed or hangs")
}

/// Files of private domains of this process, in shared memory and in its run folders.
fn leftovers() -> Vec<String> {
    let mark = format!("m{}-", std::process::id());
    let folders = ["/dev/shm".into()]
        .into_iter()
        .chain([channel::RunFolder::of_user().path().to_owned()]);
    let entries = folders.filter_map(|folder| std::fs::read_dir(folder).ok());
    entries
        .flatten()
        .flatten()
        .filter_map(|entry| entry.file_name().into_string().ok())
        .filter(|name| name.contains(&mark))
        .collect()
}

/// Policy and affinity of every thread of this process, and its locked memory.
fn settings() -> (BTreeSet<(String, String)>, String) {
    let tasks = std::fs::read_dir("/proc/self/task").unwrap().flatten();
    let of_task = |task: std::fs::DirEntry| {
        let stat = std::fs::read_to_string(task.path().join("stat")).ok()?;
        let (_, fields) = stat.rsplit_once(')')?;
        let policy = fields.split_whitespace().nth(41 - 3)?.to_owned();
        let status = std::fs::read_to_string(task.path().join("status")).ok()?;
        Some((policy, value(&status, "Cpus_allowed_list:")))
    };
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    (
        tasks.filter_map(of_task).collect(),
        value(&status, "VmLck:"),
    )
}

fn value(status: &str, key: &str) -> String {
    let mut lines = status.lines();
    let line = lines.find_map(|line| line.strip_prefix(key)).unwrap();
    line.trim().to_owned()
}

#[test]
fn report_measures_every_probe_and_reverts_every_setting() {
    let _turn = SERIALISED.lock();
    let before = settings();
    let (found, sentences) = watched(|| {
        let mut sentences = Vec::new();
        let found = measure(&BRIEF, &mut |sentence| sentences.push(sentence.to_owned()));
        (found, sentences)
    });
    assert_eq!(settings(), before);
    assert_eq!(leftovers(), Vec::<String>::new());
    assert!(sentences.len() > 10 && sentences.iter().all(|s| s.ends_with('.')));

    let names: Vec<&str> = found.latencies.iter().map(|s| s.name.as_str()).collect();
    let missing = found.not_measured.iter().map(|one| one.name.as_str());
    assert_eq!(names.len() + missing.count(), 6, "{:?}", found.not_measured);
    for samples in &found.latencies {
        assert!(samples.summary.is_some(), "{} has no samples", samples.name);
    }
    assert_eq!(found.clocks.len(), 3);
    assert!(found.clocks.iter().all(|clock| clock.reading_ns > 0.0));
    assert!(found.interruptions.watched_ns >= BRIEF.probe.as_nanos() as u64);
    assert!((0.0..=1.0).contains(&found.interruptions.share));
    assert!(found.bandwidths.iter().all(|one| one.best_gb_per_s > 0.0));
    is_shown(&found);
}

fn is_shown(found: &MachineReport) {
    let json = serde_json::to_string(found).unwrap();
    let back: MachineReport = serde_json::from_str(&json).unwrap();
    assert_eq!(&back.fingerprint, &found.fingerprint);
    assert_eq!(&back.trials, &found.trials);
    let text = report::text(&back);
    for part in ["Environment", "Latencies", "timer", "Memory", "Advice"] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
    let svg = latency_histograms::histograms(&back).unwrap();
    assert!(svg.contains("Wake-up, idle machine") && svg.contains("interruptions"));
}

#[test]
fn transport_probe_removes_the_domain_of_a_killed_probe() {
    let _turn = SERIALISED.lock();
    let folder = channel::RunFolder::of_user();
    let name: channel::DomainName = "m4294967295-0".parse().unwrap();
    let abandoned = folder.domain_folder(&name);
    std::fs::create_dir_all(&abandoned).unwrap();
    std::fs::write(abandoned.join("domain.lock"), "").unwrap();
    let measured = watched(|| {
        transport_latency(
            Payload::Small,
            ReceiveMode::Blocking,
            Duration::from_millis(50),
        )
    });
    assert!(measured.unwrap().summary.is_some());
    assert!(!abandoned.exists());
}
