//! Actor life cycle in virtual time: failure, restart, stop and escalation.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use crate::adder_fixture::{
    Adder, AdderCounters, Order, Refused, config, count, lines, next, soon,
};
use actor::{
    Actor, Backpressure, Cause, Config, DropOldest, Error, Events, Flow, LifecycleEvent, Placement,
    Progress, Refuse, ReplyLost, Restart, RestartPolicy, SendError, StopReason, Supervisor,
};
use tokio::runtime::Handle;
use tokio::time::{Instant, advance, sleep};

type Adders<P = DropOldest> = Supervisor<u64, Adder<P>>;

fn inline(restart: Restart) -> Config {
    config(restart, Placement::Inline)
}

fn supervise(config: Config) -> (Adders, Events<u64>, Arc<AdderCounters>) {
    let shared = Arc::new(AdderCounters::default());
    let (supervisor, events) = Supervisor::new(config, Arc::clone(&shared), Handle::current());
    (supervisor, events, shared)
}

#[test]
fn actor_handlers_work_without_a_runtime() {
    let shared = Arc::new(AdderCounters::default());
    let mut adder = Adder::<Refuse>::start(&shared, 40).unwrap();
    assert_eq!(
        adder.handle(Order::Add(2), &Progress::default()),
        Ok(Flow::Continue(42))
    );
    assert_eq!(adder.checkpoint(), 42);
    assert_eq!(
        adder.handle(Order::Fail(1), &Progress::default()),
        Err(Refused)
    );
}

#[tokio::test(start_paused = true)]
async fn panic_restarts_from_the_last_checkpoint_without_effect_on_neighbours() {
    let (supervisor, mut events, shared) = supervise(inline(Restart::Permanent));
    let victim = supervisor.spawn(1, 0).unwrap();
    let neighbour = supervisor.spawn(2, 100).unwrap();
    assert_eq!(soon(victim.ask(10, Order::Add(5)).unwrap()).await, Ok(5));
    assert_eq!(
        lines(&mut events, 2).await,
        ["Actor 1 has started.", "Actor 2 has started."]
    );

    let lost = victim.ask(11, Order::Panic(900)).unwrap();
    let waiting = victim.ask(12, Order::Add(1)).unwrap();
    assert_eq!(soon(lost).await, Err(ReplyLost));
    for n in 1..=20 {
        assert_eq!(
            soon(neighbour.ask(n, Order::Add(1)).unwrap()).await,
            Ok(100 + n)
        );
    }
    // The 900 are forgotten, the message after the panic is not.
    assert_eq!(soon(waiting).await, Ok(6));
    assert_eq!(
        lines(&mut events, 2).await,
        [
            "Actor 1 starts again after 50 ms, because it panicked: at 905 \
             (at message 11, which is lost).",
            "Actor 1 has started."
        ]
    );
    assert_eq!(shared.started.load(Ordering::Relaxed), 3);
    assert_eq!(shared.dropped.load(Ordering::Relaxed), 1, "the broken one");
}

#[tokio::test(start_paused = true)]
async fn error_is_a_failure_with_its_source() {
    let (supervisor, mut events, _) = supervise(inline(Restart::Transient));
    let adder = supervisor.spawn(1, 3).unwrap();
    assert_eq!(
        soon(adder.ask(7, Order::Fail(50)).unwrap()).await,
        Err(ReplyLost)
    );
    assert_eq!(soon(adder.ask(8, Order::Add(1)).unwrap()).await, Ok(4));
    next(&mut events).await;
    let Some(LifecycleEvent::Restarting {
        cause: Cause::Failed(error),
        tag: Some(7),
        ..
    }) = next(&mut events).await
    else {
        panic!("the failure was not reported");
    };
    assert!(error.downcast_ref::<Refused>().is_some());
}

#[tokio::test(start_paused = true)]
async fn backoff_doubles_and_counts_failing_starts() {
    let (supervisor, mut events, shared) = supervise(inline(Restart::Permanent));
    shared.bad_starts.store(4, Ordering::Relaxed);
    let begin = Instant::now();
    let adder = supervisor.spawn(1, 1).unwrap();
    assert_eq!(soon(adder.ask(0, Order::Add(1)).unwrap()).await, Ok(2));
    assert_eq!(begin.elapsed(), Duration::from_millis(50 + 100 + 200 + 400));
    let reports = lines(&mut events, 5).await;
    for (report, after_ms) in reports.iter().zip([50, 100, 200, 400]) {
        let expected = format!(
            "Actor 1 starts again after {after_ms} ms, because it failed: the adder refuses."
        );
        assert_eq!(*report, expected);
    }
    assert_eq!(reports[4], "Actor 1 has started.");
}

#[tokio::test(start_paused = true)]
async fn restart_after_a_voluntary_stop_only_if_permanent() {
    for (restart, ends) in [
        (
            Restart::Permanent,
            "Actor 1 starts again after 50 ms, because it ended by itself.",
        ),
        (Restart::Transient, "Actor 1 has stopped by itself."),
        (Restart::Temporary, "Actor 1 has stopped by itself."),
    ] {
        let (supervisor, mut events, shared) = supervise(inline(restart));
        let adder = supervisor.spawn(1, 0).unwrap();
        assert_eq!(soon(adder.ask(1, Order::Finish(3)).unwrap()).await, Ok(3));
        assert_eq!(lines(&mut events, 2).await, ["Actor 1 has started.", ends]);
        assert_eq!(shared.stopped.load(Ordering::Relaxed), 1);
        assert_eq!(
            supervisor.n_actors(),
            usize::from(restart == Restart::Permanent)
        );
        assert_eq!(adder.is_closed(), restart != Restart::Permanent);
    }
}

#[tokio::test(start_paused = true)]
async fn restart_after_a_failure_unless_temporary() {
    for (restart, comes_back) in [
        (Restart::Permanent, true),
        (Restart::Transient, true),
        (Restart::Temporary, false),
    ] {
        let (supervisor, mut events, _) = supervise(inline(restart));
        let adder = supervisor.spawn(1, 0).unwrap();
        adder.tell(1, Order::Panic(1)).unwrap();
        let waiting = adder.ask(2, Order::Add(2)).unwrap();
        assert_eq!(
            soon(waiting).await,
            if comes_back { Ok(2) } else { Err(ReplyLost) }
        );
        next(&mut events).await;
        let report = next(&mut events).await.unwrap();
        match report {
            LifecycleEvent::Restarting { .. } => assert!(comes_back),
            LifecycleEvent::Stopped {
                reason: StopReason::Failed { tag: Some(1), .. },
                ..
            } => {
                assert!(!comes_back);
            }
            other => panic!("unexpected: {other}"),
        }
    }
}

#[tokio::test(start_paused = true)]
async fn stop_drops_queued_messages_and_notifies_their_senders() {
    let (supervisor, mut events, shared) = supervise(inline(Restart::Permanent));
    let adder = supervisor.spawn(1, 0).unwrap();
    next(&mut events).await;
    let frame = Arc::new(());
    let waiting = adder
        .ask(1, Order::AddHolding(1, Arc::clone(&frame)))
        .unwrap();
    assert!(supervisor.request_stop(&1));
    assert_eq!(Arc::strong_count(&frame), 1, "returned by the call itself");
    assert_eq!(soon(waiting).await, Err(ReplyLost));
    assert!(matches!(
        adder.tell(2, Order::Add(1)),
        Err(SendError::Closed(Order::Add(1)))
    ));
    assert!(soon(supervisor.stop(&1)).await);
    assert_eq!(
        lines(&mut events, 1).await,
        ["Actor 1 has stopped, as it was told."]
    );
    assert_eq!(shared.stopped.load(Ordering::Relaxed), 1);
    assert!(!supervisor.request_stop(&1));
    assert!(supervisor.address(&1).is_none());
    supervisor.spawn(1, 0).expect("the id is free again");
}

#[tokio::test(start_paused = true)]
async fn stop_ends_a_backoff_at_once() {
    let (supervisor, mut events, _) = supervise(inline(Restart::Permanent));
    let adder = supervisor.spawn(1, 0).unwrap();
    assert_eq!(
        soon(adder.ask(1, Order::Panic(0)).unwrap()).await,
        Err(ReplyLost)
    );
    let begin = Instant::now();
    assert!(soon(supervisor.stop(&1)).await);
    assert_eq!(begin.elapsed(), Duration::ZERO);
    let last = lines(&mut events, 3).await.pop();
    assert_eq!(
        last.as_deref(),
        Some("Actor 1 has stopped, as it was told.")
    );
}

#[tokio::test(start_paused = true)]
async fn stop_with_a_panic_is_reported_and_not_restarted() {
    let (supervisor, mut events, _) = supervise(inline(Restart::Permanent));
    let adder = supervisor.spawn(1, 0).unwrap();
    soon(adder.ask(1, Order::SpoilStop).unwrap()).await.unwrap();
    assert!(soon(supervisor.stop(&1)).await);
    next(&mut events).await;
    assert!(matches!(
        next(&mut events).await,
        Some(LifecycleEvent::Stopped {
            reason: StopReason::Failed { cause: Cause::Panicked(text), tag: None },
            ..
        }) if text == "spoilt"
    ));
}

#[tokio::test(start_paused = true)]
async fn actor_id_is_taken_until_its_actor_has_ended() {
    let (supervisor, _events, _) = supervise(inline(Restart::Permanent));
    supervisor.spawn(7, 0).unwrap();
    let error = supervisor.spawn(7, 0).unwrap_err();
    assert!(matches!(&error, Error::AlreadyRunning { id } if id == "7"));
    supervisor.request_stop(&7);
    assert!(
        supervisor.spawn(7, 0).is_err(),
        "told to stop, not yet ended"
    );
    soon(supervisor.stop(&7)).await;
    supervisor.spawn(7, 0).unwrap();
}

#[tokio::test(start_paused = true)]
async fn displaced_request_resolves_and_is_counted() {
    let (supervisor, _events, _) = supervise(inline(Restart::Permanent));
    let adder = supervisor.spawn(1, 0).unwrap();
    // The actor's task has not run yet: the mailbox holds four.
    let answers: Vec<_> = (0..6)
        .map(|n| adder.ask(n, Order::Add(1)).unwrap())
        .collect();
    let mut outcomes = Vec::new();
    for answer in answers {
        outcomes.push(soon(answer).await);
    }
    assert_eq!(
        outcomes,
        [Err(ReplyLost), Err(ReplyLost), Ok(1), Ok(2), Ok(3), Ok(4)]
    );
    assert_eq!(adder.n_dropped(), 2);
}

#[tokio::test(start_paused = true)]
async fn overflow_policies_refuse_and_block_lose_no_message() {
    let shared = Arc::new(AdderCounters::default());
    let (supervisor, _events): (Adders<Refuse>, _) = Supervisor::new(
        inline(Restart::Permanent),
        Arc::clone(&shared),
        Handle::current(),
    );
    let adder = supervisor.spawn(1, 0).unwrap();
    let accepted: Vec<_> = (0..6)
        .map(|n| adder.ask(n, Order::Add(1)).is_ok())
        .collect();
    assert_eq!(accepted, [true, true, true, true, false, false]);

    let (supervisor, _events): (Adders<Backpressure>, _) =
        Supervisor::new(inline(Restart::Permanent), shared, Handle::current());
    let adder = supervisor.spawn(1, 0).unwrap();
    let mut answers = Vec::new();
    for n in 0..20 {
        answers.push(soon(adder.ask(n, Order::Add(1))).await.unwrap());
    }
    for (n, answer) in (1..).zip(answers) {
        assert_eq!(soon(answer).await, Ok(n));
    }
}

#[tokio::test(start_paused = true)]
async fn escalation_stops_all_actors_and_gives_the_reason() {
    let second = Duration::from_secs(1);
    let policy = RestartPolicy::new(2, 60 * second, second, second).unwrap();
    let (supervisor, mut events, shared) = supervise(Config {
        policy,
        ..inline(Restart::Permanent)
    });
    let culprit = supervisor.spawn(1, 0).unwrap();
    let bystander = supervisor.spawn(2, 0).unwrap();
    for tag in 0..3 {
        assert_eq!(
            soon(culprit.ask(tag, Order::Panic(1)).unwrap()).await,
            Err(ReplyLost)
        );
    }
    let mut reports = Vec::new();
    while reports
        .last()
        .is_none_or(|last: &String| !last.contains("All actors"))
    {
        reports.extend(lines(&mut events, 1).await);
    }
    assert_eq!(
        reports.last().unwrap(),
        "All actors were stopped, because more than 2 restarts within 60 s were needed, \
         the last by actor 1: it panicked: at 1 (at message 2, which is lost)."
    );
    assert_eq!(
        reports
            .iter()
            .filter(|report| report.contains("starts again"))
            .count(),
        2
    );
    assert!(reports.contains(&"Actor 2 has stopped, as it was told.".to_owned()));
    assert_eq!(
        shared.stopped.load(Ordering::Relaxed),
        1,
        "the bystander, in good order"
    );
    assert!(bystander.is_closed() && culprit.is_closed());
    assert_eq!(supervisor.n_actors(), 0);
    assert!(matches!(
        supervisor.spawn(3, 0),
        Err(Error::SupervisorEnded { .. })
    ));
}

#[tokio::test(start_paused = true)]
async fn restart_window_forgets_old_restarts() {
    let (supervisor, mut events, _) = supervise(Config {
        policy: RestartPolicy::new(
            1,
            Duration::from_secs(60),
            Duration::from_millis(50),
            Duration::from_millis(50),
        )
        .unwrap(),
        ..inline(Restart::Permanent)
    });
    let adder = supervisor.spawn(1, 0).unwrap();
    for tag in 0..5 {
        assert_eq!(
            soon(adder.ask(tag, Order::Panic(1)).unwrap()).await,
            Err(ReplyLost)
        );
        advance(Duration::from_secs(60)).await;
    }
    assert_eq!(soon(adder.ask(9, Order::Add(1)).unwrap()).await, Ok(1));
    let reports = lines(&mut events, 11).await;
    assert!(reports.iter().all(|report| !report.contains("All actors")));
}

#[tokio::test(start_paused = true)]
async fn stop_all_ends_all_actors_and_refuses_new_ones() {
    let (supervisor, mut events, shared) = supervise(inline(Restart::Permanent));
    let addresses: Vec<_> = (0..64)
        .map(|id| supervisor.spawn(id, id).unwrap())
        .collect();
    // Two of them in their back-off.
    for address in &addresses[..2] {
        assert_eq!(
            soon(address.ask(0, Order::Panic(0)).unwrap()).await,
            Err(ReplyLost)
        );
    }
    assert_eq!(soon(supervisor.stop_all()).await, 0);
    assert_eq!(supervisor.n_actors(), 0);
    assert_eq!(shared.stopped.load(Ordering::Relaxed), 62);
    assert_eq!(shared.dropped.load(Ordering::Relaxed), 64);
    assert!(matches!(
        supervisor.spawn(99, 0),
        Err(Error::SupervisorEnded { .. })
    ));
    drop(supervisor);
    let mut n_stopped = 0;
    while let Some(event) = next(&mut events).await {
        n_stopped += usize::from(matches!(event, LifecycleEvent::Stopped { .. }));
    }
    assert_eq!(
        n_stopped, 64,
        "each end is reported once, then the stream ends"
    );
}

#[tokio::test(start_paused = true)]
async fn supervisor_drop_stops_its_actors() {
    let (supervisor, mut events, shared) = supervise(inline(Restart::Permanent));
    let adder = supervisor.spawn(1, 0).unwrap();
    soon(adder.ask(0, Order::Add(1)).unwrap()).await.unwrap();
    drop(supervisor);
    assert_eq!(
        lines(&mut events, 2).await,
        [
            "Actor 1 has started.",
            "Actor 1 has stopped, as it was told."
        ]
    );
    assert_eq!(shared.stopped.load(Ordering::Relaxed), 1);
}

#[tokio::test(start_paused = true)]
async fn events_without_a_reader_are_counted_and_the_newest_kept() {
    let (supervisor, mut events, _) = supervise(Config {
        event_capacity: count(2),
        ..inline(Restart::Permanent)
    });
    for id in 0..10 {
        supervisor.spawn(id, 0).unwrap();
    }
    sleep(Duration::from_millis(1)).await;
    assert_eq!(events.dropped(), 8);
    assert_eq!(
        lines(&mut events, 2).await,
        ["Actor 8 has started.", "Actor 9 has started."]
    );
}
