//! The four figures and the memory of one system at one size.

use crate::allocation;
use crate::crew::Crew;
use std::hint::black_box;
use std::time::Instant;
use tokio::runtime::{Builder, Runtime};

/// Steady rounds for each life of a crew.
const N_STEADY: usize = 20;

/// The figures of one crew's life, for one actor (or message).
#[derive(Clone, Copy)]
pub struct Life {
    pub spawn_ns: f64,
    pub first_ns: f64,
    pub steady_ns: f64,
    pub stop_ns: f64,
    pub idle_bytes: f64,
}

/// One reactor thread, so that the figures are costs, not the luck of waking.
fn runtime() -> Runtime {
    Builder::new_current_thread()
        .enable_time()
        .build()
        .expect("a runtime")
}

/// A whole life of a crew of `n`.
pub fn live<C: Crew>(n: usize) -> Life {
    runtime().block_on(async {
        let per = |begin: Instant, count: usize| begin.elapsed().as_nanos() as f64 / count as f64;
        let bytes = allocation::in_use();
        let begin = Instant::now();
        let mut crew = C::spawn(n);
        let spawn_ns = per(begin, n);
        let begin = Instant::now();
        black_box(crew.round().await);
        let first_ns = per(begin, n);
        let idle_bytes = (allocation::in_use() - bytes) as f64 / n as f64;
        let begin = Instant::now();
        for _ in 0..N_STEADY {
            black_box(crew.round().await);
        }
        let steady_ns = per(begin, n * N_STEADY);
        let begin = Instant::now();
        crew.stop().await;
        Life {
            spawn_ns,
            first_ns,
            steady_ns,
            stop_ns: per(begin, n),
            idle_bytes,
        }
    })
}

/// The median of each figure over several lives.
pub fn median(lives: &[Life]) -> Life {
    let of = |figure: fn(&Life) -> f64| {
        let mut figures: Vec<f64> = lives.iter().map(figure).collect();
        figures.sort_by(f64::total_cmp);
        figures[figures.len() / 2]
    };
    Life {
        spawn_ns: of(|life| life.spawn_ns),
        first_ns: of(|life| life.first_ns),
        steady_ns: of(|life| life.steady_ns),
        stop_ns: of(|life| life.stop_ns),
        idle_bytes: of(|life| life.idle_bytes),
    }
}
