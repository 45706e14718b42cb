//! Record of the published states of an arm, and what follows from it.

use message::{ArmActivity, ArmState};

/// Speed below which a joint is at rest, rad/s: that of the stop word's last time.
pub(super) const REST_SPEED_RAD_S: f64 = 0.01;

/// Shortest time over which a deceleration is taken, nanoseconds. Chosen: six states, so that the
/// noise of one velocity says little.
const DECELERATION_WINDOW_NS: u64 = 50_000_000;

/// State with what its message told beside it.
#[derive(Debug, Clone, Copy)]
pub(super) struct RecordedState {
    pub(super) state: ArmState,
    /// Number of capsules; `None` if one of them is none.
    pub(super) n_capsules: Option<usize>,
    /// Time of its reception, monotonic, nanoseconds.
    pub(super) received_ns: u64,
}

/// Longest speed of any joint, rad/s; infinite for one that is no number.
pub(super) fn speed_rad_s(state: &ArmState) -> f64 {
    let speeds = state.joint_velocities_rad_s.map(f64::abs);
    if speeds.iter().all(|speed| speed.is_finite()) {
        speeds.into_iter().fold(0.0, f64::max)
    } else {
        f64::INFINITY
    }
}

pub(super) fn is_at_rest(state: &ArmState) -> bool {
    speed_rad_s(state) < REST_SPEED_RAD_S
}

/// Activity of a state; `None` for a code that is none.
pub(super) fn activity(state: &ArmState) -> Option<ArmActivity> {
    ArmActivity::from_code(state.activity)
}

/// Mean time between two states, nanoseconds, from their stamps and numbers: states that were not
/// received count, too. `None` with fewer than two.
pub(super) fn mean_period_ns(record: &[RecordedState]) -> Option<f64> {
    let (first, last) = (record.first()?.state, record.last()?.state);
    let n_periods = last.sent.checked_sub(first.sent).filter(|n| *n > 0)?;
    Some(last.stamp_ns.checked_sub(first.stamp_ns)? as f64 / n_periods as f64)
}

/// Longest time between two states that follow each other, nanoseconds; `None` if time does not
/// pass between them.
pub(super) fn longest_gap_ns(record: &[RecordedState]) -> Option<u64> {
    let mut longest_ns = 0;
    for pair in record.windows(2) {
        let [before, after] = [&pair[0].state, &pair[1].state];
        let gap_ns = after.stamp_ns.checked_sub(before.stamp_ns);
        let gap_ns = gap_ns.filter(|gap_ns| *gap_ns > 0)?;
        if after.sent == before.sent + 1 {
            longest_ns = longest_ns.max(gap_ns);
        }
    }
    Some(longest_ns)
}

/// Greatest deceleration of a joint's speed over 50 ms, rad/s².
pub(super) fn greatest_deceleration_rad_s2(record: &[RecordedState], joint: usize) -> f64 {
    let speed = |one: &RecordedState| one.state.joint_velocities_rad_s[joint].abs();
    let mut greatest = 0.0_f64;
    for (index, before) in record.iter().enumerate() {
        let due_ns = before.state.stamp_ns + DECELERATION_WINDOW_NS;
        let after = record[index..]
            .iter()
            .find(|after| after.state.stamp_ns >= due_ns);
        if let Some(after) = after {
            let time_s = 1e-9 * (after.state.stamp_ns - before.state.stamp_ns) as f64;
            greatest = greatest.max((speed(before) - speed(after)) / time_s);
        }
    }
    greatest
}

/// Angle through which a joint has turned by its velocities, radians (trapezoidal rule).
pub(super) fn integrated_rad(record: &[RecordedState], joint: usize) -> f64 {
    let steps = record.windows(2).map(|pair| {
        let time_s = 1e-9
            * pair[1]
                .state
                .stamp_ns
                .saturating_sub(pair[0].state.stamp_ns) as f64;
        let velocity = |one: &RecordedState| one.state.joint_velocities_rad_s[joint];
        time_s * 0.5 * (velocity(&pair[0]) + velocity(&pair[1]))
    });
    steps.sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// States at 100 Hz with these velocities of the last joint.
    fn record(velocities: &[f64]) -> Vec<RecordedState> {
        let numbered = (1_u64..).zip(velocities);
        numbered
            .map(|(sent, velocity)| RecordedState {
                state: ArmState {
                    sent,
                    stamp_ns: sent * 10_000_000,
                    joint_velocities_rad_s: [0.0, 0.0, 0.0, 0.0, 0.0, *velocity],
                    ..ArmState::default()
                },
                n_capsules: Some(1),
                received_ns: 0,
            })
            .collect()
    }

    #[test]
    fn period_counts_states_that_were_not_received() {
        let mut states = record(&[0.0; 11]);
        states.drain(3..7);
        assert_eq!(mean_period_ns(&states), Some(1e7));
        assert_eq!(longest_gap_ns(&states), Some(10_000_000));
        states[2].state.stamp_ns = states[1].state.stamp_ns;
        assert_eq!(longest_gap_ns(&states), None, "time stands still");
        assert_eq!(mean_period_ns(&states[..1]), None);
    }

    #[test]
    fn deceleration_of_a_jump_is_greater_than_that_of_a_ramp() {
        let ramp: Vec<f64> = (0..40).map(|step| 0.8 - 0.02 * f64::from(step)).collect();
        let ramp = record(&[vec![0.8; 10], ramp, vec![0.0; 10]].concat());
        let slow = greatest_deceleration_rad_s2(&ramp, 5);
        assert!((slow - 2.0).abs() < 1e-6, "{slow}");
        let jump = record(&[[-0.8; 10], [0.0; 10]].concat());
        let fast = greatest_deceleration_rad_s2(&jump, 5);
        assert!((fast - 16.0).abs() < 1e-6, "{fast}");
    }

    #[test]
    fn turn_is_the_integral_of_the_velocities() {
        let states = record(&[0.5; 101]);
        assert!((integrated_rad(&states, 5) - 0.5).abs() < 1e-9);
    }

    #[test]
    fn speed_that_is_no_number_is_no_rest() {
        let states = record(&[f64::NAN, 0.0]);
        assert!(!is_at_rest(&states[0].state));
        assert!(is_at_rest(&states[1].state));
    }
}
