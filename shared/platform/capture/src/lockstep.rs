//! Lockstep: waits for the reports of the processes that handle a frame.

use channel::topic::FinishedFrames;
use channel::{Domain, Error, Subscriber};
use message::{Duty, FrameDone, ProcessKind};
use service::{HealthCounters, Shutdown};
use std::time::Duration;

/// Timeout after which the frame is sent again: a restarted follower has never seen
/// it, one that has finished it reports again. Chosen.
const SILENCE: Duration = Duration::from_secs(3);
/// Period in which waiting is recorded as progress.
const PROGRESS_PERIOD: Duration = Duration::from_millis(500);

/// Code of a recorder in its reports of finished frames, in the place of that of a process.
pub const RECORDER_CODE: u64 = 64;

/// Pace of the frames of a source.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FramePace {
    /// On schedule, or as a live sensor sends them.
    Schedule,
    /// Each frame when perception and memory have finished the one before.
    Lockstep,
    /// The same, and a recorder has taken all that was published for it.
    LockstepWithRecorder,
}

impl FramePace {
    /// True if a frame waits for the one before to be finished.
    pub fn is_lockstep(self) -> bool {
        self != Self::Schedule
    }
}

/// Receiver of the followers' reports.
pub(crate) struct Lockstep {
    reports: Subscriber<FinishedFrames>,
    has_recorder: bool,
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
    pub(crate) fn new(domain: &Domain, pace: FramePace) -> Result<Self, Error> {
        Ok(Self {
            reports: Subscriber::waiting(domain)?,
            has_recorder: pace == FramePace::LockstepWithRecorder,
        })
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
        waiting_for.extend(self.has_recorder.then_some(RECORDER_CODE));
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
