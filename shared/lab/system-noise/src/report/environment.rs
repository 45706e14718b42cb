//! Text of environment and disturbance.

use crate::disturbance::Disturbance;
use crate::fingerprint::{BuildProfile, Fingerprint};
use crate::privilege::ResourceLimit;
use std::fmt::Display;

const NOT_REPORTED: &str = "not told";

fn reported<T: Display>(value: Option<T>) -> String {
    value.map_or_else(|| NOT_REPORTED.to_owned(), |value| value.to_string())
}

fn lines(pairs: &[(&str, String)]) -> String {
    let width = pairs.iter().map(|(name, _)| name.chars().count()).max();
    let width = width.unwrap_or(0);
    let lines = pairs
        .iter()
        .map(|(name, value)| format!("{name:<width$}  {value}\n"));
    lines.collect()
}

/// Environment section as text, one line per reported value.
pub(super) fn of_fingerprint(print: &Fingerprint) -> String {
    let mut pairs = program(print);
    pairs.extend(processor(print));
    pairs.extend(kernel(print));
    pairs.extend(rights(print));
    lines(&pairs)
}

fn program(print: &Fingerprint) -> Vec<(&'static str, String)> {
    let profile = match print.build_profile {
        BuildProfile::Release => "release",
        BuildProfile::Debug => "debug",
    };
    vec![(
        "tabula",
        format!("{}, {profile} build", print.tabula_version),
    )]
}

fn processor(print: &Fingerprint) -> Vec<(&'static str, String)> {
    let governors = print.governors.as_ref().map(|governors| {
        let mut different = governors.clone();
        different.sort();
        different.dedup();
        different.join(", ")
    });
    let frequency = print.frequency.map(|range| {
        let (lowest, highest) = (range.lowest_khz / 1000, range.highest_khz / 1000);
        format!("{lowest} to {highest} MHz")
    });
    vec![
        ("processor", reported(print.cpu_model.as_ref())),
        ("cores", reported(print.n_logical_cores)),
        (
            "cores we may use",
            reported(print.usable_cores.as_deref().map(cores)),
        ),
        (
            "two threads a core",
            reported(print.is_smt_active.map(yes_or_no)),
        ),
        (
            "last-level cache",
            reported(print.last_level_cache_bytes.map(mib)),
        ),
        ("frequency now", reported(frequency)),
        ("governor", reported(governors)),
        ("memory", reported(print.memory_total_bytes.map(mib))),
        (
            "huge pages for",
            reported(print.transparent_huge_pages.as_ref()),
        ),
    ]
}

fn kernel(print: &Fingerprint) -> Vec<(&'static str, String)> {
    let settings = print.scheduler_settings.iter();
    let settings: Vec<String> = settings
        .map(|(name, value)| format!("{} {value}", name.trim_start_matches("sched_")))
        .collect();
    let settings = (!settings.is_empty()).then(|| settings.join(", "));
    vec![
        ("kernel", reported(print.kernel_release.as_ref())),
        ("preemption", reported(print.preemption.as_ref())),
        ("clock source", reported(print.clock_source.as_ref())),
        (
            "hypervisor flag",
            reported(print.has_hypervisor.map(yes_or_no)),
        ),
        ("virtual machine", reported(print.virtual_machine.as_ref())),
        ("container", reported(print.container.as_ref())),
        (
            "isolated cores",
            reported(print.isolated_cores.as_deref().map(cores)),
        ),
        (
            "tickless cores",
            reported(print.tickless_cores.as_deref().map(cores)),
        ),
        ("scheduler", reported(settings)),
    ]
}

fn rights(print: &Fingerprint) -> Vec<(&'static str, String)> {
    let limit = |limit, shown: fn(u64) -> String| match limit {
        ResourceLimit::Unlimited => "unlimited".to_owned(),
        ResourceLimit::Most(most) => shown(most),
    };
    let priority = limit(print.realtime_priority_limit, |most| most.to_string());
    let memory = limit(print.locked_memory_limit, mib);
    let slack = print.timer_slack_ns;
    let slack = slack.map(|slack_ns| format!("{:.1} µs", slack_ns as f64 / 1000.0));
    vec![
        ("timer slack", reported(slack)),
        ("RLIMIT_RTPRIO", priority),
        ("RLIMIT_MEMLOCK", memory),
        (
            "SCHED_FIFO allowed",
            reported(print.may_use_fifo.map(yes_or_no)),
        ),
    ]
}

/// Disturbance section as text, one line per reported value.
pub(super) fn of_disturbance(found: &Disturbance) -> String {
    let percent =
        |share: Option<f64>| reported(share.map(|share| format!("{:.2} %", 100.0 * share)));
    let load = found.other_load_cores;
    let load = load.map(|cores| format!("{:.1} % of a core", 100.0 * cores));
    lines(&[
        ("measured for", format!("{:.1} s", found.duration_s)),
        ("taken by the hypervisor", percent(found.steal_share)),
        ("others' work", reported(load)),
        ("waits for a core, ours too", percent(found.waiting_share)),
        ("our major page faults", reported(found.major_faults)),
        (
            "our involuntary switches",
            reported(found.involuntary_switches),
        ),
        ("frequency changes", reported(found.frequency_changes)),
        ("frequency drift", percent(found.frequency_drift_share)),
    ])
}

fn yes_or_no(value: bool) -> &'static str {
    if value { "yes" } else { "no" }
}

fn mib(bytes: u64) -> String {
    format!("{} MiB", bytes >> 20)
}

/// Formats cores as the kernel does: `0-3,8`.
fn cores(cores: &[u32]) -> String {
    let mut runs: Vec<(u32, u32)> = Vec::new();
    for &core in cores {
        match runs.last_mut() {
            Some((_, last)) if *last + 1 == core => *last = core,
            _ => runs.push((core, core)),
        }
    }
    let runs = runs.iter().map(|(first, last)| {
        if first == last {
            first.to_string()
        } else {
            format!("{first}-{last}")
        }
    });
    let list: Vec<String> = runs.collect();
    if list.is_empty() {
        "none".to_owned()
    } else {
        list.join(",")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system_files::SystemFiles;

    #[test]
    fn cores_are_written_as_the_kernel_does() {
        assert_eq!(cores(&[0, 1, 2, 5, 7, 8]), "0-2,5,7-8");
        assert_eq!(cores(&[]), "none");
    }

    #[test]
    fn unreported_values_are_shown_as_such() {
        let folder = tempfile::tempdir().unwrap();
        let print = Fingerprint::read_from(&SystemFiles::below(folder.path()));
        let text = of_fingerprint(&print);
        for name in ["governor", "clock source", "isolated cores", "processor"] {
            let line = text.lines().find(|line| line.starts_with(name)).unwrap();
            assert!(line.ends_with("  not told"), "{line}");
        }
    }
}
