//! Model-based test of back-off and escalation, in virtual time.

use std::sync::Arc;
use std::time::Duration;

use crate::adder_fixture::{Adder, AdderCounters, Order, config, next};
use actor::{Config, Events, LifecycleEvent, Placement, Restart, RestartPolicy, Supervisor};
use proptest::prelude::*;
use tokio::runtime::{Builder, Handle};
use tokio::time::{Instant, sleep};

const N_ACTORS: u64 = 3;

#[derive(Debug, Clone)]
struct Case {
    max_restarts: usize,
    window_ms: u64,
    backoff_min_ms: u64,
    backoff_max_ms: u64,
    /// Failures of the case: delay in milliseconds, actor.
    failures: Vec<(u64, u64)>,
}

fn case() -> impl Strategy<Value = Case> {
    let failures = prop::collection::vec((0_u64..1_500, 0..N_ACTORS), 1..40);
    (1_usize..6, 1_u64..6_000, 1_u64..200, 0_u64..2_000, failures).prop_map(
        |(max_restarts, window_ms, backoff_min_ms, extra_ms, failures)| Case {
            max_restarts,
            window_ms,
            backoff_min_ms,
            backoff_max_ms: backoff_min_ms + extra_ms,
            failures,
        },
    )
}

/// Reference restart policy over the list of all restarts so far: the limit counts
/// all actors' restarts, the back-off only this actor's. `None`: escalate.
fn reference(case: &Case, restarts: &[(u64, u64)], actor: u64, now_ms: u64) -> Option<u64> {
    let recent = restarts
        .iter()
        .filter(|(at_ms, _)| now_ms - at_ms < case.window_ms);
    if recent.clone().count() >= case.max_restarts {
        return None;
    }
    let n_own = recent.filter(|(_, id)| *id == actor).count();
    Some((case.backoff_min_ms << n_own).min(case.backoff_max_ms))
}

fn policy(case: &Case) -> RestartPolicy {
    let ms = Duration::from_millis;
    let max_restarts = u32::try_from(case.max_restarts).expect("a few");
    RestartPolicy::new(
        max_restarts,
        ms(case.window_ms),
        ms(case.backoff_min_ms),
        ms(case.backoff_max_ms),
    )
    .expect("the strategy makes valid policies")
}

/// Next decision about a failure; other events are skipped.
async fn verdict(events: &mut Events<u64>) -> Option<(u64, Option<u64>)> {
    loop {
        match next(events).await? {
            LifecycleEvent::Restarting { id, after, .. } => {
                return Some((id, u64::try_from(after.as_millis()).ok()));
            }
            LifecycleEvent::Escalated(escalation) => return Some((escalation.id, None)),
            _ => {}
        }
    }
}

async fn check(case: Case) -> Result<(), TestCaseError> {
    let settings = Config {
        policy: policy(&case),
        ..config(Restart::Permanent, Placement::Inline)
    };
    let (supervisor, mut events) = Supervisor::<u64, Adder>::new(
        settings,
        Arc::new(AdderCounters::default()),
        Handle::current(),
    );
    let mut addresses = Vec::new();
    for id in 0..N_ACTORS {
        addresses.push(supervisor.spawn(id, 0).expect("a new id"));
    }
    let begin = Instant::now();
    let mut restarts = Vec::new();
    for (gap_ms, actor) in &case.failures {
        sleep(Duration::from_millis(*gap_ms)).await;
        addresses[*actor as usize]
            .tell(0, Order::Panic(1))
            .expect("nobody was stopped");
        let actual = verdict(&mut events).await;
        let now_ms = u64::try_from(begin.elapsed().as_millis()).expect("a short test");
        let expected = reference(&case, &restarts, *actor, now_ms);
        prop_assert_eq!(actual, Some((*actor, expected)));
        if expected.is_none() {
            prop_assert_eq!(supervisor.n_actors(), 0);
            return Ok(());
        }
        restarts.push((now_ms, *actor));
    }
    prop_assert_eq!(supervisor.n_actors(), addresses.len());
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn escalation_agrees_with_the_reference_policy(case in case()) {
        let runtime = Builder::new_current_thread().enable_time().start_paused(true).build();
        runtime.expect("a runtime").block_on(check(case))?;
    }
}
