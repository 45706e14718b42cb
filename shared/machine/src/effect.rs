//! What each piece of advice brings on this computer.

use crate::noise::bandwidth::{Bandwidth, Operation};
use crate::samples::{Samples, Summary};
use crate::trial::{Setting, Trial};
use serde::{Deserialize, Serialize};
use std::io;

/// A change by less than this factor is none.
const CLEAR_FACTOR: f64 = 1.25;

/// What can be done against noise.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AdviceKind {
    /// The frequency governor.
    Governor,
    /// Cores that only some threads may use.
    Isolation,
    /// `SCHED_FIFO`.
    RealTime,
    /// A core for a thread.
    OneCore,
    /// Locked memory.
    LockedMemory,
    /// Huge pages.
    HugePages,
}

/// What came of a setting.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Clearly better than without.
    Better,
    /// Within what two measurements without it differ by, or by less than a quarter.
    NoDifference,
    /// Clearly worse than without.
    Worse,
}

/// What a piece of advice did to a probe here.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Effect {
    /// On times; judged by the 99th percentile.
    Latency {
        /// The advice.
        advice: AdviceKind,
        /// The probe.
        probe: String,
        /// Whether a thread was spinning on every core.
        is_loaded: bool,
        /// Without it: of all measurements as it is.
        before: Summary,
        /// With it.
        after: Summary,
        /// What came of it.
        verdict: Verdict,
    },
    /// On bandwidth; judged by the best round.
    Bandwidth {
        /// The advice.
        advice: AdviceKind,
        /// What was done with memory.
        operation: Operation,
        /// Without it, 10^9 bytes a second.
        before_gb_per_s: f64,
        /// With it, 10^9 bytes a second.
        after_gb_per_s: f64,
        /// What came of it.
        verdict: Verdict,
    },
    /// It could not be tried.
    NotAllowed {
        /// The advice.
        advice: AdviceKind,
        /// Why not: a sentence.
        why: String,
        /// How to get the right to it: a sentence.
        how_to_get_it: String,
    },
}

impl Effect {
    /// Which advice it is of.
    pub fn advice(&self) -> AdviceKind {
        match self {
            Self::Latency { advice, .. }
            | Self::Bandwidth { advice, .. }
            | Self::NotAllowed { advice, .. } => *advice,
        }
    }

    /// A setting that this process may not have.
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
            AdviceKind::Governor | AdviceKind::Isolation | AdviceKind::OneCore => {
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

/// Which advice a setting follows; as it is, none.
pub(crate) fn advice_of(setting: Setting) -> Option<AdviceKind> {
    match setting {
        Setting::AsIs => None,
        Setting::RealTime => Some(AdviceKind::RealTime),
        Setting::OneCore => Some(AdviceKind::OneCore),
        Setting::LockedMemory => Some(AdviceKind::LockedMemory),
    }
}

/// Compares each setting's trials with those as it is, of which there should be two:
/// how much they differ is noise.
pub fn latency_effects(trials: &[Trial]) -> Vec<Effect> {
    let probes: [fn(&Trial) -> &Samples; 2] = [|trial| &trial.timer, |trial| &trial.wake_up];
    let effects = trials.iter().filter_map(|trial| {
        let advice = advice_of(trial.setting)?;
        Some(probes.map(|probe| latency_effect(advice, trial, trials, probe)))
    });
    effects.flatten().flatten().collect()
}

fn latency_effect(
    advice: AdviceKind,
    trial: &Trial,
    trials: &[Trial],
    probe: fn(&Trial) -> &Samples,
) -> Option<Effect> {
    let as_is = || {
        let same = trials
            .iter()
            .filter(|other| other.setting == Setting::AsIs && other.is_loaded == trial.is_loaded);
        same.map(probe)
    };
    let all_ns: Vec<u64> = as_is().flat_map(|s| s.values_ns.iter().copied()).collect();
    let p99s_ns = as_is().filter_map(|samples| Some(samples.summary?.p99_ns as f64));
    let samples = probe(trial);
    let after = samples.summary?;
    Some(Effect::Latency {
        advice,
        probe: samples.name.clone(),
        is_loaded: trial.is_loaded,
        before: Summary::of(&all_ns)?,
        after,
        verdict: verdict(&p99s_ns.collect::<Vec<_>>(), after.p99_ns as f64),
    })
}

/// Judges times, of which less is better.
fn verdict(before: &[f64], after: f64) -> Verdict {
    let least = before.iter().copied().fold(f64::INFINITY, f64::min);
    let most = before.iter().copied().fold(0.0, f64::max);
    if after * CLEAR_FACTOR < least {
        Verdict::Better
    } else if after > most * CLEAR_FACTOR {
        Verdict::Worse
    } else {
        Verdict::NoDifference
    }
}

/// Compares bandwidths on huge pages with those without, operation by operation.
pub fn huge_page_effects(before: &[Bandwidth], after: &[Bandwidth]) -> Vec<Effect> {
    let pairs = before.iter().filter_map(|before| {
        let alike = |other: &&Bandwidth| {
            (other.operation, other.n_threads) == (before.operation, before.n_threads)
        };
        Some((before, after.iter().find(alike)?))
    });
    let effect = |(before, after): (&Bandwidth, &Bandwidth)| Effect::Bandwidth {
        advice: AdviceKind::HugePages,
        operation: before.operation,
        before_gb_per_s: before.best_gb_per_s,
        after_gb_per_s: after.best_gb_per_s,
        // The time for one byte, of which less is better.
        verdict: verdict(&[before.best_gb_per_s.recip()], after.best_gb_per_s.recip()),
    };
    pairs.map(effect).collect()
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
        let with = |time_ns| {
            verdicts(&[
                trial(Setting::AsIs, true, 100),
                trial(Setting::RealTime, true, time_ns),
                trial(Setting::AsIs, true, 200),
            ])
        };
        for (time_ns, expected) in [
            (70, Verdict::Better),
            (90, Verdict::NoDifference),
            (240, Verdict::NoDifference),
            (260, Verdict::Worse),
        ] {
            assert_eq!(with(time_ns), [expected; 2], "{time_ns} ns");
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
        let effects = huge_page_effects(&[of(10.0)], &[of(20.0)]);
        assert!(matches!(
            effects.as_slice(),
            [Effect::Bandwidth {
                verdict: Verdict::Better,
                ..
            }]
        ));
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
