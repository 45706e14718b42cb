//! Warnings about conditions that invalidate latency figures.

use crate::disturbance::Disturbance;
use crate::fingerprint::{BuildProfile, Fingerprint};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Maximum share of steal time. Chosen: more is visible in the figures.
const STEAL_SHARE_MAX: f64 = 0.005;
/// Maximum load of other processes, cores. Chosen: more is visible in the figures.
const OTHER_LOAD_CORES_MAX: f64 = 0.05;
/// Maximum relative change of frequency. Chosen: more makes two runs differ.
const FREQUENCY_DRIFT_SHARE_MAX: f64 = 0.1;
/// Clock sources that are read without a system call.
const FAST_CLOCK_SOURCES: [&str; 5] = [
    "tsc",
    "kvm-clock",
    "arch_sys_counter",
    "riscv_clocksource",
    "hyperv_clocksource_tsc_page",
];

/// Condition that invalidates latency figures, with its remedy.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Warning {
    /// Condition and its effect on the figures, as one sentence.
    pub finding: String,
    /// Remedy for the problem, as one sentence.
    pub remedy: String,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.finding, self.remedy)
    }
}

/// Warnings about figures measured in this environment and with these disturbances. Values that
/// this computer does not report cause no warning.
pub fn warnings(fingerprint: &Fingerprint, disturbance: &Disturbance) -> Vec<Warning> {
    let of_environment = [
        debug_build(fingerprint),
        slow_clock(fingerprint),
        governor(fingerprint),
        no_real_time(fingerprint),
        one_core(fingerprint),
    ];
    let of_interval = [
        steal(disturbance),
        other_load(disturbance),
        major_faults(disturbance),
        frequency(disturbance),
        ended(disturbance),
    ];
    of_environment
        .into_iter()
        .chain(of_interval)
        .flatten()
        .collect()
}

fn warn_if(is_so: bool, finding: impl Into<String>, remedy: &str) -> Option<Warning> {
    is_so.then(|| Warning {
        finding: finding.into(),
        remedy: remedy.to_owned(),
    })
}

fn debug_build(fingerprint: &Fingerprint) -> Option<Warning> {
    warn_if(
        fingerprint.build_profile == BuildProfile::Debug,
        "This is a debug build: its checks make everything slower.",
        "Build with `cargo build --release`.",
    )
}

fn slow_clock(fingerprint: &Fingerprint) -> Option<Warning> {
    let source = fingerprint.clock_source.as_deref()?;
    let is_fast = FAST_CLOCK_SOURCES.contains(&source);
    warn_if(
        !is_fast,
        format!(
            "The clock source is {source}: every reading of the clock is a call into the \
             kernel, and is in each latency."
        ),
        "Write tsc into /sys/devices/system/clocksource/clocksource0/current_clocksource \
         where available_clocksource offers it.",
    )
}

fn governor(fingerprint: &Fingerprint) -> Option<Warning> {
    let governors = fingerprint.governors.as_ref()?;
    let other = governors.iter().find(|name| *name != "performance")?;
    Some(Warning {
        finding: format!(
            "The frequency governor is {other}: after each pause a core is slow at first, so \
             latencies at 30 frames a second are longer than under load."
        ),
        remedy: "Run `cpupower frequency-set -g performance`.".to_owned(),
    })
}

fn no_real_time(fingerprint: &Fingerprint) -> Option<Warning> {
    warn_if(
        fingerprint.may_use_fifo == Some(false),
        "This process may not use SCHED_FIFO: any busy process delays it by whole time \
         slices, and what SCHED_FIFO would bring cannot be measured.",
        "Give it LimitRTPRIO=80 in its systemd unit, or `rtprio 80` in \
         /etc/security/limits.conf.",
    )
}

fn one_core(fingerprint: &Fingerprint) -> Option<Warning> {
    let cores = fingerprint.usable_cores.as_ref()?;
    warn_if(
        cores.len() == 1,
        "This process may use one core only: sender and receiver take turns, and each hop \
         has a change of threads in it.",
        "Give it two cores or more.",
    )
}

fn steal(disturbance: &Disturbance) -> Option<Warning> {
    let share = disturbance.steal_share?;
    warn_if(
        share > STEAL_SHARE_MAX,
        format!(
            "The hypervisor took {:.1} % of the time of all cores: the slow end of every \
             latency is its doing.",
            100.0 * share
        ),
        "Measure on hardware, or when the host's other guests are idle.",
    )
}

fn other_load(disturbance: &Disturbance) -> Option<Warning> {
    let cores = disturbance.other_load_cores?;
    warn_if(
        cores > OTHER_LOAD_CORES_MAX,
        format!(
            "Other processes and interrupts worked for {:.0} % of a core meanwhile: their \
             turns are in the latencies.",
            100.0 * cores
        ),
        "Stop them, see `top`, and measure again.",
    )
}

fn major_faults(disturbance: &Disturbance) -> Option<Warning> {
    let n_faults = disturbance.major_faults?;
    warn_if(
        n_faults > 0,
        format!("{n_faults} page faults of ours had to wait for a disk, for milliseconds each."),
        "Measure again now that the pages are in memory; lock the memory of what must not wait.",
    )
}

fn frequency(disturbance: &Disturbance) -> Option<Warning> {
    let share = disturbance.frequency_drift_share?;
    warn_if(
        share > FREQUENCY_DRIFT_SHARE_MAX,
        format!(
            "A core's frequency changed by {:.0} % meanwhile: the same work took different \
             times.",
            100.0 * share
        ),
        "Set the governor to performance and switch turbo off while you compare.",
    )
}

fn ended(disturbance: &Disturbance) -> Option<Warning> {
    let pids = &disturbance.ended_pids;
    warn_if(
        !pids.is_empty(),
        format!(
            "Processes {pids:?} ended before the measurement did: their work counts as that of others."
        ),
        "Look into the log why they ended.",
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system_files::SystemFiles;

    fn quiet() -> (Fingerprint, Disturbance) {
        let nowhere = tempfile::tempdir().unwrap();
        let fingerprint = Fingerprint {
            build_profile: BuildProfile::Release,
            may_use_fifo: Some(true),
            usable_cores: Some(vec![0, 1]),
            clock_source: Some("tsc".to_owned()),
            governors: Some(vec!["performance".to_owned()]),
            ..Fingerprint::read_from(&SystemFiles::below(nowhere.path()))
        };
        let disturbance = Disturbance {
            duration_s: 1.0,
            steal_share: Some(0.005),
            other_load_cores: Some(0.05),
            waiting_share: None,
            major_faults: Some(0),
            involuntary_switches: Some(0),
            frequency_changes: None,
            frequency_drift_share: Some(0.0),
            ended_pids: Vec::new(),
        };
        (fingerprint, disturbance)
    }

    #[test]
    fn quiet_environment_has_no_warnings() {
        let (fingerprint, disturbance) = quiet();
        assert_eq!(warnings(&fingerprint, &disturbance), []);
    }

    #[test]
    fn each_condition_has_a_warning() {
        let (fingerprint, disturbance) = quiet();
        let environment = |change: fn(&mut Fingerprint)| {
            let mut changed = fingerprint.clone();
            change(&mut changed);
            warnings(&changed, &disturbance)
        };
        let interval = |change: fn(&mut Disturbance)| {
            let mut changed = disturbance.clone();
            change(&mut changed);
            warnings(&fingerprint, &changed)
        };
        let cases = [
            (
                environment(|f| f.build_profile = BuildProfile::Debug),
                "debug",
            ),
            (
                environment(|f| f.clock_source = Some("hpet".into())),
                "hpet",
            ),
            (
                environment(|f| f.governors = Some(vec!["powersave".into()])),
                "powersave",
            ),
            (environment(|f| f.may_use_fifo = Some(false)), "SCHED_FIFO"),
            (environment(|f| f.usable_cores = Some(vec![3])), "one core"),
            (interval(|d| d.steal_share = Some(0.021)), "2.1 %"),
            (interval(|d| d.other_load_cores = Some(0.5)), "50 %"),
            (interval(|d| d.major_faults = Some(3)), "3 page faults"),
            (interval(|d| d.frequency_drift_share = Some(0.3)), "30 %"),
            (interval(|d| d.ended_pids = vec![77]), "77"),
        ];
        for (found, part) in cases {
            assert_eq!(found.len(), 1, "{part}");
            let sentence = found[0].to_string();
            assert!(sentence.contains(part), "{part} is not in {sentence}");
            assert!(sentence.ends_with('.'), "{sentence}");
        }
    }
}
