//! Complete system-noise measurement: all programs in sequence.

use crate::bandwidth::Bandwidth;
use crate::disturbance::Disturbance;
use crate::fingerprint::Fingerprint;
use crate::interruptions::Interruptions;
use crate::measuring_program::Error;
use crate::timer_latency::{CpuLoad, ThreadSetting, TimerTrial};
use crate::warning::{Warning, warnings};
use serde::{Deserialize, Serialize};

/// Durations of the parts of a measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MeasurementPlan {
    /// Number of timers of each setting, idle and busy; a timer takes 1 ms.
    pub n_timers: u32,
    /// Observation time of a spinning thread, seconds.
    pub spinning_s: u32,
    /// Number of rounds of the memory operations.
    pub n_rounds: u32,
}

impl MeasurementPlan {
    /// Full measurement, about 50 s: the tail of each latency rests on thousands of samples.
    pub const FULL: Self = Self {
        n_timers: 4000,
        spinning_s: 4,
        n_rounds: 4,
    };

    /// Short measurement, about 10 s, for a first look.
    pub const SHORT: Self = Self {
        n_timers: 400,
        spinning_s: 1,
        n_rounds: 1,
    };
}

/// Part of the measurement that was not possible.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct NotMeasured {
    /// Name of the part that was not measured.
    pub name: String,
    /// Reason why the part was not measured, as one sentence.
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
    /// Timer latencies under each thread setting, idle and busy.
    pub timers: Vec<TimerTrial>,
    /// Interruptions of a spinning thread.
    pub interruptions: Option<Interruptions>,
    /// Memory bandwidth on one thread and on all cores.
    pub bandwidths: Vec<Bandwidth>,
    /// Parts that could not be measured.
    pub not_measured: Vec<NotMeasured>,
}

/// Runs all parts of a plan and calls `progress` with a sentence before each part. Never fails as
/// a whole.
pub fn measure(plan: &MeasurementPlan, progress: &mut dyn FnMut(&str)) -> MachineReport {
    let fingerprint = Fingerprint::read();
    let watch = Disturbance::begin();
    let mut missing = Vec::new();
    let n_cores = fingerprint.usable_cores.as_ref().map_or(1, Vec::len);
    let timers = timers(plan, n_cores, &mut missing, progress);
    progress("How often a thread that never sleeps is interrupted.");
    let interruptions = Interruptions::measure(plan.spinning_s);
    let interruptions = found("interruptions", interruptions, &mut missing);
    progress("How fast memory is.");
    let mut threads = vec![1, n_cores];
    threads.dedup();
    let bandwidths = threads.into_iter().filter_map(|n_threads| {
        let bandwidth = Bandwidth::measure(n_threads, plan.n_rounds);
        found(
            &format!("memory, {n_threads} threads"),
            bandwidth,
            &mut missing,
        )
    });
    let bandwidths = bandwidths.collect();
    // The measuring programs have ended; their work was measured, so it is counted as others'.
    let disturbance = watch.end(&[std::process::id()]);
    MachineReport {
        warnings: warnings(&fingerprint, &disturbance),
        fingerprint,
        disturbance,
        timers,
        interruptions,
        bandwidths,
        not_measured: missing,
    }
}

/// Result of a part, or `None` with the reason among the missing ones.
fn found<T>(name: &str, result: Result<T, Error>, missing: &mut Vec<NotMeasured>) -> Option<T> {
    let note = |error: Error| {
        missing.push(NotMeasured {
            name: name.to_owned(),
            why: error.to_string(),
        });
    };
    result.map_err(note).ok()
}

fn timers(
    plan: &MeasurementPlan,
    n_cores: usize,
    missing: &mut Vec<NotMeasured>,
    progress: &mut dyn FnMut(&str),
) -> Vec<TimerTrial> {
    let mut trials = Vec::new();
    for (is_loaded, machine) in [(false, "idle"), (true, "busy")] {
        let load = is_loaded.then(|| CpuLoad::begin(n_cores)).transpose();
        let Some(_load) = found("busy machine", load, missing) else {
            continue;
        };
        for setting in ThreadSetting::ALL {
            let name = format!("timer on the {machine} machine, {}", setting.word());
            progress(&format!("How late a sleeping thread wakes: {name}."));
            let trial = TimerTrial::measure(setting, is_loaded, plan.n_timers);
            trials.extend(found(&name, trial, missing));
        }
    }
    trials
}
