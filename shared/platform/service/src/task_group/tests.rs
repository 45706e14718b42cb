use super::*;
use std::sync::{Arc, Mutex};

/// Far beyond any healthy run.
const WATCHDOG: Duration = Duration::from_secs(20);
const LONG: Duration = Duration::from_secs(10);

fn group() -> TaskGroup {
    TaskGroup::new(LONG)
}

async fn never() -> Result<(), Failure> {
    std::future::pending().await
}

/// Future that panics with an owned message or with a literal.
async fn panicking(is_formatted: bool) {
    let n = std::future::ready(7).await;
    assert!(!is_formatted, "frame {n}");
    panic!("frame 7");
}

async fn failure_of(tasks: TaskGroup) -> Failure {
    let outcome = tokio::time::timeout(WATCHDOG, tasks.run(never())).await;
    outcome.expect("the group hangs").unwrap_err()
}

#[tokio::test]
async fn task_that_returns_before_shutdown_is_a_failure() {
    let mut tasks = group();
    tasks.spawn("server", std::future::pending::<()>());
    tasks.spawn("outbox sender", async {});
    let failure = failure_of(tasks).await;
    assert_eq!(failure.code, exit_code::FAILURE);
    assert_eq!(
        failure.sentence,
        "the task \"outbox sender\" has ended before shutdown"
    );
}

#[tokio::test]
async fn task_that_fails_gives_its_reason_and_exit_code() {
    for (code, expected) in [
        (exit_code::USAGE, exit_code::USAGE),
        (0, exit_code::FAILURE),
    ] {
        let mut tasks = group();
        tasks.spawn("replica", std::future::pending::<()>());
        tasks.spawn_stoppable("store", move |_| async move {
            Err::<(), _>(Failure::new(code, "the disk is full"))
        });
        let failure = failure_of(tasks).await;
        assert_eq!(failure.code, expected);
        assert_eq!(
            failure.sentence,
            "the task \"store\" has failed: the disk is full"
        );
    }
}

#[tokio::test]
async fn task_that_panics_is_a_failure_with_its_message() {
    for is_formatted in [false, true] {
        let mut tasks = group();
        tasks.spawn("server", panicking(is_formatted));
        let failure = failure_of(tasks).await;
        assert_eq!(failure.code, exit_code::FAILURE);
        assert_eq!(
            failure.sentence,
            "the task \"server\" has panicked: frame 7"
        );
    }
}

#[tokio::test]
async fn shutdown_stops_the_last_task_first() {
    let order = Arc::new(Mutex::new(Vec::new()));
    let (trigger, shutdown) = Shutdown::new();
    let mut tasks = group();
    for name in ["first", "second", "third"] {
        let order = order.clone();
        tasks.spawn_stoppable(name, |stop| async move {
            stop.requested().await;
            order.lock().unwrap().push(name);
        });
    }
    tasks.spawn("dropped", std::future::pending::<()>());
    trigger.request();
    let stopped = tokio::time::timeout(WATCHDOG, tasks.run_until(&shutdown)).await;
    stopped.expect("the group hangs").unwrap();
    assert_eq!(*order.lock().unwrap(), ["third", "second", "first"]);
}

#[tokio::test]
async fn unexpected_end_stops_the_others() {
    let is_stopped = Arc::new(Mutex::new(false));
    let mut tasks = group();
    let flag = is_stopped.clone();
    tasks.spawn_stoppable("server", |stop| async move {
        stop.requested().await;
        *flag.lock().unwrap() = true;
    });
    tasks.spawn("short", async {});
    assert!(failure_of(tasks).await.sentence.contains("short"));
    assert!(*is_stopped.lock().unwrap());
}

#[tokio::test]
async fn task_that_does_not_stop_is_abandoned_after_the_time_limit() {
    let (trigger, shutdown) = Shutdown::new();
    let mut tasks = TaskGroup::new(Duration::from_millis(20));
    tasks.spawn_stoppable("deaf", |_| std::future::pending::<()>());
    tasks.spawn_stoppable("good", |stop| async move { stop.requested().await });
    trigger.request();
    let stopped = tokio::time::timeout(WATCHDOG, tasks.run_until(&shutdown)).await;
    assert_eq!(stopped.expect("the group hangs"), Ok(()));
}

#[tokio::test]
async fn failure_while_stopping_is_the_outcome() {
    let (trigger, shutdown) = Shutdown::new();
    let mut tasks = group();
    tasks.spawn_stoppable("store", |stop| async move {
        stop.requested().await;
        Err::<(), _>(Failure::new(exit_code::FAILURE, "not flushed"))
    });
    tasks.spawn_stoppable("server", |stop| async move { stop.requested().await });
    trigger.request();
    let failure = tasks.run_until(&shutdown).await.unwrap_err();
    assert_eq!(
        failure.sentence,
        "the task \"store\" has failed: not flushed"
    );
}

#[tokio::test]
async fn end_of_the_main_future_stops_the_group_and_is_its_outcome() {
    let mut tasks = group();
    tasks.spawn("server", std::future::pending::<()>());
    assert_eq!(tasks.run(async { Ok(7) }).await, Ok(7));
    let failure = Failure::new(exit_code::REFUSED, "too many restarts");
    let mut tasks = group();
    tasks.spawn("server", std::future::pending::<()>());
    let main = async { Err::<(), _>(failure.clone()) };
    assert_eq!(tasks.run(main).await, Err(failure.clone()));
}
