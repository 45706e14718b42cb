//! Actors with handlers on the worker pool, on real threads in real time.

use std::sync::atomic::Ordering;
use std::sync::{Arc, mpsc};
use std::time::{Duration, Instant};

use crate::adder_fixture::{
    Adder, AdderCounters, Order, WATCHDOG, config, count, lines, next, soon,
};
use actor::{
    Cause, Events, JobLost, LifecycleEvent, Placement, PoolConfig, ReplyLost, Restart, StopReason,
    Supervisor, WorkerPool,
};
use tokio::runtime::Handle;

const STALL: Duration = Duration::from_secs(3600);

/// Pool that stalls only on request: an hour passes in [`let_stall`].
fn pool(n_workers: usize, max_abandoned: usize) -> WorkerPool {
    WorkerPool::start(PoolConfig {
        name: "test".to_owned(),
        n_workers: count(n_workers),
        stall_after: STALL,
        max_abandoned: count(max_abandoned),
    })
    .expect("threads are there")
}

/// Lets the stall time pass; returns the number of workers abandoned.
fn let_stall(pool: &WorkerPool) -> usize {
    let now = Instant::now();
    pool.check(now) + pool.check(now + STALL)
}

type Adders = Supervisor<u64, Adder>;

fn supervise(pool: &WorkerPool, shutdown: Duration) -> (Adders, Events<u64>, Arc<AdderCounters>) {
    let shared = Arc::new(AdderCounters::default());
    let mut config = config(Restart::Permanent, Placement::Pool(pool.clone()));
    config.shutdown = shutdown;
    let (supervisor, events) = Supervisor::new(config, Arc::clone(&shared), Handle::current());
    (supervisor, events, shared)
}

/// Order that hangs; signals its begin on the first channel, ends with the second.
fn hang() -> (Order, mpsc::Receiver<()>, mpsc::Sender<()>) {
    let (tell, begun) = mpsc::channel();
    let (gate, opened) = mpsc::channel();
    (Order::Hang(tell, opened), begun, gate)
}

/// Awaits the start of a handler without blocking the thread of the actors' tasks.
async fn begun(signal: mpsc::Receiver<()>) {
    let waiting = tokio::task::spawn_blocking(move || signal.recv_timeout(WATCHDOG));
    waiting
        .await
        .expect("it does not panic")
        .expect("the watchdog barked");
}

#[tokio::test]
async fn panic_on_the_pool_affects_only_its_actor() {
    let pool = pool(2, 1);
    let (supervisor, mut events, _) = supervise(&pool, WATCHDOG);
    let victim = supervisor.spawn(1, 0).unwrap();
    assert_eq!(soon(victim.ask(1, Order::Add(5)).unwrap()).await, Ok(5));
    let neighbour = supervisor.spawn(2, 0).unwrap();
    assert_eq!(
        soon(victim.ask(2, Order::Panic(7)).unwrap()).await,
        Err(ReplyLost)
    );
    assert_eq!(soon(neighbour.ask(3, Order::Add(1)).unwrap()).await, Ok(1));
    assert_eq!(soon(victim.ask(4, Order::Add(1)).unwrap()).await, Ok(6));
    assert_eq!(pool.n_abandoned(), 0);
    let reports = lines(&mut events, 4).await;
    let restart = "Actor 1 starts again after 50 ms, because it panicked: at 12 \
                   (at message 2, which is lost)."
        .to_owned();
    assert!(reports.contains(&restart), "{reports:?}");
}

#[tokio::test]
async fn stalled_handler_costs_one_message_and_one_thread() {
    let pool = pool(1, 2);
    let (supervisor, mut events, _) = supervise(&pool, WATCHDOG);
    let adder = supervisor.spawn(1, 10).unwrap();
    let (order, signal, gate) = hang();
    let lost = adder.ask(1, order).unwrap();
    begun(signal).await;
    assert_eq!(let_stall(&pool), 1);
    assert_eq!(soon(lost).await, Err(ReplyLost));
    assert_eq!(soon(adder.ask(2, Order::Add(1)).unwrap()).await, Ok(11));
    next(&mut events).await;
    assert!(matches!(
        next(&mut events).await,
        Some(LifecycleEvent::Restarting {
            cause: Cause::ReplyLost(JobLost::Stalled),
            tag: Some(1),
            ..
        })
    ));
    drop(gate);
}

#[tokio::test]
async fn exhausted_pool_resolves_all_pending_answers() {
    let pool = pool(1, 1);
    let (supervisor, mut events, _) = supervise(&pool, WATCHDOG);
    let stuck = supervisor.spawn(1, 0).unwrap();
    let other = supervisor.spawn(2, 0).unwrap();
    assert_eq!(soon(other.ask(0, Order::Add(1)).unwrap()).await, Ok(1));
    let (order, signal, gate) = hang();
    let lost = stuck.ask(1, order).unwrap();
    begun(signal).await;
    let queued = other.ask(2, Order::Add(1)).unwrap();
    assert_eq!(let_stall(&pool), 1);
    soon(pool.exhausted()).await;
    assert_eq!(soon(lost).await, Err(ReplyLost));
    assert_eq!(soon(queued).await, Err(ReplyLost));
    // Both fail repeatedly until the policy ends it.
    while let Some(event) = next(&mut events).await {
        if let LifecycleEvent::Restarting {
            cause: Cause::ReplyLost(JobLost::Exhausted),
            ..
        } = event
        {
            break;
        }
    }
    assert_eq!(soon(supervisor.stop_all()).await, 0);
    drop(gate);
}

#[tokio::test]
async fn stop_finishes_the_current_message() {
    let pool = pool(1, 1);
    let (supervisor, mut events, shared) = supervise(&pool, WATCHDOG);
    let adder = supervisor.spawn(1, 0).unwrap();
    let (order, signal, gate) = hang();
    let at_work = adder.ask(1, order).unwrap();
    let frame = Arc::new(());
    let waiting = adder
        .ask(2, Order::AddHolding(1, Arc::clone(&frame)))
        .unwrap();
    begun(signal).await;
    assert!(supervisor.request_stop(&1));
    assert_eq!(Arc::strong_count(&frame), 1);
    assert_eq!(soon(waiting).await, Err(ReplyLost));
    drop(gate);
    assert_eq!(soon(at_work).await, Ok(1));
    assert!(soon(supervisor.stop(&1)).await);
    assert_eq!(shared.stopped.load(Ordering::Relaxed), 1);
    assert_eq!(
        lines(&mut events, 2).await,
        [
            "Actor 1 has started.",
            "Actor 1 has stopped, as it was told."
        ]
    );
}

#[tokio::test]
async fn stop_all_abandons_a_hanging_handler_after_the_time_limit() {
    let pool = pool(2, 1);
    let (supervisor, mut events, shared) = supervise(&pool, Duration::from_millis(50));
    let stuck = supervisor.spawn(1, 0).unwrap();
    let healthy = supervisor.spawn(2, 0).unwrap();
    assert_eq!(soon(healthy.ask(0, Order::Add(1)).unwrap()).await, Ok(1));
    let (order, signal, gate) = hang();
    let lost = stuck.ask(1, order).unwrap();
    begun(signal).await;
    soon(supervisor.stop_all()).await;
    assert_eq!(soon(lost).await, Err(ReplyLost));
    assert_eq!(supervisor.n_actors(), 0);
    assert_eq!(shared.stopped.load(Ordering::Relaxed), 1, "the healthy one");
    drop(supervisor);
    let mut ends = Vec::new();
    while let Some(event) = next(&mut events).await {
        if !matches!(event, LifecycleEvent::Started { .. }) {
            ends.push(event.to_string());
        }
    }
    ends.sort();
    assert_eq!(
        ends,
        [
            "Actor 1 did not stop within the shutdown time and was left behind.",
            "Actor 2 has stopped, as it was told."
        ],
        "each end once"
    );
    drop(gate);
}

#[tokio::test]
async fn dismiss_abandons_a_hanging_handler() {
    let pool = pool(1, 1);
    let (supervisor, mut events, _) = supervise(&pool, Duration::from_millis(50));
    let stuck = supervisor.spawn(1, 0).unwrap();
    let (order, signal, gate) = hang();
    let lost = stuck.ask(1, order).unwrap();
    begun(signal).await;
    supervisor.request_stop(&1);
    assert_eq!(soon(lost).await, Err(ReplyLost));
    assert_eq!(
        lines(&mut events, 2).await,
        [
            "Actor 1 has started.",
            "Actor 1 did not stop within the shutdown time and was left behind."
        ]
    );
    drop(gate);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn stop_all_is_not_delayed_by_a_hanging_inline_handler() {
    let shared = Arc::new(AdderCounters::default());
    let mut config = config(Restart::Permanent, Placement::Inline);
    config.shutdown = Duration::from_millis(50);
    let (supervisor, mut events): (Adders, _) =
        Supervisor::new(config, Arc::clone(&shared), Handle::current());
    let stuck = supervisor.spawn(1, 0).unwrap();
    let (order, signal, gate) = hang();
    let answer = stuck.ask(1, order).unwrap();
    begun(signal).await;
    assert_eq!(soon(supervisor.stop_all()).await, 1);
    drop(gate);
    assert_eq!(soon(answer).await, Ok(1), "late, but not lost");
    drop(supervisor);
    assert_eq!(
        lines(&mut events, 2).await,
        [
            "Actor 1 has started.",
            "Actor 1 did not stop within the shutdown time and was left behind."
        ]
    );
    assert!(
        next(&mut events).await.is_none(),
        "its end is reported once"
    );
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn lockstep_frames_are_answered_by_sixty_four_actors() {
    const N_FRAMES: u64 = 250;
    let pool = pool(3, 1);
    let (supervisor, mut events, _) = supervise(&pool, WATCHDOG);
    let actors: Vec<_> = (0..64).map(|id| supervisor.spawn(id, 0).unwrap()).collect();
    let mut totals = [0_u64; 64];
    for frame in 1..=N_FRAMES {
        let fails = |id: u64| id % 16 == 3 && frame % 100 == 0;
        let asked = actors.iter().zip(0_u64..).map(|(actor, id)| {
            let order = if fails(id) {
                Order::Panic(frame)
            } else {
                Order::Add(frame)
            };
            (id, actor.ask(frame, order).unwrap())
        });
        let asked: Vec<_> = asked.collect();
        for (id, answer) in asked {
            let total = &mut totals[id as usize];
            let expected = if fails(id) {
                Err(ReplyLost)
            } else {
                Ok(*total + frame)
            };
            assert_eq!(soon(answer).await, expected, "actor {id}, frame {frame}");
            *total = expected.unwrap_or(*total);
        }
    }
    assert_eq!(soon(supervisor.stop_all()).await, 0);
    drop(supervisor);
    let (mut n_restarts, mut n_stops) = (0, 0);
    while let Some(event) = next(&mut events).await {
        n_restarts += usize::from(matches!(event, LifecycleEvent::Restarting { .. }));
        let stop = matches!(
            event,
            LifecycleEvent::Stopped {
                reason: StopReason::Requested,
                ..
            }
        );
        n_stops += usize::from(stop);
    }
    assert_eq!((n_restarts, n_stops), (8, 64));
    assert!(actors.iter().all(|actor| actor.n_dropped() == 0));
}
