//! Helper threads: idle workers that take part in a parallel detection.

use actor::{ForkJoin, WorkerPool};
use detection::Parallelism;
use message::{Span, Stage};
use parking_lot::Mutex;
use service::{CpuAffinity, Stopwatch, thread_id};

/// Fork-join team with core affinity: keeps helpers off the leader's core. The scheduler
/// often wakes a thread on the core of its waker, where it would interrupt the leader
/// while another core is idle.
#[derive(Debug)]
pub(crate) struct HelperThreads {
    team: ForkJoin,
    /// Core affinity; `None` where the system has none.
    cores: Option<CpuAffinity>,
    placement: Mutex<ThreadPlacement>,
    spans: Mutex<Vec<Span>>,
}

/// Assignment of threads to cores.
#[derive(Debug, Default)]
struct ThreadPlacement {
    /// Thread and core of the leader, off which all other threads are kept.
    leader: Option<(u32, usize)>,
    /// Kernel ids of threads that have led or helped a stage.
    threads: Vec<u32>,
}

impl HelperThreads {
    /// Helper threads of a worker pool.
    pub(crate) fn of(pool: &WorkerPool) -> Self {
        Self {
            team: pool.fork_join(),
            cores: CpuAffinity::of_process().ok(),
            placement: Mutex::default(),
            spans: Mutex::default(),
        }
    }

    /// Appends the trace spans recorded by the helper threads since the last call.
    pub(crate) fn take_spans(&self, spans: &mut Vec<Span>) {
        spans.append(&mut self.spans.lock());
    }

    /// Reserves the core of the calling thread, the leader, by moving the others away.
    fn reserve_core(&self, own: u32) {
        let Some(cores) = &self.cores else { return };
        let leader = (own, CpuAffinity::current());
        let mut placement = self.placement.lock();
        if placement.leader == Some(leader) {
            return;
        }
        // Best effort: on failure the leader keeps its own affinity.
        let _ = cores.restore(own);
        placement.leader = Some(leader);
        // A thread that cannot be moved has ended.
        placement
            .threads
            .retain(|&thread| thread == own || cores.exclude(thread, leader.1).is_ok());
        placement.add(own);
    }
}

impl ThreadPlacement {
    fn add(&mut self, thread: u32) {
        if !self.threads.contains(&thread) {
            self.threads.push(thread);
        }
    }
}

impl Parallelism for HelperThreads {
    fn run_on_all(&self, work: &(dyn Fn() + Sync)) {
        let leader = thread_id();
        self.reserve_core(leader);
        self.team.run(&|| {
            let own = thread_id();
            if own == leader {
                // Measured with the step that it leads.
                return work();
            }
            let mut watch = Stopwatch::start();
            work();
            self.spans.lock().push(watch.lap(Stage::ParallelHelp, 0));
            self.placement.lock().add(own);
        });
    }
}
