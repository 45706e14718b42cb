//! Follower of a source in lockstep that handles each frame after other followers.

use channel::topic::{FinishedFrames, Scene};
use channel::{Domain, Error, Publisher, Received, Subscriber};
use message::{FrameDone, PlainHeader, ProcessKind};

/// Frame that the followers before this one have finished.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FollowedFrame {
    /// Session of the source.
    pub session: u64,
    /// Number of the frame in its session.
    pub sequence: u64,
    /// Capture time of the newest scene, nanoseconds of the source's clock; 0 before the first.
    pub captured_ns: u64,
}

/// Follower of a source in lockstep: it gets each frame when others have finished it, and the source
/// waits for its report.
#[derive(Debug)]
pub struct FrameFollower {
    reports: Subscriber<FinishedFrames>,
    finished: Publisher<FinishedFrames>,
    scenes: Subscriber<Scene>,
    code: u64,
    /// Codes of the followers that come before this one.
    before: Vec<u64>,
    /// Session and number of the newest frame on which one of them has reported.
    frame: Option<(u64, u64)>,
    /// Those of them that have not reported on it.
    missing: Vec<u64>,
    captured_ns: u64,
    /// Session and number of the frame on which this follower has reported last.
    reported: Option<(u64, u64)>,
}

impl FrameFollower {
    /// Follower with the code of its reports, after some processes.
    ///
    /// # Errors
    /// When a topic has no room for it, or shared memory fails.
    pub fn new(domain: &Domain, code: u64, before: &[ProcessKind]) -> Result<Self, Error> {
        Ok(Self {
            reports: Subscriber::polled(domain)?,
            finished: Publisher::new(domain)?,
            scenes: Subscriber::polled(domain)?,
            code,
            before: before.iter().map(|one| u64::from(one.code())).collect(),
            frame: None,
            missing: Vec::new(),
            captured_ns: 0,
            reported: None,
        })
    }

    /// True once any frame of a source in lockstep was finished.
    pub fn is_in_lockstep(&self) -> bool {
        self.frame.is_some()
    }

    /// The frame that the others have finished, once. On a frame that the source has sent again this
    /// follower reports again, too: the source waits for all of them.
    ///
    /// # Errors
    /// When shared memory fails.
    pub fn next_frame(&mut self) -> Result<Option<FollowedFrame>, Error> {
        while let Received::Message(report) = self.reports.receive()? {
            for done in report.items() {
                if !self.is_last_missing(done) {
                    continue;
                }
                let frame = self.followed(done)?;
                if self.reported != self.frame {
                    return Ok(Some(frame));
                }
                self.report(frame)?;
            }
        }
        Ok(None)
    }

    /// Takes a report; true if it was the last one on its frame.
    fn is_last_missing(&mut self, done: &FrameDone) -> bool {
        if !self.before.contains(&done.process) {
            return false;
        }
        let frame = Some((done.session, done.sequence));
        if self.frame != frame || self.missing.is_empty() {
            self.frame = frame;
            self.missing.clone_from(&self.before);
        }
        self.missing.retain(|code| *code != done.process);
        self.missing.is_empty()
    }

    fn followed(&mut self, done: &FrameDone) -> Result<FollowedFrame, Error> {
        if let Some(scene) = self.scenes.latest()? {
            self.captured_ns = scene.header().stamps.capture_ns;
        }
        Ok(FollowedFrame {
            session: done.session,
            sequence: done.sequence,
            captured_ns: self.captured_ns,
        })
    }

    /// Reports that this follower has finished a frame. A report for which another follower has no room,
    /// one that is busy or being started anew, is made again when the source sends the frame again.
    ///
    /// # Errors
    /// When shared memory fails.
    pub fn report(&mut self, frame: FollowedFrame) -> Result<(), Error> {
        let done = FrameDone {
            session: frame.session,
            sequence: frame.sequence,
            process: self.code,
        };
        self.reported = Some((frame.session, frame.sequence));
        match self.finished.send_copy(PlainHeader::default(), &[done]) {
            Err(Error::QueueFull { .. }) => Ok(()),
            sent => sent,
        }
    }
}
