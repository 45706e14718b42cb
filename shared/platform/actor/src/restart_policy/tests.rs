use proptest::prelude::*;

use super::*;

const SECOND: Duration = Duration::from_secs(1);

fn policy(max_restarts: u32, window_ms: u64, min_ms: u64, max_ms: u64) -> RestartPolicy {
    let ms = Duration::from_millis;
    RestartPolicy::new(max_restarts, ms(window_ms), ms(min_ms), ms(max_ms)).unwrap()
}

/// Reference policy: counts over the list of all restarts.
fn reference(policy: &RestartPolicy, restarts: &[Instant], now: Instant) -> RestartDecision {
    let n_recent = restarts
        .iter()
        .filter(|t| now - **t < policy.window)
        .count();
    if n_recent >= policy.max_restarts as usize {
        return RestartDecision::Escalate;
    }
    let doubled = policy.backoff_min.as_nanos() << n_recent;
    let nanos = doubled.min(policy.backoff_max.as_nanos());
    RestartDecision::Restart {
        after: Duration::from_nanos(u64::try_from(nanos).unwrap()),
    }
}

proptest! {
    #[test]
    fn decisions_agree_with_the_reference(
        max_restarts in 0_u32..12,
        window_ms in 1_u64..5_000,
        (min_ms, extra_ms) in (0_u64..300, 0_u64..3_000),
        gaps_ms in prop::collection::vec(prop_oneof![0_u64..20, 0_u64..3_000], 1..80),
    ) {
        let policy = policy(max_restarts, window_ms, min_ms, min_ms + extra_ms);
        let mut history = RestartHistory::new(policy);
        let mut restarts = Vec::new();
        let mut now = Instant::now();
        for gap_ms in gaps_ms {
            now += Duration::from_millis(gap_ms);
            let expected = reference(&policy, &restarts, now);
            prop_assert_eq!(history.on_failure(now), expected);
            if expected != RestartDecision::Escalate {
                restarts.push(now);
            }
        }
    }

    #[test]
    fn no_window_holds_more_restarts_than_allowed(
        max_restarts in 1_u32..8,
        window_ms in 1_u64..2_000,
        gaps_ms in prop::collection::vec(0_u64..500, 1..100),
    ) {
        let policy = policy(max_restarts, window_ms, 0, 0);
        let mut history = RestartHistory::new(policy);
        let mut now = Instant::now();
        let mut restarts = Vec::new();
        for gap_ms in gaps_ms {
            now += Duration::from_millis(gap_ms);
            if history.on_failure(now) != RestartDecision::Escalate {
                restarts.push(now);
            }
        }
        for (first, beyond) in restarts.iter().zip(restarts.iter().skip(max_restarts as usize)) {
            prop_assert!(*beyond - *first >= policy.window());
        }
    }
}

#[test]
fn the_backoff_doubles_up_to_its_maximum() {
    let mut history = RestartHistory::new(policy(8, 60_000, 50, 1_000));
    let now = Instant::now();
    let backoffs_ms: Vec<u128> = std::iter::from_fn(|| match history.on_failure(now) {
        RestartDecision::Restart { after } => Some(after.as_millis()),
        RestartDecision::Escalate => None,
    })
    .collect();
    assert_eq!(backoffs_ms, [50, 100, 200, 400, 800, 1_000, 1_000, 1_000]);
}

#[test]
fn backoff_resets_when_restarts_leave_the_window() {
    let mut history = RestartHistory::new(policy(30, 60_000, 50, 2_000));
    let first = Instant::now();
    history.on_failure(first);
    history.on_failure(first + SECOND);
    let later = history.on_failure(first + 62 * SECOND);
    assert_eq!(
        later,
        RestartDecision::Restart {
            after: Duration::from_millis(50)
        }
    );
}

#[test]
fn limit_holds_for_instants_in_the_past() {
    let mut history = RestartHistory::new(policy(1, 1_000, 0, 0));
    let earlier = Instant::now();
    history.on_failure(earlier + 5 * SECOND);
    assert_eq!(history.on_failure(earlier), RestartDecision::Escalate);
}

#[test]
fn backoff_saturates_at_its_maximum() {
    let policy = policy(u32::MAX, 1, 1, 1_000_000_000);
    for n_recent in [31, 32, 64, 65, usize::MAX] {
        assert_eq!(policy.backoff(n_recent), SECOND * 1_000_000);
    }
}

#[test]
fn contradictory_policies_are_refused() {
    let zero_window = RestartPolicy::new(3, Duration::ZERO, SECOND, SECOND).unwrap_err();
    assert!(zero_window.to_string().contains("window must not be empty"));
    let crossed = RestartPolicy::new(3, SECOND, 2 * SECOND, SECOND).unwrap_err();
    assert!(crossed.to_string().contains("shortest back-off"));
}

#[test]
fn restarts_count_on_under_another_policy() {
    let mut history = RestartHistory::new(policy(8, 60_000, 50, 1_000));
    let now = Instant::now();
    for _ in 0..3 {
        let decision = history.on_failure(now);
        assert!(matches!(decision, RestartDecision::Restart { .. }));
    }
    history.set_policy(policy(3, 60_000, 50, 1_000));
    assert_eq!(history.on_failure(now), RestartDecision::Escalate);
    let wider = policy(4, 60_000, 50, 1_000);
    history.set_policy(wider);
    let after = wider.backoff(3);
    assert_eq!(history.on_failure(now), RestartDecision::Restart { after });
    assert_eq!(history.on_failure(now), RestartDecision::Escalate);
}
