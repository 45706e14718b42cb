//! Lockstep: waits for the reports of the processes that handle a frame.

use channel::topic::FinishedFrames;
use channel::{Domain, Error, Subscriber};
use message::{Duty, FrameDone, ProcessKind};
use service::{HealthCounters, Shutdown};
use std::str::FromStr;
use std::time::Duration;

/// Timeout after which the frame is sent again: a restarted follower has never seen
/// it, one that has finished it reports again. Chosen.
const SILENCE: Duration = Duration::from_secs(3);
/// Period in which waiting is recorded as progress.
const PROGRESS_PERIOD: Duration = Duration::from_millis(500);

/// Code of an observer in its reports of finished frames, in the place of that of a process.
const OBSERVER_CODE: u64 = 64;

/// Follower of a source in lockstep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Follower {
    /// Process of the daemon.
    Process(ProcessKind),
    /// Program that takes all that was published for a frame.
    Observer,
}

impl Follower {
    /// Code of the follower in its reports.
    pub(crate) fn code(self) -> u64 {
        match self {
            Self::Process(process) => u64::from(process.code()),
            Self::Observer => OBSERVER_CODE,
        }
    }
}

impl FromStr for Follower {
    type Err = String;

    fn from_str(word: &str) -> Result<Self, String> {
        let process = || ProcessKind::from_word(word).map(Self::Process);
        let observer = (word == "observer").then_some(Self::Observer);
        let known = observer.or_else(process);
        known.ok_or_else(|| format!("{word:?} is neither observer nor a process of the daemon"))
    }
}

/// Pace of the frames of a source.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FramePace {
    /// On schedule, or as a live sensor sends them.
    Schedule,
    /// Each frame when perception, memory and these others have finished the one before.
    Lockstep(Vec<Follower>),
}

impl FramePace {
    /// Pace of a source, in lockstep with others beside perception and memory.
    pub fn new(is_lockstep: bool, others: &[Follower]) -> Self {
        if is_lockstep {
            Self::Lockstep(others.to_owned())
        } else {
            Self::Schedule
        }
    }

    /// True if a frame waits for the one before to be finished.
    pub fn is_lockstep(&self) -> bool {
        *self != Self::Schedule
    }
}

/// Receiver of the followers' reports.
pub(crate) struct Lockstep {
    reports: Subscriber<FinishedFrames>,
    others: Vec<Follower>,
}

/// Outcome of waiting for the lockstep followers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum LockstepOutcome {
    /// All followers have finished the frame.
    Finished,
    /// Timeout of a follower; the frame is sent again.
    TimedOut,
    /// Shutdown was requested while waiting.
    Stop,
}

impl Lockstep {
    /// Receiver in a domain; `None` for a source on schedule.
    pub(crate) fn new(domain: &Domain, pace: FramePace) -> Result<Option<Self>, Error> {
        let FramePace::Lockstep(others) = pace else {
            return Ok(None);
        };
        Ok(Some(Self {
            reports: Subscriber::waiting(domain)?,
            others,
        }))
    }

    /// Waits until all followers have finished the frame. The wait is progress of this process.
    pub(crate) async fn finished(
        &mut self,
        (session, sequence): (u64, u64),
        shutdown: &Shutdown,
        health: &HealthCounters,
    ) -> Result<LockstepOutcome, Error> {
        let followers = ProcessKind::all().filter(|process| process.has(Duty::FollowsFrames));
        let mut waiting_for: Vec<u64> = followers.map(|one| u64::from(one.code())).collect();
        waiting_for.extend(self.others.iter().map(|other| other.code()));
        let silence = tokio::time::sleep(SILENCE);
        tokio::pin!(silence);
        while !waiting_for.is_empty() {
            let report = tokio::select! {
                report = self.reports.next() => report?,
                () = &mut silence => return Ok(LockstepOutcome::TimedOut),
                () = shutdown.requested() => return Ok(LockstepOutcome::Stop),
                () = tokio::time::sleep(PROGRESS_PERIOD) => {
                    health.record_progress();
                    continue;
                }
            };
            for &done in report.items() {
                waiting_for.retain(|&follower| !is_by(&done, follower, session, sequence));
            }
        }
        Ok(LockstepOutcome::Finished)
    }
}

fn is_by(done: &FrameDone, follower: u64, session: u64, sequence: u64) -> bool {
    (done.session, done.sequence, done.process) == (session, sequence, follower)
}
