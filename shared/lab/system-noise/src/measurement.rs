//! Everything, one after the other.

use crate::advice::{Advice, advice};
use crate::disturbance::Disturbance;
use crate::effect::{AdviceKind, Effect, advice_of, huge_page_effects, latency_effects};
use crate::fingerprint::Fingerprint;
use crate::noise::bandwidth::{Bandwidth, Buffers, buffer_bytes, read_just_written};
use crate::noise::clock_cost::{ClockCost, clock_costs};
use crate::noise::hop::{self, Payload, Receiver, hop};
use crate::noise::interruptions::{Interruptions, interruptions};
use crate::noise::timer::timer;
use crate::noise::wake_up::wake_up;
use crate::samples::Samples;
use crate::trial::{Setting, Trial, trial};
use crate::warning::{Warning, warnings};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io;
use std::time::Duration;

/// How often each setting is tried.
const N_ROUNDS: usize = 2;

/// How long to measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Plan {
    /// Timer, wake-up and interruptions, each.
    pub probe: Duration,
    /// Each clock.
    pub clock: Duration,
    /// Each hop.
    pub hop: Duration,
    /// Each of the two probes of a trial; there are twenty trials.
    pub trial: Duration,
    /// Rounds of each operation on memory.
    pub n_rounds: usize,
    /// Bytes of a buffer; `None` for what no cache can help with.
    pub buffer_bytes: Option<usize>,
}

impl Plan {
    /// About 50 s in all: the slow end of each probe rests on thousands of samples.
    pub const FULL: Self = Self {
        probe: Duration::from_secs(4),
        clock: Duration::from_millis(200),
        hop: Duration::from_millis(1500),
        trial: Duration::from_millis(650),
        n_rounds: 7,
        buffer_bytes: None,
    };

    /// A tenth of everything: a first look.
    pub const SHORT: Self = Self {
        probe: Duration::from_millis(400),
        clock: Duration::from_millis(20),
        hop: Duration::from_millis(300),
        trial: Duration::from_millis(65),
        n_rounds: 2,
        buffer_bytes: None,
    };
}

/// A part that could not be measured.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct NotMeasured {
    /// Name of the probe.
    pub name: String,
    /// Why not: a sentence.
    pub why: String,
}

/// What this computer adds to every latency.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MachineReport {
    /// Where it was measured.
    pub fingerprint: Fingerprint,
    /// What else went on meanwhile.
    pub disturbance: Disturbance,
    /// What makes the figures untrue.
    pub warnings: Vec<Warning>,
    /// Timer, wake-up and hops.
    pub latencies: Vec<Samples>,
    /// What the machine takes away.
    pub interruptions: Interruptions,
    /// What reading a clock costs.
    pub clocks: Vec<ClockCost>,
    /// How fast memory is, on one thread and on all.
    pub bandwidths: Vec<Bandwidth>,
    /// The same on huge pages, on one thread, twice.
    pub huge_page_bandwidths: Vec<Bandwidth>,
    /// Timer and wake-up under each setting, idle and busy.
    pub trials: Vec<Trial>,
    /// What each setting did.
    pub effects: Vec<Effect>,
    /// What to do.
    pub advice: Vec<Advice>,
    /// What could not be measured.
    pub not_measured: Vec<NotMeasured>,
}

/// Measures everything by a plan, with a sentence before each part. Nothing fails as
/// a whole; all settings are as before at the end.
pub fn measure(plan: &Plan, progress: &mut dyn FnMut(&str)) -> MachineReport {
    let fingerprint = Fingerprint::read();
    let watch = Disturbance::begin();
    let mut not_measured = Vec::new();
    let latencies = latencies(plan, &mut not_measured, progress);
    progress("How often a thread that never sleeps is interrupted.");
    let interruptions = interruptions(plan.probe);
    progress("What reading a clock costs.");
    let clocks = clock_costs(plan.clock);
    let (trials, mut effects) = trials(plan, &mut not_measured, progress);
    progress("How fast memory is.");
    let n_bytes = plan.buffer_bytes;
    let n_bytes = n_bytes.unwrap_or_else(|| buffer_bytes(&fingerprint));
    let n_cores = fingerprint.usable_cores.as_ref().map_or(1, Vec::len);
    let bandwidths = bandwidths(plan, n_bytes, n_cores).unwrap_or_else(|error| {
        not_measured.push(missing("memory", &error));
        Vec::new()
    });
    progress("How fast memory is on huge pages.");
    let huge_page_bandwidths = huge_pages(plan, n_bytes, &bandwidths, &mut effects);
    let disturbance = watch.end(&[std::process::id()]);
    MachineReport {
        warnings: warnings(&fingerprint, &disturbance),
        advice: advice(&fingerprint, &effects),
        fingerprint,
        disturbance,
        latencies,
        interruptions,
        clocks,
        bandwidths,
        huge_page_bandwidths,
        trials,
        effects,
        not_measured,
    }
}

fn missing(name: &str, why: &dyn std::fmt::Display) -> NotMeasured {
    NotMeasured {
        name: name.to_owned(),
        why: why.to_string(),
    }
}

fn latencies(
    plan: &Plan,
    not_measured: &mut Vec<NotMeasured>,
    progress: &mut dyn FnMut(&str),
) -> Vec<Samples> {
    progress("How late a sleeping thread wakes.");
    let mut latencies = vec![timer(plan.probe)];
    progress("How long one thread needs to wake another.");
    match wake_up(plan.probe) {
        Ok(samples) => latencies.push(samples),
        Err(error) => not_measured.push(missing("wake-up", &error)),
    }
    let hops = [
        (Payload::Small, Receiver::Polled),
        (Payload::Cloud, Receiver::Polled),
        (Payload::Small, Receiver::Blocking),
        (Payload::Cloud, Receiver::Blocking),
    ];
    for (payload, receiver) in hops {
        let (name, _) = hop::names(payload, receiver);
        progress(&format!("How long a message is on its way: {name}."));
        match hop(payload, receiver, plan.hop) {
            Ok(samples) => latencies.push(samples),
            Err(error) => not_measured.push(missing(name, &error)),
        }
    }
    latencies
}

/// All settings in turn, and that again, so that what comes and goes is not taken
/// for the effect of a setting.
fn trials(
    plan: &Plan,
    not_measured: &mut Vec<NotMeasured>,
    progress: &mut dyn FnMut(&str),
) -> (Vec<Trial>, Vec<Effect>) {
    let settings = [
        Setting::AsIs,
        Setting::RealTime,
        Setting::NoTimerSlack,
        Setting::OneCore,
        Setting::LockedMemory,
    ];
    let (mut trials, mut refused) = (Vec::new(), BTreeMap::new());
    for (is_loaded, machine) in [(false, "idle"), (true, "busy")] {
        for setting in settings.repeat(N_ROUNDS) {
            let name = setting.name();
            progress(&format!(
                "Timer and wake-up on the {machine} machine: {name}."
            ));
            match (trial(setting, is_loaded, plan.trial), advice_of(setting)) {
                (Ok(trial), _) => trials.push(trial),
                (Err(error), Some(advice)) => {
                    // Idle and busy are refused for the same reason.
                    refused
                        .entry(name)
                        .or_insert(Effect::refused(advice, &error));
                }
                (Err(error), None) => not_measured.push(missing(name, &error)),
            }
        }
    }
    let mut effects = latency_effects(&trials);
    effects.extend(refused.into_values());
    (trials, effects)
}

fn bandwidths(plan: &Plan, n_bytes: usize, n_cores: usize) -> io::Result<Vec<Bandwidth>> {
    let mut buffers = Buffers::new(n_bytes);
    let mut bandwidths = buffers.measure(1, plan.n_rounds)?;
    if n_cores > 1 {
        bandwidths.extend(buffers.measure(n_cores, plan.n_rounds)?);
    }
    // A cloud is small: a round of it is short.
    bandwidths.push(read_just_written(10 * plan.n_rounds));
    Ok(bandwidths)
}

/// On huge pages and without in turn, so that what comes and goes is not taken for
/// their effect.
fn huge_pages(
    plan: &Plan,
    n_bytes: usize,
    before: &[Bandwidth],
    effects: &mut Vec<Effect>,
) -> Vec<Bandwidth> {
    let (mut without, mut with) = (before.to_vec(), Vec::new());
    let mut in_turn = || {
        for round in 0..N_ROUNDS {
            if round > 0 {
                without.extend(Buffers::new(n_bytes).measure(1, plan.n_rounds)?);
            }
            let mut buffers = Buffers::on_huge_pages(n_bytes)?;
            with.extend(buffers.measure(1, plan.n_rounds)?);
        }
        Ok(())
    };
    let measured: io::Result<()> = in_turn();
    match measured {
        Ok(()) => effects.extend(huge_page_effects(&without, &with)),
        Err(error) => effects.push(Effect::refused(AdviceKind::HugePages, &error)),
    }
    with
}
