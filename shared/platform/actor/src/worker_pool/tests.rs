use std::sync::mpsc;

use tokio::runtime::{Builder, Runtime};
use tokio::time::timeout;

use super::*;

const STALL: Duration = Duration::from_secs(1);
/// Watchdog of a test, far beyond any healthy run.
const WATCHDOG: Duration = Duration::from_secs(60);

fn pool(n_workers: usize, max_abandoned: usize) -> WorkerPool {
    WorkerPool::start(PoolConfig {
        name: "test".to_owned(),
        n_workers: NonZeroUsize::new(n_workers).unwrap(),
        stall_after: STALL,
        max_abandoned: NonZeroUsize::new(max_abandoned).unwrap(),
    })
    .unwrap()
}

fn runtime() -> Runtime {
    Builder::new_current_thread().enable_time().build().unwrap()
}

fn wait<T>(future: impl Future<Output = T>) -> T {
    runtime().block_on(async { timeout(WATCHDOG, future).await.expect("the test hangs") })
}

/// Running job that hangs until its gate is dropped or makes it tick.
struct Hung<F> {
    result: F,
    gate: mpsc::Sender<()>,
    ticked: mpsc::Receiver<()>,
    /// Resource shared with the job: its count shows how long the job holds it.
    resource: Arc<()>,
}

fn hang(pool: &WorkerPool) -> Hung<impl Future<Output = Result<&'static str, JobLost>> + use<>> {
    let (gate, ticks) = mpsc::channel::<()>();
    let (tell, ticked) = mpsc::channel();
    let resource = Arc::new(());
    let held = Arc::clone(&resource);
    let result = pool.run(move |progress| {
        tell.send(()).unwrap();
        while ticks.recv().is_ok() {
            progress.tick();
            tell.send(()).unwrap();
        }
        drop(held);
        "late"
    });
    ticked.recv_timeout(WATCHDOG).unwrap();
    Hung {
        result,
        gate,
        ticked,
        resource,
    }
}

impl<F> Hung<F> {
    fn tick(&self) {
        self.gate.send(()).unwrap();
        self.ticked.recv_timeout(WATCHDOG).unwrap();
    }
}

#[test]
fn a_job_runs_on_a_named_thread_and_its_result_comes_back() {
    let pool = pool(1, 1);
    let name = wait(pool.run(|_| thread::current().name().map(str::to_owned)));
    assert_eq!(name, Ok(Some("test-0".to_owned())));
}

#[test]
fn panic_is_the_error_of_its_job_only() {
    let pool = pool(1, 1);
    let lost = wait(pool.run(|_| panic!("voxel {}", 7)));
    assert_eq!(lost, Err::<(), _>(JobLost::Panicked("voxel 7".to_owned())));
    assert_eq!(wait(pool.run(|_| "still here")), Ok("still here"));
    assert_eq!(pool.n_abandoned(), 0);
}

#[test]
fn cancelled_job_is_not_begun() {
    let pool = pool(1, 1);
    let busy = hang(&pool);
    let resource = Arc::new(());
    let held = Arc::clone(&resource);
    let unwanted = pool.run(move |_| drop(held));
    drop(unwanted);
    assert_eq!(
        Arc::strong_count(&resource),
        1,
        "returned before the worker is free"
    );
    drop(busy.gate);
    assert_eq!(wait(busy.result), Ok("late"));
}

#[test]
fn stalled_workers_are_replaced_until_the_pool_is_exhausted() {
    let pool = pool(1, 2);
    let start = Instant::now();
    pool.check(start);

    let first = hang(&pool);
    assert_eq!(pool.check(start + STALL / 2), 0, "beginning was progress");
    assert_eq!(pool.check(start + STALL), 0);
    assert_eq!(pool.check(start + STALL * 3 / 2), 1);
    assert_eq!(wait(first.result), Err(JobLost::Stalled));
    assert_eq!((pool.n_abandoned(), pool.is_exhausted()), (1, false));
    let successor = wait(pool.run(|_| thread::current().name().map(str::to_owned)));
    assert_eq!(successor, Ok(Some("test-1".to_owned())));

    let second = hang(&pool);
    let queued = pool.run(|_| "never");
    for quarter in 6..12 {
        pool.check(start + STALL * quarter / 4);
    }
    assert_eq!(wait(second.result), Err(JobLost::Stalled));
    assert_eq!(wait(queued), Err(JobLost::Exhausted));
    wait(pool.exhausted());
    assert_eq!((pool.n_abandoned(), pool.is_exhausted()), (2, true));
    assert_eq!(wait(pool.run(|_| "never")), Err(JobLost::Exhausted));
}

#[test]
fn a_slow_worker_that_ticks_is_left_alone() {
    let pool = pool(1, 1);
    let slow = hang(&pool);
    let start = Instant::now();
    for half in 0..40 {
        slow.tick();
        assert_eq!(pool.check(start + STALL * half / 2), 0);
    }
    drop(slow.gate);
    assert_eq!(wait(slow.result), Ok("late"));
}

#[test]
fn stall_time_can_be_replaced_while_a_job_runs() {
    let pool = pool(1, 2);
    let start = Instant::now();
    pool.check(start);
    let hung = hang(&pool);
    assert_eq!(pool.check(start + STALL / 2), 0);
    pool.set_stall_after(STALL / 4);
    // A gap longer than the new time proves nothing.
    assert_eq!(pool.check(start + STALL * 4 / 5), 0);
    assert_eq!(pool.check(start + STALL * 9 / 10), 0);
    assert_eq!(pool.check(start + STALL * 21 / 20), 1);
    assert_eq!(wait(hung.result), Err(JobLost::Stalled));
}

#[test]
fn an_idle_worker_is_never_stalled() {
    let pool = pool(2, 1);
    assert_eq!(wait(pool.run(|_| ())), Ok(()));
    let start = Instant::now();
    let n_stalled: usize = (0..40)
        .map(|half| pool.check(start + STALL * half / 2))
        .sum();
    assert_eq!(n_stalled, 0);
}

#[test]
fn watchdog_ignores_a_gap_between_checks() {
    let pool = pool(1, 1);
    let hung = hang(&pool);
    let start = Instant::now();
    assert_eq!(pool.check(start), 0);
    assert_eq!(
        pool.check(start + 100 * STALL),
        0,
        "the process may have been stopped"
    );
    assert_eq!(pool.check(start + 101 * STALL), 1);
    assert_eq!(wait(hung.result), Err(JobLost::Stalled));
}

#[test]
fn an_abandoned_thread_that_moves_again_returns_what_it_held_and_ends() {
    let pool = pool(1, 3);
    let hung = hang(&pool);
    let start = Instant::now();
    pool.check(start);
    assert_eq!(pool.check(start + STALL), 1);
    assert_eq!(wait(hung.result), Err(JobLost::Stalled));
    assert_eq!(Arc::strong_count(&hung.resource), 2);
    drop(hung.gate);
    // The job's end of this channel is dropped with it.
    assert!(hung.ticked.recv_timeout(WATCHDOG).is_err());
    assert_eq!(Arc::strong_count(&hung.resource), 1);
    assert_eq!(pool.check(start + STALL * 3 / 2), 0);
    for _ in 0..20 {
        let name = wait(pool.run(|_| thread::current().name().map(str::to_owned)));
        assert_eq!(name, Ok(Some("test-1".to_owned())), "it takes no more jobs");
    }
}

#[test]
fn unwanted_result_with_a_panicking_drop_spares_the_worker() {
    struct Bomb;
    impl Drop for Bomb {
        fn drop(&mut self) {
            panic!("unwanted");
        }
    }
    let pool = pool(1, 1);
    let (gate, opened) = mpsc::channel::<()>();
    let (tell, begun) = mpsc::channel();
    let unwanted = pool.run(move |_| {
        tell.send(()).unwrap();
        let _ = opened.recv();
        Bomb
    });
    begun.recv_timeout(WATCHDOG).unwrap();
    drop(unwanted);
    drop(gate);
    assert_eq!(wait(pool.run(|_| "still here")), Ok("still here"));
}

#[test]
fn the_watchdog_thread_finds_a_stalled_worker_by_itself() {
    let pool = WorkerPool::start(PoolConfig {
        name: "watched".to_owned(),
        n_workers: NonZeroUsize::MIN,
        stall_after: Duration::from_millis(40),
        max_abandoned: NonZeroUsize::MIN,
    })
    .unwrap();
    pool.start_watchdog().unwrap();
    let hung = hang(&pool);
    assert_eq!(wait(hung.result), Err(JobLost::Stalled));
    wait(pool.exhausted());
}

#[test]
fn the_last_handle_lets_queued_jobs_finish() {
    let pool = pool(1, 1);
    let results: Vec<_> = (0..20).map(|n| pool.run(move |_| n)).collect();
    drop(pool);
    for (n, result) in results.into_iter().enumerate() {
        assert_eq!(wait(result), Ok(n));
    }
}

/// Counts to a number in a fork-join; returns how many threads took part.
fn count_together(team: &ForkJoin, n_steps: usize) -> usize {
    let (next, threads) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    team.run(&|| {
        while next.fetch_add(1, Ordering::Relaxed) < n_steps {
            let mut threads = threads.lock();
            if !threads.contains(&thread::current().id()) {
                threads.push(thread::current().id());
            }
            drop(threads);
            thread::sleep(Duration::from_millis(1));
        }
    });
    let n_threads = threads.lock().len();
    assert!(next.into_inner() >= n_steps);
    n_threads
}

#[test]
fn fork_join_uses_idle_workers() {
    for n_workers in [1, 3] {
        let pool = pool(n_workers, 1);
        let team = pool.fork_join();
        // Each of the other workers needs a moment to wake up.
        let n_threads = wait(pool.run(move |_| count_together(&team, 1_000)));
        assert_eq!(n_threads, Ok(n_workers));
    }
}

#[test]
fn fork_join_does_not_wait_for_busy_workers() {
    let pool = pool(2, 1);
    let busy = hang(&pool);
    let team = pool.fork_join();
    assert_eq!(wait(pool.run(move |_| count_together(&team, 10))), Ok(1));
    drop(busy.gate);
    assert_eq!(wait(busy.result), Ok("late"));
}

#[test]
fn fork_join_helper_that_stalls_loses_the_leaders_job() {
    let pool = pool(2, 3);
    let start = Instant::now();
    pool.check(start);
    let (gate, opened) = mpsc::channel::<()>();
    let (tell, inside) = mpsc::channel();
    let (team, opened) = (pool.fork_join(), Mutex::new(opened));
    let led = pool.run(move |_| {
        team.run(&|| {
            tell.send(()).unwrap();
            let _ = opened.lock().recv();
        });
    });
    for _ in 0..2 {
        inside.recv_timeout(WATCHDOG).unwrap();
    }
    pool.check(start + STALL / 2);
    pool.check(start + STALL);
    assert_eq!(pool.check(start + STALL * 3 / 2), 2);
    assert_eq!(wait(led), Err(JobLost::Stalled));
    assert_eq!(wait(pool.run(|_| "a successor")), Ok("a successor"));
    drop(gate);
    assert_eq!(wait(pool.run(|_| "still there")), Ok("still there"));
}

#[test]
fn fork_join_leader_panic_waits_for_the_helpers() {
    let pool = pool(2, 1);
    let team = Arc::new(pool.fork_join());
    let leaders = Arc::clone(&team);
    let (tell, inside) = mpsc::channel();
    let n_inside = Arc::new(AtomicUsize::new(0));
    let still_inside = Arc::clone(&n_inside);
    let led = pool.run(move |_| {
        let leader = thread::current().id();
        let inside = Mutex::new(inside);
        leaders.run(&|| {
            if thread::current().id() == leader {
                let _ = inside.lock().recv_timeout(WATCHDOG);
                panic!("the leader");
            }
            n_inside.fetch_add(1, Ordering::Relaxed);
            tell.send(()).unwrap();
            thread::sleep(Duration::from_millis(50));
            n_inside.fetch_sub(1, Ordering::Relaxed);
        });
    });
    assert_eq!(wait(led), Err(JobLost::Panicked("the leader".to_owned())));
    assert_eq!(still_inside.load(Ordering::Relaxed), 0);
    assert_eq!(wait(pool.run(move |_| count_together(&team, 1_000))), Ok(2));
}
