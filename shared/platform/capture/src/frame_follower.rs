//! Follower of a source in lockstep that handles each frame after other followers.

use crate::lockstep::Follower;
use channel::topic::FinishedFrames;
use channel::{Domain, Error, Publisher, Received, Subscriber};
use message::{FrameDone, PlainHeader, ProcessKind};

/// Frame that the followers before this one have finished.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FollowedFrame {
    /// Session of the source.
    pub session: u64,
    /// Number of the frame in its session.
    pub sequence: u64,
}

/// Follower of a source in lockstep: it gets each frame when others have finished it, and the source
/// waits for its report.
#[derive(Debug)]
pub struct FrameFollower {
    reports: Subscriber<FinishedFrames>,
    finished: Publisher<FinishedFrames>,
    own_code: u64,
    /// Codes of the followers that come before this one.
    before: Vec<u64>,
    /// Newest frame on which one of them has reported.
    frame: Option<FollowedFrame>,
    /// Those of them that have not reported on it.
    missing: Vec<u64>,
    /// Frame on which this follower has reported last.
    reported: Option<FollowedFrame>,
}

impl FrameFollower {
    /// Follower after some processes, which polls.
    ///
    /// # Errors
    /// When the topic has no room for it, or shared memory fails.
    pub fn polled(domain: &Domain, own: Follower, before: &[ProcessKind]) -> Result<Self, Error> {
        Self::new(domain, own, before, Subscriber::polled(domain)?)
    }

    /// Follower after some processes, which can wait for reports; within a tokio runtime.
    ///
    /// # Errors
    /// As [`polled`](Self::polled).
    pub fn waiting(domain: &Domain, own: Follower, before: &[ProcessKind]) -> Result<Self, Error> {
        Self::new(domain, own, before, Subscriber::waiting(domain)?)
    }

    fn new(
        domain: &Domain,
        own: Follower,
        before: &[ProcessKind],
        reports: Subscriber<FinishedFrames>,
    ) -> Result<Self, Error> {
        Ok(Self {
            reports,
            finished: Publisher::new(domain)?,
            own_code: own.code(),
            before: before.iter().map(|one| u64::from(one.code())).collect(),
            frame: None,
            missing: Vec::new(),
            reported: None,
        })
    }

    /// Shared memory reserved by the publisher, bytes.
    pub fn reserved_bytes(&self) -> u64 {
        self.finished.reservation().bytes()
    }

    /// True once any frame of a source in lockstep was finished.
    pub fn is_in_lockstep(&self) -> bool {
        self.frame.is_some()
    }

    /// Waits until a report may have come. A polled follower waits for ever.
    pub async fn wake_event(&self) {
        self.reports.wake_event().await;
    }

    /// The frame that the others have finished, once. On a frame that the source has sent again this
    /// follower reports again, too: the source waits for all of them.
    ///
    /// # Errors
    /// When shared memory fails.
    pub fn next_frame(&mut self) -> Result<Option<FollowedFrame>, Error> {
        while let Received::Message(report) = self.reports.receive()? {
            for done in report.items() {
                let Some(frame) = self.finished_by(done) else {
                    continue;
                };
                if self.reported != Some(frame) {
                    return Ok(Some(frame));
                }
                self.report(frame)?;
            }
        }
        Ok(None)
    }

    /// Takes a report; returns its frame if it was the last one that was missing.
    fn finished_by(&mut self, done: &FrameDone) -> Option<FollowedFrame> {
        if !self.before.contains(&done.process) {
            return None;
        }
        let frame = FollowedFrame {
            session: done.session,
            sequence: done.sequence,
        };
        if self.frame != Some(frame) || self.missing.is_empty() {
            self.frame = Some(frame);
            self.missing.clone_from(&self.before);
        }
        self.missing.retain(|code| *code != done.process);
        self.missing.is_empty().then_some(frame)
    }

    /// Reports that this follower has finished a frame. A report for which another follower has no room,
    /// one that is busy or being started anew, is made again when the source sends the frame again.
    ///
    /// # Errors
    /// When shared memory fails.
    pub fn report(&mut self, frame: FollowedFrame) -> Result<(), Error> {
        self.reported = Some(frame);
        let done = FrameDone {
            session: frame.session,
            sequence: frame.sequence,
            process: self.own_code,
        };
        match self.finished.send_copy(PlainHeader::default(), &[done]) {
            Err(Error::QueueFull { .. }) => Ok(()),
            sent => sent,
        }
    }
}
