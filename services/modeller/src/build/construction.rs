//! Construction of a model, on a thread of its own, from the views that a moving camera takes.

use super::POLL_PERIOD;
use super::build_thread::{BuildProgress, BuildThread, Grown};
use super::model_store::ModelStore;
use crate::arguments::BuildArguments;
use crate::growth::{Growth, GrowthState, Step};
use crate::object_receiver::ObjectReceiver;
use crate::presence::is_running;
use crate::view_queue::ViewQueue;
use channel::DomainName;
use command_line::{Output, StopSignal};
use model_construction::Config;
use service::Failure;
use std::time::{Duration, Instant};

/// Period of the checks of the daemon, and of the lines that show the growth.
const CHECK_PERIOD: Duration = Duration::from_secs(1);
const LINE_PERIOD: Duration = Duration::from_secs(2);

coded_enum::coded_enum! {
    /// Reason for the end of the construction.
    pub(super) enum End {
        Stopped, "stopped";
        Time, "the time is over";
        Closed, "the views have led around the object";
        DaemonEnded, "the daemon has ended";
    }
}

/// Model after the last view.
#[derive(Debug)]
pub(super) struct Constructed {
    pub(super) growth: Growth,
    pub(super) end: End,
    pub(super) begun: Instant,
    /// Number of views that were taken and not added.
    pub(super) n_left_out: usize,
    /// `true` if the views were brought into agreement at the end.
    pub(super) is_agreed: bool,
}

/// Construction that goes on.
pub(super) struct Construction<'a, 's> {
    domain: &'a DomainName,
    arguments: &'a BuildArguments,
    stop: &'a StopSignal,
    output: &'a Output,
    store: &'a mut ModelStore<'s>,
    queue: ViewQueue,
    thread: BuildThread,
    begun: Instant,
    next_line: Instant,
    state: Option<GrowthState>,
    is_closed: bool,
}

impl<'a, 's> Construction<'a, 's> {
    pub(super) fn new(
        domain: &'a DomainName,
        arguments: &'a BuildArguments,
        config: Config,
        (stop, output): (&'a StopSignal, &'a Output),
        store: &'a mut ModelStore<'s>,
    ) -> Result<Self, Failure> {
        let begun = Instant::now();
        Ok(Self {
            domain,
            arguments,
            stop,
            output,
            store,
            queue: ViewQueue::new(arguments.step_deg.to_radians()),
            thread: BuildThread::start(config, arguments.pose_sigma(), arguments.niceness)?,
            begun,
            next_line: begun + LINE_PERIOD,
            state: None,
            is_closed: false,
        })
    }

    /// Adds the views of a track until an end, then those that still wait.
    pub(super) fn run(
        mut self,
        receiver: &mut ObjectReceiver,
        track: u64,
    ) -> Result<Constructed, Failure> {
        let end = self.take_views(receiver, track)?;
        self.add_waiting();
        let n_waiting = self.queue.len();
        let (until_closed, begun) = (self.arguments.until_closed, self.begun);
        let Grown { growth, is_agreed } = self.agree();
        // The last view may have closed the loop.
        let is_complete = until_closed && growth.builder().is_closed();
        Ok(Constructed {
            growth,
            end: if is_complete { End::Closed } else { end },
            begun,
            n_left_out: if is_complete { 0 } else { n_waiting },
            is_agreed,
        })
    }

    /// Brings the views into agreement, until a further stop signal; SIGTERM leaves them as they
    /// are.
    fn agree(self) -> Grown {
        if !self.is_complete() {
            let text = "bringing the views into agreement; Ctrl-C leaves them as they are";
            self.output.print_status(text);
        }
        let (stop, n_raised) = (self.stop, self.stop.n_raised());
        self.thread
            .finish(|| stop.is_terminated() || stop.n_raised() > n_raised)
    }

    /// `true` once no further view is wanted.
    fn is_complete(&self) -> bool {
        self.arguments.until_closed && self.is_closed
    }

    /// Takes views, and has them added, until an end.
    fn take_views(&mut self, receiver: &mut ObjectReceiver, track: u64) -> Result<End, Failure> {
        let mut next_check = self.begun + CHECK_PERIOD;
        loop {
            if let Some(view) = receiver.newest_view(track)? {
                self.queue.push(view);
            }
            self.hand_over(Duration::ZERO);
            self.note_progress();
            if self.is_complete() {
                return Ok(End::Closed);
            }
            if self.stop.is_raised() || self.thread.has_ended() {
                return Ok(End::Stopped);
            }
            let seconds = self.begun.elapsed().as_secs();
            if self.arguments.seconds.is_some_and(|end| seconds >= end) {
                return Ok(End::Time);
            }
            let now = Instant::now();
            if now >= next_check {
                next_check = now + CHECK_PERIOD;
                if !is_running(self.domain) {
                    return Ok(End::DaemonEnded);
                }
            }
            match receiver.obstacle() {
                Some(obstacle) => self.print_line(|_| Some(obstacle.in_words(track))),
                None => self.print_line(Self::state_line),
            }
            self.stop.sleep(POLL_PERIOD);
        }
    }

    /// Adds the waiting views, until a further stop signal; SIGTERM leaves them out at once.
    fn add_waiting(&mut self) {
        let n_raised = self.stop.n_raised();
        let goes_on = |waiting: &Self| {
            let is_stopped = waiting.stop.is_terminated() || waiting.stop.n_raised() > n_raised;
            let is_done = waiting.queue.len() == 0 || waiting.is_complete();
            !is_done && !is_stopped && !waiting.thread.has_ended()
        };
        if self.queue.len() > 1 && goes_on(self) {
            self.output.print_status(&format!(
                "{} views are still to be added; Ctrl-C leaves them out",
                self.queue.len()
            ));
        }
        while goes_on(self) {
            self.hand_over(POLL_PERIOD);
            self.note_progress();
            self.print_line(Self::state_line);
        }
    }

    /// Gives the oldest view to the thread, if that is ready for it within a time.
    fn hand_over(&mut self, patience: Duration) {
        if let Some(view) = self.queue.pop()
            && let Some(view) = self.thread.add(view, patience)
        {
            self.queue.put_back(view);
        }
    }

    fn note_progress(&mut self) {
        while let Some(progress) = self.thread.progress() {
            let BuildProgress {
                step,
                state,
                unfinished,
            } = progress;
            self.state = Some(state);
            if let Some(model) = unfinished {
                self.store.put_unfinished(&model, self.output);
            }
            if step == Step::Closed {
                self.is_closed = true;
                let text = "the views lead around the object; the loop is closed";
                self.output.print_status(text);
            }
        }
    }

    /// Prints a line from time to time.
    fn print_line(&mut self, line: impl FnOnce(&Self) -> Option<String>) {
        let now = Instant::now();
        if now >= self.next_line {
            self.next_line = now + LINE_PERIOD;
            if let Some(line) = line(self) {
                self.output.print_status(&line);
            }
        }
    }

    fn state_line(&self) -> Option<String> {
        let state = self.state.as_ref()?;
        Some(state.line(self.begun.elapsed(), self.queue.len()))
    }
}
