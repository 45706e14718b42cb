//! Recommendations against system noise, with their measured effect on this computer.

use crate::fingerprint::Fingerprint;
use crate::mitigation::{EffectVerdict, Mitigation, MitigationEffect};
use crate::samples::LatencySummary;
use serde::{Deserialize, Serialize};

/// Recommended mitigation with its measured effect.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Recommendation {
    /// Recommended mitigation.
    pub kind: Mitigation,
    /// Instruction for applying the mitigation, as one sentence.
    pub what_to_do: String,
    /// Measured effect on this computer, or the reason why it was not measured.
    pub finding: String,
}

/// Recommendations for all mitigations, in the order in which they are worth trying.
pub fn recommendations(
    fingerprint: &Fingerprint,
    effects: &[MitigationEffect],
) -> Vec<Recommendation> {
    let measured = |kind| measured(kind, effects);
    [
        (
            Mitigation::RealTime,
            "Give the threads on a frame's way SCHED_FIFO: CPUSchedulingPolicy=fifo, \
             CPUSchedulingPriority=80 and LimitRTPRIO=80 in the systemd unit.",
            measured(Mitigation::RealTime),
        ),
        (
            Mitigation::TimerSlack,
            "Let timers of threads without SCHED_FIFO be on time: TimerSlackNSec=1 in the systemd \
             unit.",
            measured(Mitigation::TimerSlack),
        ),
        (
            Mitigation::OneCore,
            "Keep a thread on one core: CPUAffinity= in the systemd unit, or taskset.",
            measured(Mitigation::OneCore),
        ),
        (
            Mitigation::Isolation,
            "Keep others away from a core: AllowedCPUs= of the other slices (cpuset), or \
             isolcpus= and nohz_full= on the kernel's command line.",
            isolation(fingerprint),
        ),
        (
            Mitigation::LockedMemory,
            "Lock the memory (mlockall): LimitMEMLOCK=infinity in the systemd unit.",
            measured(Mitigation::LockedMemory),
        ),
        (
            Mitigation::HugePages,
            "Put large buffers on huge pages (madvise MADV_HUGEPAGE, with \
             transparent_hugepage at madvise or always).",
            huge_pages(fingerprint, measured(Mitigation::HugePages)),
        ),
        (
            Mitigation::Governor,
            "Set the frequency governor to performance: cpupower frequency-set -g performance.",
            governor(fingerprint),
        ),
    ]
    .map(|(kind, what_to_do, finding)| Recommendation {
        kind,
        what_to_do: what_to_do.to_owned(),
        finding,
    })
    .to_vec()
}

fn measured(kind: Mitigation, effects: &[MitigationEffect]) -> String {
    let sentences: Vec<String> = effects
        .iter()
        .filter(|effect| effect.mitigation() == kind)
        .map(sentence)
        .collect();
    if sentences.is_empty() {
        "It was not measured.".to_owned()
    } else {
        sentences.join(" ")
    }
}

/// Sentence about a measured effect.
fn sentence(effect: &MitigationEffect) -> String {
    match effect {
        MitigationEffect::Latency {
            probe,
            is_loaded,
            before,
            after,
            verdict,
            ..
        } => {
            let machine = if *is_loaded { "busy" } else { "idle" };
            let us = |time_ns: u64| format!("{:.1}", time_ns as f64 / 1000.0);
            let reported =
                |s: &LatencySummary| [s.p50_ns, s.p99_ns, s.p99_9_ns].map(us).join(" / ");
            format!(
                "The {probe} on the {machine} machine is {}: p50 / p99 / p99.9 of {} µs became {} µs.",
                verdict_text(*verdict),
                reported(before),
                reported(after)
            )
        }
        MitigationEffect::Bandwidth {
            operation,
            before_gb_per_s,
            after_gb_per_s,
            verdict,
            ..
        } => format!(
            "To {} is {}: {before_gb_per_s:.1} GB/s became {after_gb_per_s:.1} GB/s.",
            operation.name(),
            verdict_text(*verdict)
        ),
        MitigationEffect::NotAllowed {
            why, how_to_get_it, ..
        } => format!("{why} {how_to_get_it}"),
    }
}

fn verdict_text(verdict: EffectVerdict) -> &'static str {
    match verdict {
        EffectVerdict::Better => "better",
        EffectVerdict::NoDifference => "no different",
        EffectVerdict::Worse => "worse",
        EffectVerdict::Mixed => "better in part and worse in part",
    }
}

fn isolation(fingerprint: &Fingerprint) -> String {
    let isolated = fingerprint.isolated_cores.as_deref().unwrap_or_default();
    let n_cores = fingerprint.n_logical_cores.unwrap_or(0);
    if !isolated.is_empty() {
        format!("Cores {isolated:?} are isolated.")
    } else if n_cores < 4 {
        format!(
            "It does not apply here: of {n_cores} cores none can be spared, because camera, \
             perception and memory work at the same time."
        )
    } else {
        "No core is isolated. Isolation was not measured: it is set at boot.".to_owned()
    }
}

fn huge_pages(fingerprint: &Fingerprint, measured: String) -> String {
    match fingerprint.transparent_huge_pages.as_deref() {
        Some("always") => format!("Every large buffer is on huge pages already. {measured}"),
        Some("never") => {
            format!("The kernel gives none (transparent_hugepage is never). {measured}")
        }
        _ => measured,
    }
}

fn governor(fingerprint: &Fingerprint) -> String {
    let Some(governors) = &fingerprint.governors else {
        return if fingerprint.has_hypervisor == Some(true) {
            "It does not apply here: this is a virtual machine, the host sets the frequency."
        } else {
            "It does not apply here: the kernel does not tell a governor."
        }
        .to_owned();
    };
    match governors.iter().find(|name| *name != "performance") {
        Some(other) => format!(
            "The governor is {other}. It was not measured, because a change would be of the whole \
             computer: set it, and compare two reports."
        ),
        None => "The governor is performance already.".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system_files::SystemFiles;

    fn nowhere() -> Fingerprint {
        let folder = tempfile::tempdir().unwrap();
        Fingerprint::read_from(&SystemFiles::below(folder.path()))
    }

    fn finding(
        fingerprint: &Fingerprint,
        effects: &[MitigationEffect],
        kind: Mitigation,
    ) -> String {
        let all = recommendations(fingerprint, effects);
        all.into_iter().find(|a| a.kind == kind).unwrap().finding
    }

    #[test]
    fn finding_has_the_measured_effect() {
        let summary = |time_ns| LatencySummary::of(&[time_ns]).unwrap();
        let effect = MitigationEffect::Latency {
            mitigation: Mitigation::RealTime,
            probe: "timer".to_owned(),
            is_loaded: true,
            before: summary(4_000_000),
            after: summary(12_340),
            verdict: EffectVerdict::Better,
        };
        let said = finding(&nowhere(), &[effect], Mitigation::RealTime);
        assert!(
            said.contains("better")
                && said.contains("4000.0 / 4000.0 / 4000.0 µs became 12.3 / 12.3 / 12.3 µs"),
            "{said}"
        );
        let other = finding(&nowhere(), &[], Mitigation::LockedMemory);
        assert_eq!(other, "It was not measured.");
    }

    #[test]
    fn finding_names_the_reason_for_an_inapplicable_mitigation() {
        let machine = |change: fn(&mut Fingerprint)| {
            let mut machine = nowhere();
            change(&mut machine);
            machine
        };
        let governor = |m: &Fingerprint| finding(m, &[], Mitigation::Governor);
        let isolation = |m: &Fingerprint| finding(m, &[], Mitigation::Isolation);
        let cases = [
            (
                governor(&machine(|m| m.has_hypervisor = Some(true))),
                "virtual",
            ),
            (
                governor(&machine(|m| m.governors = Some(vec!["powersave".into()]))),
                "powersave",
            ),
            (
                isolation(&machine(|m| m.n_logical_cores = Some(2))),
                "of 2 cores",
            ),
            (
                isolation(&machine(|m| m.isolated_cores = Some(vec![3]))),
                "[3]",
            ),
        ];
        for (said, part) in cases {
            assert!(said.contains(part), "{part} is not in {said}");
        }
    }
}
