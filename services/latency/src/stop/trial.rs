//! One measured stop: press the word while the arm moves, wait until it rests.

use super::condition::ConditionGuard;
use super::moving_arm::MovingArm;
use random::Random;
use service::Failure;
use std::time::{Duration, Instant};

/// Longest delay between the beginning of a motion and its stop, so that stops come at any time of
/// the loop's cycle and of the frame.
const DELAY_MAX_S: f64 = 0.1;
/// Maximum time until the arm's loop acts, and then until the arm is at rest.
const TIMEOUT: Duration = Duration::from_secs(1);
const POLL_PERIOD: Duration = Duration::from_millis(1);

/// Times of a stop since the word was written, nanoseconds; `None` when the limit passed before.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StopTrial {
    pub(crate) braking_ns: Option<u64>,
    pub(crate) rest_ns: Option<u64>,
}

/// Measures one stop.
pub(crate) fn measure_stop(
    arm: &MovingArm,
    guard: &ConditionGuard,
    number: usize,
) -> Result<StopTrial, Failure> {
    arm.swing(number)?;
    let mut random = Random::from_seed(number as u64);
    std::thread::sleep(Duration::from_secs_f64(DELAY_MAX_S * random.unit()));
    let button = arm.button()?;
    guard.before_stop(arm);
    let word = button.press().map_err(Failure::general)?;
    let taken = button.wait_until_taken(word, TIMEOUT);
    let Some(taken) = taken.map_err(Failure::general)? else {
        return Ok(StopTrial {
            braking_ns: None,
            rest_ns: None,
        });
    };
    let since = |time_ns: u64| time_ns.saturating_sub(word);
    let begun = Instant::now();
    let mut rest_ns = taken.rest_ns;
    while rest_ns == 0 && begun.elapsed() < TIMEOUT {
        std::thread::sleep(POLL_PERIOD);
        rest_ns = button.record().map_err(Failure::general)?.rest_ns;
    }
    Ok(StopTrial {
        braking_ns: Some(since(taken.braking_ns)),
        rest_ns: (rest_ns > 0).then(|| since(rest_ns)),
    })
}
