//! Idle workers as helpers of the detection.

use actor::{Team, WorkerPool};
use detection::Crew;
use message::{Span, Stage};
use service::{Cores, Stopwatch, thread_id};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A team of workers that measures what its helpers do, and keeps them off the
/// leader's core: a thread that is waked is often put where the one runs that wakes
/// it, and would interrupt whom it is to help while another core has nothing to do.
#[derive(Debug)]
pub(crate) struct Helpers {
    team: Team,
    /// `None` where the system does not tell.
    cores: Option<Cores>,
    seats: Mutex<Seats>,
    spans: Mutex<Vec<Span>>,
}

/// Who may run where.
#[derive(Debug, Default)]
struct Seats {
    /// The leader's thread and core, off which all others are kept.
    leader: Option<(u32, usize)>,
    /// Threads that have led or helped.
    threads: Vec<u32>,
}

impl Helpers {
    /// The workers of a pool.
    pub(crate) fn of(pool: &WorkerPool) -> Self {
        Self {
            team: pool.team(),
            cores: Cores::of_process().ok(),
            seats: Mutex::default(),
            spans: Mutex::default(),
        }
    }

    /// Adds what they have done since the last call.
    pub(crate) fn tell(&self, spans: &mut Vec<Span>) {
        spans.append(&mut lock(&self.spans));
    }

    /// Makes room for the calling thread, who leads.
    fn make_room(&self, own: u32) {
        let Some(cores) = &self.cores else { return };
        let leader = (own, Cores::current());
        let mut seats = lock(&self.seats);
        if seats.leader == Some(leader) {
            return;
        }
        // Its own wish matters least: without it, it stays where it is.
        let _ = cores.give_back(own);
        seats.leader = Some(leader);
        // A thread that can not be moved has ended.
        seats
            .threads
            .retain(|&thread| thread == own || cores.keep_off(thread, leader.1).is_ok());
        seats.add(own);
    }
}

impl Seats {
    fn add(&mut self, thread: u32) {
        if !self.threads.contains(&thread) {
            self.threads.push(thread);
        }
    }
}

impl Crew for Helpers {
    fn together(&self, work: &(dyn Fn() + Sync)) {
        let leader = thread_id();
        self.make_room(leader);
        self.team.together(&|| {
            let own = thread_id();
            if own == leader {
                // Measured with the step that it leads.
                return work();
            }
            let mut watch = Stopwatch::start();
            work();
            lock(&self.spans).push(watch.lap(Stage::Helping, 0));
            lock(&self.seats).add(own);
        });
    }
}

/// Nothing can panic under these locks that would leave something half-changed.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
