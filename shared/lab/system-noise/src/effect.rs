//! Measured effects of noise mitigations on this computer.

use crate::noise::bandwidth::{Bandwidth, Operation};
use crate::samples::{Samples, Summary};
use crate::trial::{Setting, Trial};
use serde::{Deserialize, Serialize};
use std::io;

/// Factor by which a value must change to count as an effect. Chosen.
const CLEAR_FACTOR: f64 = 1.25;

/// Mitigation of system noise.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AdviceKind {
    /// CPU frequency governor.
    Governor,
    /// Core isolation: cores reserved for some threads.
    Isolation,
    /// Real-time scheduling (`SCHED_FIFO`).
    RealTime,
    /// Minimal timer slack: timers are not coalesced.
    TimerSlack,
    /// CPU affinity: one core for a thread.
    OneCore,
    /// Locked memory (`mlockall`).
    LockedMemory,
    /// Huge pages.
    HugePages,
}

/// Verdict on the effect of a mitigation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Clearly better than the baseline.
    Better,
    /// No clear difference: within the spread of the baseline, or by less than a quarter.
    NoDifference,
    /// Clearly worse than the baseline.
    Worse,
    /// One percentile is clearly better and another clearly worse.
    Mixed,
}

/// Effect of a mitigation on a probe.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Effect {
    /// Effect on latencies, judged by the 50th, 99th and 99.9th percentiles.
    Latency {
        /// Mitigation.
        advice: AdviceKind,
        /// Name of the probe.
        probe: String,
        /// `true` if a thread was spinning on every core.
        is_loaded: bool,
        /// Latencies of all baseline trials.
        before: Summary,
        /// Latencies with the mitigation.
        after: Summary,
        /// Verdict.
        verdict: Verdict,
    },
    /// Effect on memory bandwidth, judged by the best round.
    Bandwidth {
        /// Mitigation.
        advice: AdviceKind,
        /// Memory operation.
        operation: Operation,
        /// Baseline bandwidth, 10^9 bytes per second.
        before_gb_per_s: f64,
        /// Bandwidth with the mitigation, 10^9 bytes per second.
        after_gb_per_s: f64,
        /// Verdict.
        verdict: Verdict,
    },
    /// Mitigation that could not be tried.
    NotAllowed {
        /// Mitigation.
        advice: AdviceKind,
        /// Reason: one sentence.
        why: String,
        /// Instruction for obtaining the privilege: one sentence.
        how_to_get_it: String,
    },
}

impl Effect {
    /// Mitigation whose effect this is.
    pub fn advice(&self) -> AdviceKind {
        match self {
            Self::Latency { advice, .. }
            | Self::Bandwidth { advice, .. }
            | Self::NotAllowed { advice, .. } => *advice,
        }
    }

    /// Effect of a mitigation that this process is not permitted to use.
    pub fn refused(advice: AdviceKind, error: &io::Error) -> Self {
        let how_to_get_it = match advice {
            AdviceKind::RealTime => {
                "Start it with LimitRTPRIO=80 in its systemd unit, with `rtprio 80` in \
                 /etc/security/limits.conf, or with CAP_SYS_NICE."
            }
            AdviceKind::LockedMemory => {
                "Start it with LimitMEMLOCK=infinity in its systemd unit, with `memlock unlimited` \
                 in /etc/security/limits.conf, or with CAP_IPC_LOCK."
            }
            AdviceKind::HugePages => {
                "Write madvise into /sys/kernel/mm/transparent_hugepage/enabled, on a kernel that \
                 has that file."
            }
            AdviceKind::Governor
            | AdviceKind::Isolation
            | AdviceKind::TimerSlack
            | AdviceKind::OneCore => {
                "Ask whoever limits this process's cores, see `systemctl show -p AllowedCPUs`."
            }
        };
        Self::NotAllowed {
            advice,
            why: format!("It could not be tried: {error}."),
            how_to_get_it: how_to_get_it.to_owned(),
        }
    }
}

/// Mitigation that a thread setting implements; `None` for the baseline.
pub(crate) fn advice_of(setting: Setting) -> Option<AdviceKind> {
    match setting {
        Setting::AsIs => None,
        Setting::RealTime => Some(AdviceKind::RealTime),
        Setting::NoTimerSlack => Some(AdviceKind::TimerSlack),
        Setting::OneCore => Some(AdviceKind::OneCore),
        Setting::LockedMemory => Some(AdviceKind::LockedMemory),
    }
}

/// Compares the trials of each setting with the baseline. Several trials of each are needed: a
/// setting is clearly better if its worst trial is clearly better than the best baseline trial.
pub fn latency_effects(trials: &[Trial]) -> Vec<Effect> {
    let probes: [fn(&Trial) -> &Samples; 2] = [|trial| &trial.timer, |trial| &trial.wake_up];
    let mut conditions: Vec<(bool, Setting)> = Vec::new();
    for trial in trials {
        let condition = (trial.is_loaded, trial.setting);
        if !conditions.contains(&condition) {
            conditions.push(condition);
        }
    }
    let effects = conditions.into_iter().filter_map(|(is_loaded, setting)| {
        let advice = advice_of(setting)?;
        let of = |setting| of_condition(trials, is_loaded, setting);
        let (before, after) = (of(Setting::AsIs), of(setting));
        Some(probes.map(|probe| latency_effect(advice, is_loaded, &before, &after, probe)))
    });
    effects.flatten().flatten().collect()
}

fn of_condition(trials: &[Trial], is_loaded: bool, setting: Setting) -> Vec<&Trial> {
    let alike = |trial: &&Trial| (trial.is_loaded, trial.setting) == (is_loaded, setting);
    trials.iter().filter(alike).collect()
}

fn latency_effect(
    advice: AdviceKind,
    is_loaded: bool,
    before: &[&Trial],
    after: &[&Trial],
    probe: fn(&Trial) -> &Samples,
) -> Option<Effect> {
    let percentiles = |trials: &[&Trial], percentile: fn(Summary) -> u64| -> Vec<f64> {
        let summaries = trials.iter().filter_map(|trial| probe(trial).summary);
        summaries
            .map(|summary| percentile(summary) as f64)
            .collect()
    };
    let judged = |percentile: fn(Summary) -> u64| {
        verdict(
            &percentiles(before, percentile),
            &percentiles(after, percentile),
        )
    };
    let all = |trials: &[&Trial]| {
        let values = trials.iter().flat_map(|trial| &probe(trial).values_ns);
        Summary::of(&values.copied().collect::<Vec<u64>>())
    };
    Some(Effect::Latency {
        advice,
        probe: probe(after.first()?).name.clone(),
        is_loaded,
        before: all(before)?,
        after: all(after)?,
        verdict: together(&[
            judged(|s| s.p50_ns),
            judged(|s| s.p99_ns),
            judged(|s| s.p99_9_ns),
        ]),
    })
}

/// Combines the verdicts on several percentiles.
fn together(verdicts: &[Verdict]) -> Verdict {
    let has = |verdict| verdicts.contains(&verdict);
    match (has(Verdict::Better), has(Verdict::Worse)) {
        (true, true) => Verdict::Mixed,
        (true, false) => Verdict::Better,
        (false, true) => Verdict::Worse,
        (false, false) => Verdict::NoDifference,
    }
}

/// Verdict on times (lower is better).
fn verdict(before: &[f64], after: &[f64]) -> Verdict {
    let least = |values: &[f64]| values.iter().copied().fold(f64::INFINITY, f64::min);
    let most = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    if most(after) * CLEAR_FACTOR < least(before) {
        Verdict::Better
    } else if least(after) > most(before) * CLEAR_FACTOR {
        Verdict::Worse
    } else {
        Verdict::NoDifference
    }
}

/// Compares single-threaded bandwidths on huge pages with those on normal pages, operation by
/// operation. Several measurements of each are needed.
pub fn huge_page_effects(before: &[Bandwidth], after: &[Bandwidth]) -> Vec<Effect> {
    let operations = [Operation::Read, Operation::Write, Operation::Copy];
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
        Some(Effect::Bandwidth {
            advice: AdviceKind::HugePages,
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

    fn trial(setting: Setting, is_loaded: bool, time_ns: u64) -> Trial {
        let samples = |name| Samples::new(name, "", vec![time_ns; 100]);
        Trial {
            setting,
            is_loaded,
            timer: samples("timer"),
            wake_up: samples("wake-up"),
        }
    }

    fn verdicts(trials: &[Trial]) -> Vec<Verdict> {
        let verdict = |effect: &Effect| match effect {
            Effect::Latency { verdict, .. } => *verdict,
            other => panic!("{other:?}"),
        };
        latency_effects(trials).iter().map(verdict).collect()
    }

    #[test]
    fn a_change_must_be_clearer_than_the_noise() {
        let with = |first_ns, second_ns| {
            verdicts(&[
                trial(Setting::AsIs, true, 100),
                trial(Setting::RealTime, true, first_ns),
                trial(Setting::AsIs, true, 200),
                trial(Setting::RealTime, true, second_ns),
            ])
        };
        for (first_ns, second_ns, expected) in [
            (10, 70, Verdict::Better),
            (10, 90, Verdict::NoDifference),
            (900, 240, Verdict::NoDifference),
            (260, 900, Verdict::Worse),
        ] {
            let found = with(first_ns, second_ns);
            assert_eq!(found, [expected; 2], "{first_ns} and {second_ns} ns");
        }
    }

    #[test]
    fn percentiles_that_disagree_are_told() {
        use Verdict::{Better, Mixed, NoDifference, Worse};
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
    fn idle_is_compared_with_idle_only() {
        let trials = [
            trial(Setting::AsIs, false, 10),
            trial(Setting::AsIs, true, 1000),
            trial(Setting::OneCore, false, 10),
        ];
        assert_eq!(verdicts(&trials), [Verdict::NoDifference; 2]);
        assert_eq!(latency_effects(&trials[1..]), []);
    }

    #[test]
    fn more_bandwidth_is_better() {
        let of = |best_gb_per_s| Bandwidth {
            operation: Operation::Read,
            n_threads: 1,
            n_bytes: 1,
            best_gb_per_s,
            rounds_gb_per_s: vec![best_gb_per_s],
        };
        let judged = |after: [f64; 2]| {
            let effects = huge_page_effects(&[of(10.0), of(12.0)], &after.map(of));
            match effects.as_slice() {
                [Effect::Bandwidth { verdict, .. }] => *verdict,
                other => panic!("{other:?}"),
            }
        };
        assert_eq!(judged([20.0, 16.0]), Verdict::Better);
        assert_eq!(judged([20.0, 14.0]), Verdict::NoDifference);
        assert_eq!(judged([5.0, 7.0]), Verdict::Worse);
        assert_eq!(huge_page_effects(&[of(10.0)], &[]), []);
    }

    #[test]
    fn a_refusal_says_how_to_get_the_right() {
        let denied = io::Error::from(io::ErrorKind::PermissionDenied);
        for (advice, part) in [
            (AdviceKind::RealTime, "LimitRTPRIO"),
            (AdviceKind::LockedMemory, "LimitMEMLOCK"),
            (AdviceKind::HugePages, "transparent_hugepage"),
            (AdviceKind::OneCore, "AllowedCPUs"),
        ] {
            let effect = Effect::refused(advice, &denied);
            assert!(
                matches!(&effect, Effect::NotAllowed { how_to_get_it, .. } if how_to_get_it.contains(part))
            );
        }
    }
}
