//! Health report, at intervals and at each change of state, also to the service manager; sweep of
//! dead nodes.

use crate::service_manager::ServiceManager;
use crate::{CountingAllocator, HealthCounters, Shutdown, clock::monotonic_ns};
use channel::topic::ProcessHealth;
use channel::{Domain, Error, Publisher};
use message::{Health, PlainHeader, ProcessKind, ProcessState};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

/// Period of the health report.
const PERIOD: Duration = Duration::from_millis(500);
/// Health reports between two sweeps: scanning the domain's folders costs 0.3 MB of
/// allocations, and a second is soon enough for dead nodes.
const REPORTS_PER_SWEEP: u64 = 2;

/// Publisher of a process's health reports.
pub(crate) struct HealthReporter {
    publisher: Publisher<ProcessHealth>,
    domain: Domain,
    process: ProcessKind,
    board: Arc<HealthCounters>,
    started_ns: u64,
    service_manager: ServiceManager,
}

impl HealthReporter {
    pub(crate) fn new(
        domain: &Domain,
        process: ProcessKind,
        board: Arc<HealthCounters>,
    ) -> Result<Self, Error> {
        Ok(Self {
            publisher: Publisher::new(domain)?,
            domain: domain.clone(),
            process,
            board,
            started_ns: monotonic_ns(),
            service_manager: ServiceManager::new(),
        })
    }

    pub(crate) async fn run(mut self, shutdown: Shutdown) {
        let mut period = tokio::time::interval(PERIOD);
        let mut n_periods = 0_u64;
        let board = Arc::clone(&self.board);
        loop {
            tokio::select! {
                _ = period.tick() => {
                    if n_periods.is_multiple_of(REPORTS_PER_SWEEP) {
                        self.domain.sweep_dead_nodes();
                    }
                    n_periods += 1;
                }
                () = board.state_change() => {}
                () = shutdown.requested() => break,
            }
            let board = &self.board;
            self.service_manager.update(board.state(), board.progress());
            self.report();
        }
        self.board.set_state(ProcessState::Stopping, "");
        self.report();
    }

    fn report(&mut self) {
        let board = &self.board;
        let (state, note) = board.state();
        let (allocations, allocated_bytes) = CountingAllocator::counts();
        let health = Health {
            process: self.process.code(),
            pid: std::process::id(),
            state: state.code(),
            started_ns: self.started_ns,
            stamp_ns: monotonic_ns(),
            frames: board.frames.load(Ordering::Relaxed),
            frames_dropped: board.frames_dropped.load(Ordering::Relaxed),
            frames_late: board.frames_late.load(Ordering::Relaxed),
            allocated_bytes,
            allocations,
            resident_bytes: resident_bytes(),
            shared_memory_bytes: board.shared_memory_bytes.load(Ordering::Relaxed),
            restarts: board.restarts.load(Ordering::Relaxed),
            actors: board.actors.load(Ordering::Relaxed),
            abandoned: board.abandoned.load(Ordering::Relaxed),
            progress: board.progress(),
            note,
            ..Health::default()
        };
        if let Err(error) = self.publisher.send_copy(PlainHeader::default(), &[health]) {
            tracing::warn!("the health report was not sent: {error}");
        }
    }
}

/// Resident memory, shared memory included, bytes; 0 when the kernel does not report
/// it.
fn resident_bytes() -> u64 {
    let pages = std::fs::read_to_string("/proc/self/statm")
        .ok()
        .and_then(|line| line.split_ascii_whitespace().nth(1)?.parse::<u64>().ok());
    pages.unwrap_or(0) * rustix::param::page_size() as u64
}
