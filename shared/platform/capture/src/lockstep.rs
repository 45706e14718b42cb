//! Waiting for the followers of a frame.

use channel::topic::FrameFinished;
use channel::{Domain, Error, Subscriber};
use message::{FrameDone, ProcessKind};
use service::Shutdown;
use std::time::Duration;

/// Who must have finished a frame before the next one is sent.
const FOLLOWERS: [ProcessKind; 2] = [ProcessKind::Perception, ProcessKind::Memory];
/// After this silence the frame is sent again: a follower that was restarted has
/// never seen it, one that has finished it says so again.
const SILENCE: Duration = Duration::from_secs(3);

/// Collects the followers' reports.
pub(crate) struct Lockstep {
    reports: Subscriber<FrameFinished>,
}

/// How waiting ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Waited {
    /// All followers have finished the frame.
    Finished,
    /// Somebody has not; send the frame again.
    Silence,
    /// The process is asked to stop.
    Stop,
}

impl Lockstep {
    pub(crate) fn new(domain: &Domain) -> Result<Self, Error> {
        Ok(Self {
            reports: Subscriber::waiting(domain)?,
        })
    }

    /// Waits until all followers have finished the frame.
    pub(crate) async fn finished(
        &mut self,
        session: u64,
        sequence: u64,
        shutdown: &Shutdown,
    ) -> Result<Waited, Error> {
        let mut waiting_for = FOLLOWERS.to_vec();
        let silence = tokio::time::sleep(SILENCE);
        tokio::pin!(silence);
        while !waiting_for.is_empty() {
            let report = tokio::select! {
                report = self.reports.next() => report?,
                () = &mut silence => return Ok(Waited::Silence),
                () = shutdown.requested() => return Ok(Waited::Stop),
            };
            for done in report.items() {
                waiting_for.retain(|&follower| !is_by(done, follower, session, sequence));
            }
        }
        Ok(Waited::Finished)
    }
}

fn is_by(done: &FrameDone, follower: ProcessKind, session: u64, sequence: u64) -> bool {
    (done.session, done.sequence, done.process) == (session, sequence, u64::from(follower.code()))
}
