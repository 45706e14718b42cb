//! Reader of a running daemon's frame traces.

use channel::topic::FrameTraces;
use channel::{Domain, Error, Received, Subscriber};
use command_line::StopSignal;
use latency_report::{FrameAssembler, FrameTimeline};
use message::{ProcessKind, frame_flag};
use service::{Failure, exit_code};
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// Polling period of the traces. Their ring holds 24 frames, a fifth of a second at the highest
/// rate.
const READ_PERIOD: Duration = Duration::from_millis(20);
/// Time without a frame after which the source counts as silent.
const SILENCE_TIMEOUT: Duration = Duration::from_secs(10);

/// Reason why reading trace messages ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ReadEnd {
    /// Enough frames were read, or a stop was requested.
    Enough,
    /// Timeout: no more frames arrive.
    Silence,
}

/// Reader of frame traces by polling, so that it costs the daemon no wake-up per message.
pub(crate) struct TraceReader {
    traces: Subscriber<FrameTraces>,
    assembler: FrameAssembler,
    pids: BTreeMap<u32, u32>,
    is_lockstep: bool,
}

impl TraceReader {
    pub(crate) fn new(domain: &Domain) -> Result<Self, Error> {
        Ok(Self {
            traces: Subscriber::polled(domain)?,
            assembler: FrameAssembler::default(),
            pids: BTreeMap::new(),
            is_lockstep: false,
        })
    }

    /// Passes each complete frame to `take` until it returns `false`, the daemon is silent, or a
    /// stop is requested.
    ///
    /// # Errors
    /// If shared memory fails, or the daemon runs in lockstep.
    pub(crate) fn each_frame(
        &mut self,
        stop: &StopSignal,
        mut take: impl FnMut(FrameTimeline) -> bool,
    ) -> Result<ReadEnd, Failure> {
        let mut last_frame = Instant::now();
        while !stop.is_raised() {
            self.read()?;
            if self.is_lockstep {
                return Err(no_schedule());
            }
            while let Some(timeline) = self.assembler.next_frame() {
                last_frame = Instant::now();
                if !take(timeline) {
                    return Ok(ReadEnd::Enough);
                }
            }
            if last_frame.elapsed() > SILENCE_TIMEOUT {
                return Ok(ReadEnd::Silence);
            }
            stop.sleep(READ_PERIOD);
        }
        Ok(ReadEnd::Enough)
    }

    /// Reads all pending trace messages.
    fn read(&mut self) -> Result<(), Error> {
        while let Received::Message(message) = self.traces.receive()? {
            let header = message.header();
            self.pids.insert(header.process, header.pid);
            self.is_lockstep |= header.frame_flags & frame_flag::LOCKSTEP != 0;
            self.assembler.add(header, message.items());
        }
        Ok(())
    }

    /// Processes that have sent traces, with their ids.
    pub(crate) fn processes(&self) -> Vec<(ProcessKind, u32)> {
        let known = self.pids.iter();
        known
            .filter_map(|(code, pid)| Some((ProcessKind::from_code(*code)?, *pid)))
            .collect()
    }

    /// Number of messages overwritten before they were read.
    pub(crate) fn n_lost(&self) -> u64 {
        self.traces.n_lost()
    }

    /// Frame assembler fed by the trace messages.
    pub(crate) fn assembler(&self) -> &FrameAssembler {
        &self.assembler
    }
}

fn no_schedule() -> Failure {
    Failure::usage(
        "this daemon's frames wait for each other (lockstep), so that there is no schedule to be \
         late for; start it without --lockstep",
    )
}

/// Failure: no frame has arrived for too long.
pub(crate) fn no_frames() -> Failure {
    Failure::new(
        exit_code::TIMED_OUT,
        format!(
            "no frame has come for {} s; `tabula status` tells how the daemon's processes are",
            SILENCE_TIMEOUT.as_secs()
        ),
    )
}
