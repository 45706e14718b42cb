//! Benchmark of message round trips and spawning of actors, inline and on the pool.
//!
//! Each figure is for one round over all actors of the argument; divan's item
//! throughput is actors (or messages) per second. `tests/peers` compares inline
//! actors with bare tasks and with other libraries.

mod adder;

use std::sync::Arc;
use std::time::Duration;

use actor::{Address, Config, Placement, Restart, RestartPolicy, Supervisor};
use adder::{Adder, count};
use divan::Bencher;
use divan::counter::ItemsCount;
use tokio::runtime::{Builder, Runtime};

const N_ACTORS: [usize; 2] = [1, 100];
const MAILBOX: usize = 4;

fn main() {
    divan::main();
}

/// Runtime with one reactor thread, so that the figures do not depend on wake-ups
/// across threads.
fn runtime() -> Runtime {
    Builder::new_current_thread()
        .enable_time()
        .build()
        .expect("a runtime")
}

fn supervisor(runtime: &Runtime, placement: Placement) -> Supervisor<u64, Adder> {
    let config = Config {
        restart: Restart::Permanent,
        policy: RestartPolicy::new(
            30,
            Duration::from_secs(60),
            Duration::from_millis(50),
            Duration::from_secs(2),
        )
        .expect("a valid policy"),
        placement,
        mailbox_capacity: count(MAILBOX),
        shutdown: Duration::from_secs(5),
        event_capacity: count(64),
    };
    Supervisor::new(config, Arc::new(()), runtime.handle().clone()).0
}

fn pool() -> Placement {
    Placement::Pool(adder::pool())
}

/// Asks all actors, then awaits all answers, as the frame loop does.
async fn round(actors: &[Address<Adder>], answers: &mut Vec<actor::PendingReply<u64>>) {
    for actor in actors {
        answers.push(actor.ask(0, 1).expect("it lives"));
    }
    for answer in answers.drain(..) {
        divan::black_box(answer.await.expect("it answers"));
    }
}

mod steady_message {
    use super::{Bencher, ItemsCount, N_ACTORS, Placement, round, runtime, supervisor};

    fn ours(bencher: Bencher, n: usize, placement: Placement) {
        let runtime = runtime();
        let supervisor = supervisor(&runtime, placement);
        let actors: Vec<_> = (0..n as u64)
            .map(|id| supervisor.spawn(id, 0).expect("a new id"))
            .collect();
        let mut answers = Vec::with_capacity(n);
        bencher
            .counter(ItemsCount::new(n))
            .bench_local(|| runtime.block_on(round(&actors, &mut answers)));
    }

    #[divan::bench(args = N_ACTORS)]
    fn inline(bencher: Bencher, n: usize) {
        ours(bencher, n, Placement::Inline);
    }

    #[divan::bench(args = N_ACTORS)]
    fn pool(bencher: Bencher, n: usize) {
        ours(bencher, n, super::pool());
    }
}

mod spawn_message_stop {
    use super::{Bencher, ItemsCount, N_ACTORS, Placement, round, runtime, supervisor};

    fn ours(bencher: Bencher, n: usize, placement: &Placement) {
        let runtime = runtime();
        let mut answers = Vec::with_capacity(n);
        bencher.counter(ItemsCount::new(n)).bench_local(|| {
            let supervisor = supervisor(&runtime, placement.clone());
            runtime.block_on(async {
                let actors: Vec<_> = (0..n as u64)
                    .map(|id| supervisor.spawn(id, 0).expect("a new id"))
                    .collect();
                round(&actors, &mut answers).await;
                assert_eq!(supervisor.stop_all().await, 0);
            });
        });
    }

    #[divan::bench(args = N_ACTORS)]
    fn inline(bencher: Bencher, n: usize) {
        ours(bencher, n, &Placement::Inline);
    }

    #[divan::bench(args = N_ACTORS)]
    fn pool(bencher: Bencher, n: usize) {
        ours(bencher, n, &super::pool());
    }
}
