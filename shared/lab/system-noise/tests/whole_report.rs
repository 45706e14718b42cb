//! End-to-end test of the system-noise measurement.
#![expect(clippy::unwrap_used, reason = "helpers of tests panic as tests do")]

use std::collections::BTreeSet;
use system_noise::{MachineReport, MeasurementPlan, latency_histograms, measure, report};

const BRIEF: MeasurementPlan = MeasurementPlan {
    n_timers: 30,
    spinning_s: 1,
    n_rounds: 1,
};

/// Running programs with the names of the measuring ones.
fn running() -> BTreeSet<u32> {
    let processes = std::fs::read_dir("/proc").unwrap().flatten();
    let pids = processes.filter_map(|entry| entry.file_name().to_str()?.parse().ok());
    let is_measuring = |pid: &u32| {
        let name = std::fs::read_to_string(format!("/proc/{pid}/comm")).unwrap_or_default();
        ["cyclictest", "oslat", "stress-ng"]
            .iter()
            .any(|program| name.starts_with(program))
    };
    pids.filter(is_measuring).collect()
}

fn measured() -> MachineReport {
    let before = running();
    let mut sentences = Vec::new();
    let found = measure(&BRIEF, &mut |sentence| sentences.push(sentence.to_owned()));
    assert!(running().is_subset(&before), "a program still runs");
    assert!(sentences.len() >= 6 && sentences.iter().all(|s| s.ends_with('.')));
    let parts = found.timers.len()
        + usize::from(found.interruptions.is_some())
        + found.bandwidths.len()
        + found.not_measured.len();
    let n_bandwidths = match found.fingerprint.usable_cores.as_deref() {
        Some([_]) | None => 1,
        Some(_) => 2,
    };
    assert_eq!(parts, 8 + 1 + n_bandwidths, "{:?}", found.not_measured);
    found
}

#[test]
fn report_survives_a_round_trip_and_is_shown() {
    let found = measured();
    let json = serde_json::to_string(&found).unwrap();
    let back: MachineReport = serde_json::from_str(&json).unwrap();
    assert_eq!(&back.fingerprint, &found.fingerprint);
    assert_eq!(&back.timers, &found.timers);
    let text = report::text(&back);
    assert!(text.contains("Environment") && text.contains("Meanwhile"));
    for one in &found.not_measured {
        assert!(text.contains(&one.why), "{} is not in\n{text}", one.why);
    }
    let svg = latency_histograms::histograms(&back).unwrap();
    assert!(svg.contains("Timer, idle machine"));
}

#[test]
#[ignore = "needs rt-tests and stress-ng"]
fn as_root_report_measures_every_part() {
    let found = measured();
    assert_eq!(found.not_measured, []);
    assert!(
        found
            .timers
            .iter()
            .all(|trial| trial.n == 30 && trial.max_us > 0)
    );
    let interruptions = found.interruptions.as_ref().unwrap();
    assert!(interruptions.watched_s > 0.5 && interruptions.share < 1.0);
    for one in &found.bandwidths {
        assert!(
            one.read_gb_per_s > 0.1 && one.write_gb_per_s > 0.1,
            "{one:?}"
        );
    }
    let text = report::text(&found);
    for part in ["SCHED_FIFO 80", "busy", "Interruptions", "Memory"] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
}
