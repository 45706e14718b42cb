//! Reading the traces of a daemon while it works.

use channel::topic::FrameTraces;
use channel::{Domain, Error, Received, Subscriber};
use latency_report::{FrameWay, Gathering};
use message::{ProcessKind, frame_flag};
use std::collections::BTreeMap;

/// Reads what has come since the last time. It asks a few times a second instead of
/// being waked for each message: so it costs the daemon no wake-up.
pub(crate) struct Listener {
    traces: Subscriber<FrameTraces>,
    gathering: Gathering,
    pids: BTreeMap<u32, u32>,
    is_lockstep: bool,
}

impl Listener {
    pub(crate) fn new(domain: &Domain) -> Result<Self, Error> {
        Ok(Self {
            traces: Subscriber::polled(domain)?,
            gathering: Gathering::default(),
            pids: BTreeMap::new(),
            is_lockstep: false,
        })
    }

    /// Takes all messages that wait.
    pub(crate) fn read(&mut self) -> Result<(), Error> {
        while let Received::Message(message) = self.traces.receive()? {
            let header = message.header();
            self.pids.insert(header.process, header.pid);
            self.is_lockstep |= header.frame_flags & frame_flag::LOCKSTEP != 0;
            self.gathering.take(header, message.items());
        }
        Ok(())
    }

    /// The oldest frame of which all is known.
    pub(crate) fn next_frame(&mut self) -> Option<FrameWay> {
        self.gathering.next_frame()
    }

    /// Processes that have told of frames, with their ids.
    pub(crate) fn processes(&self) -> Vec<(ProcessKind, u32)> {
        let known = self.pids.iter();
        known
            .filter_map(|(code, pid)| Some((ProcessKind::from_code(*code)?, *pid)))
            .collect()
    }

    /// Whether frames wait for the daemon, so that their schedule means nothing.
    pub(crate) fn is_lockstep(&self) -> bool {
        self.is_lockstep
    }

    /// Messages that were overwritten before they were read.
    pub(crate) fn n_lost(&self) -> u64 {
        self.traces.n_lost()
    }

    /// What was read and put together.
    pub(crate) fn gathering(&self) -> &Gathering {
        &self.gathering
    }
}
