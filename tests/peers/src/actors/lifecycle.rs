//! Life-cycle benchmark of an actor group: spawn, first message, steady state, stop, idle memory.

use crate::adder_group::AdderGroup;
use crate::counting_allocator;
use std::hint::black_box;
use std::time::Instant;
use tokio::runtime::{Builder, Runtime};

/// Number of steady-state rounds per group. Chosen.
const N_STEADY_ROUNDS: usize = 20;

/// Costs of the life cycle of a group, per actor or message.
#[derive(Clone, Copy)]
pub struct LifecycleCosts {
    /// Spawn call, nanoseconds per actor.
    pub spawn_ns: f64,
    /// First request-reply round with the start of the actors, nanoseconds per actor.
    pub first_ns: f64,
    /// Later request-reply rounds, nanoseconds per message.
    pub steady_ns: f64,
    /// Stop until termination, nanoseconds per actor.
    pub stop_ns: f64,
    /// Heap after the first message, bytes per actor.
    pub idle_bytes: f64,
}

/// Single-threaded tokio runtime, which excludes the jitter of waking other threads.
fn runtime() -> Runtime {
    Builder::new_current_thread()
        .enable_time()
        .build()
        .expect("a tokio runtime")
}

/// Measures one life cycle of a group of `n` actors.
pub fn measure_lifecycle<G: AdderGroup>(n: usize) -> LifecycleCosts {
    runtime().block_on(async {
        let per = |begin: Instant, count: usize| begin.elapsed().as_nanos() as f64 / count as f64;
        let bytes = counting_allocator::in_use();
        let begin = Instant::now();
        let mut group = G::spawn(n);
        let spawn_ns = per(begin, n);
        let begin = Instant::now();
        black_box(group.round().await);
        let first_ns = per(begin, n);
        let idle_bytes = (counting_allocator::in_use() - bytes) as f64 / n as f64;
        let begin = Instant::now();
        for _ in 0..N_STEADY_ROUNDS {
            black_box(group.round().await);
        }
        let steady_ns = per(begin, n * N_STEADY_ROUNDS);
        let begin = Instant::now();
        group.stop().await;
        LifecycleCosts {
            spawn_ns,
            first_ns,
            steady_ns,
            stop_ns: per(begin, n),
            idle_bytes,
        }
    })
}

/// Median of each cost over several life cycles.
pub fn median(costs: &[LifecycleCosts]) -> LifecycleCosts {
    let of = |figure: fn(&LifecycleCosts) -> f64| {
        let mut figures: Vec<f64> = costs.iter().map(figure).collect();
        figures.sort_by(f64::total_cmp);
        figures[figures.len() / 2]
    };
    LifecycleCosts {
        spawn_ns: of(|costs| costs.spawn_ns),
        first_ns: of(|costs| costs.first_ns),
        steady_ns: of(|costs| costs.steady_ns),
        stop_ns: of(|costs| costs.stop_ns),
        idle_bytes: of(|costs| costs.idle_bytes),
    }
}
