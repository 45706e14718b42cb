//! Complete system-noise measurement: all probes in sequence.

use crate::disturbance::Disturbance;
use crate::fingerprint::Fingerprint;
use crate::mitigation::{
    Mitigation, MitigationEffect, huge_page_effects, latency_effects, mitigation_of,
};
use crate::probe::bandwidth::{Bandwidth, BandwidthBuffers, buffer_bytes, read_just_written};
use crate::probe::clock_cost::{ClockCost, clock_costs};
use crate::probe::interruptions::{Interruptions, interruptions};
use crate::probe::timer::timer_latency;
use crate::probe::transport::{Payload, ReceiveMode, name_and_meaning, transport_latency};
use crate::probe::wake_up::wake_up_latency;
use crate::recommendation::{Recommendation, recommendations};
use crate::samples::Samples;
use crate::thread_setting::{SettingTrial, ThreadSetting, run_trial};
use crate::warning::{Warning, warnings};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io;
use std::time::Duration;

/// Number of trials of each setting.
const N_ROUNDS: usize = 2;

/// Durations of the probes of a measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MeasurementPlan {
    /// Duration of the timer, wake-up and interruption probes, each.
    pub probe: Duration,
    /// Duration of the cost measurement of each clock.
    pub clock: Duration,
    /// Duration of each transport probe.
    pub transport: Duration,
    /// Duration of each of the two probes of a trial; there are twenty trials.
    pub trial: Duration,
    /// Number of rounds of each memory operation.
    pub n_rounds: usize,
    /// Size of a bandwidth buffer, bytes; `None` for several times the last-level cache.
    pub buffer_bytes: Option<usize>,
}

impl MeasurementPlan {
    /// Full measurement, about 50 s: the tail of each probe rests on thousands of samples.
    pub const FULL: Self = Self {
        probe: Duration::from_secs(4),
        clock: Duration::from_millis(200),
        transport: Duration::from_millis(1500),
        trial: Duration::from_millis(650),
        n_rounds: 7,
        buffer_bytes: None,
    };

    /// Short measurement: a tenth of the duration, for a first look.
    pub const SHORT: Self = Self {
        probe: Duration::from_millis(400),
        clock: Duration::from_millis(20),
        transport: Duration::from_millis(300),
        trial: Duration::from_millis(65),
        n_rounds: 2,
        buffer_bytes: None,
    };
}

/// Probe that could not be run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct NotMeasured {
    /// Name of the probe that was not run.
    pub name: String,
    /// Reason why the probe was not run, as one sentence.
    pub why: String,
}

/// Report of all system-noise measurements.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MachineReport {
    /// Environment fingerprint: hardware, kernel and privileges.
    pub fingerprint: Fingerprint,
    /// Disturbances during the measurement.
    pub disturbance: Disturbance,
    /// Warnings that call the figures into question.
    pub warnings: Vec<Warning>,
    /// Latencies of timer, wake-up and transport.
    pub latencies: Vec<Samples>,
    /// Interruptions of a spinning thread.
    pub interruptions: Interruptions,
    /// Cost of reading clocks.
    pub clocks: Vec<ClockCost>,
    /// Memory bandwidth on one thread and on all cores.
    pub bandwidths: Vec<Bandwidth>,
    /// Single-threaded memory bandwidth on huge pages, twice.
    pub huge_page_bandwidths: Vec<Bandwidth>,
    /// Timer and wake-up latencies under each thread setting, idle and busy.
    pub trials: Vec<SettingTrial>,
    /// Measured effects of the mitigations.
    pub effects: Vec<MitigationEffect>,
    /// Recommended mitigations, in the order in which they are worth trying.
    #[serde(rename = "advice")]
    pub recommendations: Vec<Recommendation>,
    /// Probes that could not be run.
    pub not_measured: Vec<NotMeasured>,
}

/// Runs all probes of a plan and calls `progress` with a sentence before each part. Never fails
/// as a whole; all settings are reverted at the end.
pub fn measure(plan: &MeasurementPlan, progress: &mut dyn FnMut(&str)) -> MachineReport {
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
        recommendations: recommendations(&fingerprint, &effects),
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
    plan: &MeasurementPlan,
    not_measured: &mut Vec<NotMeasured>,
    progress: &mut dyn FnMut(&str),
) -> Vec<Samples> {
    progress("How late a sleeping thread wakes.");
    let mut latencies = vec![timer_latency(plan.probe)];
    progress("How long one thread needs to wake another.");
    match wake_up_latency(plan.probe) {
        Ok(samples) => latencies.push(samples),
        Err(error) => not_measured.push(missing("wake-up", &error)),
    }
    let transports = [
        (Payload::Small, ReceiveMode::Polled),
        (Payload::Cloud, ReceiveMode::Polled),
        (Payload::Small, ReceiveMode::Blocking),
        (Payload::Cloud, ReceiveMode::Blocking),
    ];
    for (payload, receiver) in transports {
        let (name, _) = name_and_meaning(payload, receiver);
        progress(&format!("How long a message is on its way: {name}."));
        match transport_latency(payload, receiver, plan.transport) {
            Ok(samples) => latencies.push(samples),
            Err(error) => not_measured.push(missing(name, &error)),
        }
    }
    latencies
}

/// Runs the trials of all settings in turn, repeatedly, so that transient noise is not attributed
/// to a setting.
fn trials(
    plan: &MeasurementPlan,
    not_measured: &mut Vec<NotMeasured>,
    progress: &mut dyn FnMut(&str),
) -> (Vec<SettingTrial>, Vec<MitigationEffect>) {
    let settings = [
        ThreadSetting::Baseline,
        ThreadSetting::RealTime,
        ThreadSetting::NoTimerSlack,
        ThreadSetting::OneCore,
        ThreadSetting::LockedMemory,
    ];
    let (mut trials, mut refused) = (Vec::new(), BTreeMap::new());
    for (is_loaded, machine) in [(false, "idle"), (true, "busy")] {
        for setting in settings.repeat(N_ROUNDS) {
            let name = setting.name();
            progress(&format!(
                "Timer and wake-up on the {machine} machine: {name}."
            ));
            match (
                run_trial(setting, is_loaded, plan.trial),
                mitigation_of(setting),
            ) {
                (Ok(trial), _) => trials.push(trial),
                (Err(error), Some(mitigation)) => {
                    // The refusal is the same for idle and busy.
                    refused
                        .entry(name)
                        .or_insert(MitigationEffect::refused(mitigation, &error));
                }
                (Err(error), None) => not_measured.push(missing(name, &error)),
            }
        }
    }
    let mut effects = latency_effects(&trials);
    effects.extend(refused.into_values());
    (trials, effects)
}

fn bandwidths(
    plan: &MeasurementPlan,
    n_bytes: usize,
    n_cores: usize,
) -> io::Result<Vec<Bandwidth>> {
    let mut buffers = BandwidthBuffers::new(n_bytes);
    let mut bandwidths = buffers.measure(1, plan.n_rounds)?;
    if n_cores > 1 {
        bandwidths.extend(buffers.measure(n_cores, plan.n_rounds)?);
    }
    // A cloud is small, so a round is short.
    bandwidths.push(read_just_written(10 * plan.n_rounds));
    Ok(bandwidths)
}

/// Alternates huge and normal pages, so that transient noise is not attributed to them.
fn huge_pages(
    plan: &MeasurementPlan,
    n_bytes: usize,
    before: &[Bandwidth],
    effects: &mut Vec<MitigationEffect>,
) -> Vec<Bandwidth> {
    let (mut without, mut with) = (before.to_vec(), Vec::new());
    let mut in_turn = || {
        for round in 0..N_ROUNDS {
            if round > 0 {
                without.extend(BandwidthBuffers::new(n_bytes).measure(1, plan.n_rounds)?);
            }
            let mut buffers = BandwidthBuffers::on_huge_pages(n_bytes)?;
            with.extend(buffers.measure(1, plan.n_rounds)?);
        }
        Ok(())
    };
    let measured: io::Result<()> = in_turn();
    match measured {
        Ok(()) => effects.extend(huge_page_effects(&without, &with)),
        Err(error) => effects.push(MitigationEffect::refused(Mitigation::HugePages, &error)),
    }
    with
}
