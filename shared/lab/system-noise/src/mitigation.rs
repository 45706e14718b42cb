//! Measured effects of noise mitigations on this computer.

use crate::probe::bandwidth::{Bandwidth, MemoryOperation};
use crate::samples::{LatencySummary, Samples};
use crate::thread_setting::{SettingTrial, ThreadSetting};
use serde::{Deserialize, Serialize};
use std::io;

/// Factor by which a value must change to count as an effect. Chosen.
const CLEAR_FACTOR: f64 = 1.25;

/// Mitigation of system noise.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mitigation {
    /// CPU frequency governor.
    Governor,
    /// Core isolation: cores reserved for some threads.
    Isolation,
    /// Real-time scheduling of threads (`SCHED_FIFO`).
    RealTime,
    /// Minimal timer slack: timers are not coalesced.
    TimerSlack,
    /// CPU affinity: one core for a thread.
    OneCore,
    /// Memory locked in RAM (`mlockall`).
    LockedMemory,
    /// Huge memory pages.
    HugePages,
}

/// Verdict on the effect of a mitigation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EffectVerdict {
    /// Clearly better than the baseline measurement.
    Better,
    /// No clear difference: within the spread of the baseline, or by less than a quarter.
    NoDifference,
    /// Clearly worse than the baseline measurement.
    Worse,
    /// Mixed verdict: one percentile is clearly better and another clearly worse.
    Mixed,
}

/// Effect of a mitigation on a probe.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum MitigationEffect {
    /// Effect on latencies, judged by the 50th, 99th and 99.9th percentiles.
    Latency {
        /// Tested mitigation.
        #[serde(rename = "advice")]
        mitigation: Mitigation,
        /// Name of the latency probe.
        probe: String,
        /// `true` if a thread was spinning on every core.
        is_loaded: bool,
        /// Latencies of all baseline trials.
        before: LatencySummary,
        /// Latencies under the mitigation.
        after: LatencySummary,
        /// Verdict on the latency effect.
        verdict: EffectVerdict,
    },
    /// Effect on memory bandwidth, judged by the best round.
    Bandwidth {
        /// Tested mitigation.
        #[serde(rename = "advice")]
        mitigation: Mitigation,
        /// Memory operation of the probe.
        operation: MemoryOperation,
        /// Baseline bandwidth, 10^9 bytes per second.
        before_gb_per_s: f64,
        /// Bandwidth with the mitigation, 10^9 bytes per second.
        after_gb_per_s: f64,
        /// Verdict on the bandwidth effect.
        verdict: EffectVerdict,
    },
    /// Mitigation that could not be tried.
    NotAllowed {
        /// Mitigation that could not be tried.
        #[serde(rename = "advice")]
        mitigation: Mitigation,
        /// Reason why the mitigation could not be tried, as one sentence.
        why: String,
        /// Instruction for obtaining the privilege: one sentence.
        how_to_get_it: String,
    },
}

impl MitigationEffect {
    /// Mitigation to which the effect belongs.
    pub fn mitigation(&self) -> Mitigation {
        match self {
            Self::Latency { mitigation, .. }
            | Self::Bandwidth { mitigation, .. }
            | Self::NotAllowed { mitigation, .. } => *mitigation,
        }
    }

    /// Effect of a mitigation that this process is not permitted to use.
    pub fn refused(mitigation: Mitigation, error: &io::Error) -> Self {
        let how_to_get_it = match mitigation {
            Mitigation::RealTime => {
                "Start it with LimitRTPRIO=80 in its systemd unit, with `rtprio 80` in \
                 /etc/security/limits.conf, or with CAP_SYS_NICE."
            }
            Mitigation::LockedMemory => {
                "Start it with LimitMEMLOCK=infinity in its systemd unit, with `memlock unlimited` \
                 in /etc/security/limits.conf, or with CAP_IPC_LOCK."
            }
            Mitigation::HugePages => {
                "Write madvise into /sys/kernel/mm/transparent_hugepage/enabled, on a kernel that \
                 has that file."
            }
            Mitigation::Governor
            | Mitigation::Isolation
            | Mitigation::TimerSlack
            | Mitigation::OneCore => {
                "Lift the CPU limit of this process, see `systemctl show -p AllowedCPUs`."
            }
        };
        Self::NotAllowed {
            mitigation,
            why: format!("It could not be tried: {error}."),
            how_to_get_it: how_to_get_it.to_owned(),
        }
    }
}

/// Mitigation that a thread setting implements; `None` for the baseline.
pub(crate) fn mitigation_of(setting: ThreadSetting) -> Option<Mitigation> {
    match setting {
        ThreadSetting::Baseline => None,
        ThreadSetting::RealTime => Some(Mitigation::RealTime),
        ThreadSetting::NoTimerSlack => Some(Mitigation::TimerSlack),
        ThreadSetting::OneCore => Some(Mitigation::OneCore),
        ThreadSetting::LockedMemory => Some(Mitigation::LockedMemory),
    }
}

/// Compares the trials of each setting with the baseline. Several trials of each are needed: a
/// setting is clearly better if its worst trial is clearly better than the best baseline trial.
pub fn latency_effects(trials: &[SettingTrial]) -> Vec<MitigationEffect> {
    let probes: [fn(&SettingTrial) -> &Samples; 2] = [|trial| &trial.timer, |trial| &trial.wake_up];
    let mut conditions: Vec<(bool, ThreadSetting)> = Vec::new();
    for trial in trials {
        let condition = (trial.is_loaded, trial.setting);
        if !conditions.contains(&condition) {
            conditions.push(condition);
        }
    }
    let effects = conditions.into_iter().filter_map(|(is_loaded, setting)| {
        let mitigation = mitigation_of(setting)?;
        let of = |setting| of_condition(trials, is_loaded, setting);
        let (before, after) = (of(ThreadSetting::Baseline), of(setting));
        Some(probes.map(|probe| latency_effect(mitigation, is_loaded, &before, &after, probe)))
    });
    effects.flatten().flatten().collect()
}

fn of_condition(
    trials: &[SettingTrial],
    is_loaded: bool,
    setting: ThreadSetting,
) -> Vec<&SettingTrial> {
    let alike = |trial: &&SettingTrial| (trial.is_loaded, trial.setting) == (is_loaded, setting);
    trials.iter().filter(alike).collect()
}

fn latency_effect(
    mitigation: Mitigation,
    is_loaded: bool,
    before: &[&SettingTrial],
    after: &[&SettingTrial],
    probe: fn(&SettingTrial) -> &Samples,
) -> Option<MitigationEffect> {
    let percentiles =
        |trials: &[&SettingTrial], percentile: fn(LatencySummary) -> u64| -> Vec<f64> {
            let summaries = trials.iter().filter_map(|trial| probe(trial).summary);
            summaries
                .map(|summary| percentile(summary) as f64)
                .collect()
        };
    let verdict_on = |percentile: fn(LatencySummary) -> u64| {
        verdict(
            &percentiles(before, percentile),
            &percentiles(after, percentile),
        )
    };
    let all = |trials: &[&SettingTrial]| {
        let values = trials.iter().flat_map(|trial| &probe(trial).values_ns);
        LatencySummary::of(&values.copied().collect::<Vec<u64>>())
    };
    Some(MitigationEffect::Latency {
        mitigation,
        probe: probe(after.first()?).name.clone(),
        is_loaded,
        before: all(before)?,
        after: all(after)?,
        verdict: together(&[
            verdict_on(|s| s.p50_ns),
            verdict_on(|s| s.p99_ns),
            verdict_on(|s| s.p99_9_ns),
        ]),
    })
}

/// Combines the verdicts on several percentiles into one.
fn together(verdicts: &[EffectVerdict]) -> EffectVerdict {
    let has = |verdict| verdicts.contains(&verdict);
    match (has(EffectVerdict::Better), has(EffectVerdict::Worse)) {
        (true, true) => EffectVerdict::Mixed,
        (true, false) => EffectVerdict::Better,
        (false, true) => EffectVerdict::Worse,
        (false, false) => EffectVerdict::NoDifference,
    }
}

/// Verdict on times (lower is better).
fn verdict(before: &[f64], after: &[f64]) -> EffectVerdict {
    let least = |values: &[f64]| values.iter().copied().fold(f64::INFINITY, f64::min);
    let most = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    if most(after) * CLEAR_FACTOR < least(before) {
        EffectVerdict::Better
    } else if least(after) > most(before) * CLEAR_FACTOR {
        EffectVerdict::Worse
    } else {
        EffectVerdict::NoDifference
    }
}

/// Compares single-threaded bandwidths on huge pages with those on normal pages, operation by
/// operation. Several measurements of each are needed.
pub fn huge_page_effects(before: &[Bandwidth], after: &[Bandwidth]) -> Vec<MitigationEffect> {
    let operations = [
        MemoryOperation::Read,
        MemoryOperation::Write,
        MemoryOperation::Copy,
    ];
    let bests = |all: &[Bandwidth], operation| -> Vec<f64> {
        let alike = all
            .iter()
            .filter(|one| one.operation == operation && one.n_threads == 1);
        alike.map(|one| one.best_gb_per_s).collect()
    };
    let effects = operations.into_iter().filter_map(|operation| {
        let (before, after) = (bests(before, operation), bests(after, operation));
        // Time per byte (lower is better).
        let times = |bests: &[f64]| bests.iter().map(|best| best.recip()).collect::<Vec<_>>();
        Some(MitigationEffect::Bandwidth {
            mitigation: Mitigation::HugePages,
            operation,
            verdict: verdict(&times(&before), &times(&after)),
            before_gb_per_s: before.into_iter().reduce(f64::max)?,
            after_gb_per_s: after.into_iter().reduce(f64::max)?,
        })
    });
    effects.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trial(setting: ThreadSetting, is_loaded: bool, time_ns: u64) -> SettingTrial {
        let samples = |name| Samples::new(name, "", vec![time_ns; 100]);
        SettingTrial {
            setting,
            is_loaded,
            timer: samples("timer"),
            wake_up: samples("wake-up"),
        }
    }

    fn verdicts(trials: &[SettingTrial]) -> Vec<EffectVerdict> {
        let verdict = |effect: &MitigationEffect| match effect {
            MitigationEffect::Latency { verdict, .. } => *verdict,
            other => panic!("{other:?}"),
        };
        latency_effects(trials).iter().map(verdict).collect()
    }

    #[test]
    fn effect_must_exceed_the_spread() {
        let with = |first_ns, second_ns| {
            verdicts(&[
                trial(ThreadSetting::Baseline, true, 100),
                trial(ThreadSetting::RealTime, true, first_ns),
                trial(ThreadSetting::Baseline, true, 200),
                trial(ThreadSetting::RealTime, true, second_ns),
            ])
        };
        for (first_ns, second_ns, expected) in [
            (10, 70, EffectVerdict::Better),
            (10, 90, EffectVerdict::NoDifference),
            (900, 240, EffectVerdict::NoDifference),
            (260, 900, EffectVerdict::Worse),
        ] {
            let found = with(first_ns, second_ns);
            assert_eq!(found, [expected; 2], "{first_ns} and {second_ns} ns");
        }
    }

    #[test]
    fn contradicting_percentiles_are_mixed() {
        use EffectVerdict::{Better, Mixed, NoDifference, Worse};
        for (verdicts, expected) in [
            ([Better, NoDifference, Better], Better),
            ([NoDifference, NoDifference, Worse], Worse),
            ([NoDifference; 3], NoDifference),
            ([Worse, NoDifference, Better], Mixed),
        ] {
            assert_eq!(together(&verdicts), expected, "{verdicts:?}");
        }
    }

    #[test]
    fn idle_trials_are_compared_with_idle_baselines() {
        let trials = [
            trial(ThreadSetting::Baseline, false, 10),
            trial(ThreadSetting::Baseline, true, 1000),
            trial(ThreadSetting::OneCore, false, 10),
        ];
        assert_eq!(verdicts(&trials), [EffectVerdict::NoDifference; 2]);
        assert_eq!(latency_effects(&trials[1..]), []);
    }

    #[test]
    fn more_bandwidth_is_better() {
        let of = |best_gb_per_s| Bandwidth {
            operation: MemoryOperation::Read,
            n_threads: 1,
            n_bytes: 1,
            best_gb_per_s,
            rounds_gb_per_s: vec![best_gb_per_s],
        };
        let verdict_on = |after: [f64; 2]| {
            let effects = huge_page_effects(&[of(10.0), of(12.0)], &after.map(of));
            match effects.as_slice() {
                [MitigationEffect::Bandwidth { verdict, .. }] => *verdict,
                other => panic!("{other:?}"),
            }
        };
        assert_eq!(verdict_on([20.0, 16.0]), EffectVerdict::Better);
        assert_eq!(verdict_on([20.0, 14.0]), EffectVerdict::NoDifference);
        assert_eq!(verdict_on([5.0, 7.0]), EffectVerdict::Worse);
        assert_eq!(huge_page_effects(&[of(10.0)], &[]), []);
    }

    #[test]
    fn refused_mitigation_names_the_privilege() {
        let denied = io::Error::from(io::ErrorKind::PermissionDenied);
        for (mitigation, part) in [
            (Mitigation::RealTime, "LimitRTPRIO"),
            (Mitigation::LockedMemory, "LimitMEMLOCK"),
            (Mitigation::HugePages, "transparent_hugepage"),
            (Mitigation::OneCore, "AllowedCPUs"),
        ] {
            let effect = MitigationEffect::refused(mitigation, &denied);
            assert!(
                matches!(&effect, MitigationEffect::NotAllowed { how_to_get_it, .. } if how_to_get_it.contains(part))
            );
        }
    }
}
