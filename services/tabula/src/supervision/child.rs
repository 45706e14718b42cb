//! Supervised child process: restarted when it ends, killed when it makes no progress.

use super::config::SupervisionConfig;
use super::health_feed::HealthFeed;
use super::process_record::{ProcessRecord, RecordedState, Supervisor};
use super::program::{self, ProcessCommand};
use super::progress_watch::{BootTime, ProgressWatch};
use super::restart_streak::RestartStreak;
use message::ProcessKind;
use rustix::process::{Pid, Signal, kill_process};
use service::{Failure, exit_code, wall_clock_ns};
use std::process::{Child as OsChild, ExitStatus};
use std::time::Duration;

/// Time that a process gets to write its core dump after SIGABRT; then it is killed. Chosen.
const CORE_DUMP_TIME: Duration = Duration::from_secs(10);
/// Time without progress from which clients are told of a stall. Chosen: above the 3 s after
/// which a source that waits for a device, or for a frame in lockstep, records progress.
const STALLED: Duration = Duration::from_secs(4);
/// Cause of an end by the watchdog.
const NO_PROGRESS: &str = "no progress";

/// Child process that is restarted when it ends.
pub(crate) struct Child {
    command: ProcessCommand,
    config: SupervisionConfig,
    state: ChildState,
    streak: RestartStreak,
    has_been_ready: bool,
    trouble: Option<Trouble>,
    /// `true` until the running process has got a request to reload its configuration.
    wants_reload: bool,
    /// Wall clock of the last change of the recorded state, nanoseconds since 1970.
    since_ns: u64,
}

enum ChildState {
    Running(RunningProcess),
    Waiting { until: BootTime },
}

struct RunningProcess {
    child: OsChild,
    watch: ProgressWatch,
    /// Instant of readiness.
    ready: Option<BootTime>,
    is_stalled: bool,
    killing: Option<Killing>,
}

/// Sent signals to a process without progress.
#[derive(Clone, Copy)]
struct Killing {
    /// Instant of SIGKILL after SIGABRT; `None` once it is sent.
    kill_at: Option<BootTime>,
}

/// End of the process after which it has not become ready again.
struct Trouble {
    cause: String,
    is_logged: bool,
}

impl Child {
    /// Starts a child process.
    ///
    /// # Errors
    /// When its program is not there or cannot be started.
    pub(crate) fn start(
        command: ProcessCommand,
        config: SupervisionConfig,
        now: BootTime,
    ) -> Result<Self, Failure> {
        let running = RunningProcess::start(&command, &config, now)?;
        Ok(Self {
            command,
            config,
            state: ChildState::Running(running),
            streak: RestartStreak::new(config.restart_delay_max),
            has_been_ready: false,
            trouble: None,
            wants_reload: false,
            since_ns: wall_ns(),
        })
    }

    /// Replaces the configuration of the supervision.
    pub(crate) fn set_config(&mut self, config: SupervisionConfig) {
        self.config = config;
        self.streak.set_longest_delay(config.restart_delay_max);
        if let ChildState::Running(running) = &mut self.state {
            let limits = config.progress_limits(self.command.process);
            running.watch.set_limits(limits);
        }
    }

    /// Requests the running process to reload its configuration. One that is started later reads
    /// the new one anyway.
    pub(crate) fn request_reload(&mut self) {
        self.wants_reload = matches!(self.state, ChildState::Running(_));
    }

    /// Kind of the child process.
    pub(crate) fn process(&self) -> ProcessKind {
        self.command.process
    }

    /// Process id; `None` while the restart is pending.
    pub(crate) fn pid(&self) -> Option<u32> {
        match &self.state {
            ChildState::Running(running) => Some(running.child.id()),
            ChildState::Waiting { .. } => None,
        }
    }

    /// Record of the process for clients.
    pub(crate) fn record(&self) -> ProcessRecord {
        let (state, cause) = match (&self.trouble, &self.state) {
            (Some(trouble), _) => (RecordedState::Failing, trouble.cause.clone()),
            (None, ChildState::Running(running)) if running.is_stalled => {
                (RecordedState::Stalled, NO_PROGRESS.to_owned())
            }
            (None, ChildState::Running(running)) if running.ready.is_some() => {
                (RecordedState::Running, String::new())
            }
            (None, _) => (RecordedState::Starting, String::new()),
        };
        ProcessRecord {
            process: self.command.process.word().to_owned(),
            pid: self.pid(),
            state,
            since_ns: self.since_ns,
            n_ends: self.streak.n_ends(),
            cause,
            supervisor: Supervisor::TabulaRun,
        }
    }

    /// Polls the process: takes its progress, kills it when it makes none, and restarts it
    /// after its end. `feed` is `None` while no health reports are received.
    ///
    /// # Errors
    /// When the process has never been ready, and has ended because its arguments are wrong or
    /// because it runs in the domain already.
    pub(crate) fn supervise(
        &mut self,
        feed: Option<&HealthFeed>,
        now: BootTime,
    ) -> Result<(), Failure> {
        match &mut self.state {
            ChildState::Running(running) => {
                if let Ok(Some(status)) = running.child.try_wait() {
                    return self.ended(status, now);
                }
                self.watch(feed, now);
            }
            ChildState::Waiting { until } if *until <= now => self.start_again(now),
            ChildState::Waiting { .. } => {}
        }
        Ok(())
    }

    fn watch(&mut self, feed: Option<&HealthFeed>, now: BootTime) {
        let ChildState::Running(running) = &mut self.state else {
            return;
        };
        if let Some(killing) = &mut running.killing {
            killing.escalate(&mut running.child, now);
            return;
        }
        match feed {
            None => running.watch.excuse(now),
            Some(feed) => {
                if let Some(report) = feed.report(running.child.id()) {
                    running.watch.observe(report, now);
                    // Before its first report, SIGHUP would end the process.
                    if std::mem::take(&mut self.wants_reload) {
                        send(&running.child, Signal::HUP);
                    }
                }
            }
        }
        let verdict = running.watch.poll(now);
        let is_stalled = !running.watch.is_starting() && running.watch.silence(now) > STALLED;
        if std::mem::replace(&mut running.is_stalled, is_stalled) != is_stalled {
            let silence = if is_stalled {
                running.watch.silence(now)
            } else {
                Duration::ZERO
            };
            self.since_ns = wall_ns().saturating_sub(silence.as_nanos() as u64);
        }
        if running.ready.is_none() && !running.watch.is_starting() {
            running.ready = Some(now);
            self.became_ready();
        }
        if let Some(silence) = verdict {
            self.kill_stalled(silence, now);
        }
    }

    fn became_ready(&mut self) {
        self.has_been_ready = true;
        self.since_ns = wall_ns();
        if self.trouble.take().is_some_and(|trouble| trouble.is_logged) {
            let (program, pid) = (
                self.command.process.program(),
                self.pid().unwrap_or_default(),
            );
            tracing::info!("{program} runs again (process {pid})");
        }
    }

    /// Ends a process without progress. The line in the log says what was seen and done; its
    /// end and its restart add none.
    fn kill_stalled(&mut self, silence: Duration, now: BootTime) {
        let ChildState::Running(running) = &mut self.state else {
            return;
        };
        let worked_for = running.worked_for();
        let end = self.streak.on_end(NO_PROGRESS, worked_for);
        let signal = if self.config.wants_core_dump {
            "SIGABRT, for a core dump"
        } else {
            "SIGKILL"
        };
        if end.is_logged {
            tracing::error!(
                "{} (process {}) has made no progress for {:.1} s; ending it with {signal}, and \
                 starting it again {:?} later{}",
                self.command.process.program(),
                running.child.id(),
                silence.as_secs_f64(),
                end.delay,
                in_a_row(end.n_ends),
            );
        }
        running.killing = Some(Killing::begin(&mut running.child, &self.config, now));
        self.fail(NO_PROGRESS.to_owned(), end.is_logged);
    }

    /// Notes the end of the process and sets the instant of its restart.
    fn ended(&mut self, status: ExitStatus, now: BootTime) -> Result<(), Failure> {
        let program = self.command.process.program();
        let code = status.code().and_then(|code| u8::try_from(code).ok());
        let is_final = matches!(code, Some(exit_code::USAGE | exit_code::ALREADY_RUNNING));
        if let Some(code) = code.filter(|_| is_final && !self.has_been_ready) {
            let sentence = format!("{program} cannot run, see its message above");
            return Err(Failure::new(code, sentence));
        }
        let ChildState::Running(running) = &self.state else {
            return Ok(());
        };
        if running.killing.is_some() {
            // Counted and logged when it was killed.
            let until = now + self.streak.last_delay();
            self.state = ChildState::Waiting { until };
            return Ok(());
        }
        let worked_for = running.worked_for();
        self.retry(&status.to_string(), "has ended", worked_for, now);
        Ok(())
    }

    fn start_again(&mut self, now: BootTime) {
        self.wants_reload = false;
        match RunningProcess::start(&self.command, &self.config, now) {
            Ok(running) => self.state = ChildState::Running(running),
            Err(failure) => {
                self.retry(&failure.sentence, "was not started", Duration::ZERO, now);
            }
        }
    }

    /// Sets the instant of the next attempt to start the process.
    fn retry(&mut self, cause: &str, event: &str, worked_for: Duration, now: BootTime) {
        let end = self.streak.on_end(cause, worked_for);
        if end.is_logged {
            tracing::warn!(
                "{} {event} ({cause}); starting it again in {:?}{}",
                self.command.process.program(),
                end.delay,
                in_a_row(end.n_ends),
            );
        }
        self.state = ChildState::Waiting {
            until: now + end.delay,
        };
        self.fail(cause.to_owned(), end.is_logged);
    }

    /// Notes that the process does not work. A streak of ends keeps the time of its first one.
    fn fail(&mut self, cause: String, is_logged: bool) {
        if self.trouble.is_none() {
            self.since_ns = wall_ns();
        }
        let was_logged = self.trouble.as_ref().is_some_and(|t| t.is_logged);
        self.trouble = Some(Trouble {
            cause,
            is_logged: is_logged || was_logged,
        });
    }

    /// Sends SIGTERM to the child process.
    pub(crate) fn ask_to_stop(&self) {
        if let ChildState::Running(running) = &self.state {
            send(&running.child, Signal::TERM);
        }
    }

    /// True if the child process has ended.
    pub(crate) fn has_ended(&mut self) -> bool {
        match &mut self.state {
            ChildState::Running(running) => !matches!(running.child.try_wait(), Ok(None)),
            ChildState::Waiting { .. } => true,
        }
    }

    /// Kills the process and waits for its end.
    pub(crate) fn kill(&mut self) {
        if let ChildState::Running(running) = &mut self.state {
            let _ = running.child.kill();
            let _ = running.child.wait();
        }
    }
}

impl RunningProcess {
    fn start(
        command: &ProcessCommand,
        config: &SupervisionConfig,
        now: BootTime,
    ) -> Result<Self, Failure> {
        let limits = config.progress_limits(command.process);
        Ok(Self {
            child: program::spawn(command)?,
            watch: ProgressWatch::new(limits, now),
            ready: None,
            is_stalled: false,
            killing: None,
        })
    }

    /// Time from readiness to the last progress.
    fn worked_for(&self) -> Duration {
        let ready = self.ready.unwrap_or(BootTime::MAX);
        self.watch.progressed().saturating_sub(ready)
    }
}

impl Killing {
    fn begin(child: &mut OsChild, config: &SupervisionConfig, now: BootTime) -> Self {
        if !config.wants_core_dump {
            let _ = child.kill();
            return Self { kill_at: None };
        }
        send(child, Signal::ABORT);
        // A stopped process acts on SIGABRT only when it is continued.
        send(child, Signal::CONT);
        Self {
            kill_at: Some(now + CORE_DUMP_TIME),
        }
    }

    /// Sends SIGKILL to a process that SIGABRT has not ended in time.
    fn escalate(&mut self, child: &mut OsChild, now: BootTime) {
        if self.kill_at.is_some_and(|kill_at| kill_at <= now) {
            let _ = child.kill();
            self.kill_at = None;
        }
    }
}

fn send(child: &OsChild, signal: Signal) {
    if let Some(pid) = Pid::from_raw(child.id().cast_signed()) {
        let _ = kill_process(pid, signal);
    }
}

fn wall_ns() -> u64 {
    wall_clock_ns().max(0) as u64
}

/// Number of the end in its streak, for the log; empty for the first one.
fn in_a_row(n_ends: u32) -> String {
    match n_ends {
        0 | 1 => String::new(),
        n => format!(" ({n} ends in a row)"),
    }
}
