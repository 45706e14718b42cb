//! Benchmark of spawning many actors at once, each with a first message, until all
//! answers are there.
//!
//! On two reactor threads and two workers, as the perception process has them.
//! `spawn` is the call alone, after which the frame continues; `first_answer` lasts
//! until the last of the answers is there.

mod adder;

use std::sync::Arc;
use std::time::Duration;

use actor::{Config, Placement, Restart, RestartPolicy, Supervisor, WorkerPool};
use adder::{Adder, count, pool};
use divan::Bencher;
use divan::counter::ItemsCount;
use tokio::runtime::{Builder, Runtime};

const N_ACTORS: [u64; 3] = [10, 50, 200];

fn main() {
    divan::main();
}

fn runtime() -> Runtime {
    Builder::new_multi_thread()
        .worker_threads(2)
        .enable_time()
        .build()
        .expect("a runtime")
}

fn supervisor(runtime: &Runtime, pool: &WorkerPool) -> Supervisor<u64, Adder> {
    let [least, most] = [50, 1000].map(Duration::from_millis);
    let config = Config {
        restart: Restart::Transient,
        policy: RestartPolicy::new(30, Duration::from_secs(60), least, most)
            .expect("a valid policy"),
        placement: Placement::Pool(pool.clone()),
        mailbox_capacity: count(1),
        shutdown: Duration::from_secs(2),
        event_capacity: count(1024),
    };
    Supervisor::new(config, Arc::new(()), runtime.handle().clone()).0
}

#[divan::bench(args = N_ACTORS)]
fn spawn(bencher: Bencher, n: u64) {
    let (runtime, pool) = (runtime(), pool());
    bencher
        .counter(ItemsCount::new(n))
        .with_inputs(|| supervisor(&runtime, &pool))
        .bench_local_values(|supervisor| {
            for id in 0..n {
                divan::black_box(supervisor.spawn(id, 0).expect("a new id"));
            }
            supervisor
        });
}

#[divan::bench(args = N_ACTORS)]
fn first_answer(bencher: Bencher, n: u64) {
    let (runtime, pool) = (runtime(), pool());
    bencher
        .counter(ItemsCount::new(n))
        .with_inputs(|| supervisor(&runtime, &pool))
        .bench_local_values(|supervisor| {
            runtime.block_on(async {
                let actors: Vec<_> = (0..n)
                    .map(|id| supervisor.spawn(id, 0).expect("a new id"))
                    .collect();
                let answers: Vec<_> = actors
                    .iter()
                    .map(|actor| actor.ask(0, 1).expect("it lives"))
                    .collect();
                for answer in answers {
                    divan::black_box(answer.await.expect("it answers"));
                }
            });
            supervisor
        });
}
