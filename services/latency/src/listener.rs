//! Reading the traces of a daemon while it works.

use channel::topic::FrameTraces;
use channel::{Domain, Error, Received, Subscriber};
use command_line::StopSignal;
use latency_report::{FrameWay, Gathering};
use message::{ProcessKind, frame_flag};
use service::{Failure, exit_code};
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// How often the traces are read: their ring holds 24 frames, a fifth of a second at the
/// highest rate.
const READ: Duration = Duration::from_millis(20);
/// Frames that stay away for this long will not come.
const SILENCE: Duration = Duration::from_secs(10);

/// Why somebody listens no more.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ended {
    /// He has heard enough, or was asked to stop.
    Enough,
    /// No frame comes any more.
    Silence,
}

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

    /// Hands over frame by frame as they come, as long as `take` says that it wants
    /// more: until the daemon is silent, or somebody wants to stop.
    ///
    /// # Errors
    /// When shared memory fails, and when the frames wait for each other.
    pub(crate) fn each_frame(
        &mut self,
        stop: &StopSignal,
        mut take: impl FnMut(FrameWay) -> bool,
    ) -> Result<Ended, Failure> {
        let mut last_frame = Instant::now();
        while !stop.is_raised() {
            self.read()?;
            if self.is_lockstep {
                return Err(no_schedule());
            }
            while let Some(way) = self.gathering.next_frame() {
                last_frame = Instant::now();
                if !take(way) {
                    return Ok(Ended::Enough);
                }
            }
            if last_frame.elapsed() > SILENCE {
                return Ok(Ended::Silence);
            }
            stop.sleep(READ);
        }
        Ok(Ended::Enough)
    }

    /// Takes all messages that wait.
    fn read(&mut self) -> Result<(), Error> {
        while let Received::Message(message) = self.traces.receive()? {
            let header = message.header();
            self.pids.insert(header.process, header.pid);
            self.is_lockstep |= header.frame_flags & frame_flag::LOCKSTEP != 0;
            self.gathering.take(header, message.items());
        }
        Ok(())
    }

    /// Processes that have told of frames, with their ids.
    pub(crate) fn processes(&self) -> Vec<(ProcessKind, u32)> {
        let known = self.pids.iter();
        known
            .filter_map(|(code, pid)| Some((ProcessKind::from_code(*code)?, *pid)))
            .collect()
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

fn no_schedule() -> Failure {
    Failure::new(
        exit_code::USAGE,
        "this daemon's frames wait for each other (lockstep), so that there is no schedule to be \
         late for; start it without --lockstep",
    )
}

/// That no frame has come for too long.
pub(crate) fn no_frames() -> Failure {
    Failure::new(
        exit_code::TIMED_OUT,
        format!(
            "no frame has come for {} s; `tabula status` tells how the daemon's processes are",
            SILENCE.as_secs()
        ),
    )
}
