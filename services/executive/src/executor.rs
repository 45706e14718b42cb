//! Executor: the thread that carries out one task after another, and answers requests about them.

use crate::config::Config;
use crate::robot::{ArmDriver, SceneWatch};
use crate::task_requests::WaitingTaskRequest;
use crate::task_run::{Robot, TaskRun};
use capture::{Follower, FrameFollower};
use control_protocol::{
    MutationId, Refusal, RefusalKind, TaskCommand, TaskOrder, TaskOutcome, TaskReport, request,
};
use crossbeam::channel::Receiver;
use daemon_client::{DaemonLink, RunFolder, Unanswered};
use message::ProcessKind;
use scene_document::TaskDocument;
use service::{CommonArguments, Context, Failure, LiveConfig};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// Time limit of a call. Chosen: less than the silence after which a lease of the arm ends.
const CALL_DEADLINE: Duration = Duration::from_millis(400);
/// Period of the looks at a running task: the lease of the arm is renewed every 100 ms at least.
const TASK_PERIOD: Duration = Duration::from_millis(25);
/// Period of the looks at a source in lockstep, which waits for each.
const LOCKSTEP_PERIOD: Duration = Duration::from_millis(1);
/// Time for which a request is awaited without a task.
const IDLE_PERIOD: Duration = Duration::from_millis(200);
/// Time for which a preview awaits a scene.
const PREVIEW_PATIENCE: Duration = Duration::from_secs(2);
/// Time between two questions about a task that an earlier executive has left.
const RESTORE_PERIOD: Duration = Duration::from_secs(1);
/// Time for which an unfinished record is kept when the process stops.
const LAST_RECORD: Duration = Duration::from_millis(500);

/// Executor of tasks.
pub(crate) struct Executor {
    context: Context,
    live: LiveConfig<Config>,
    common: CommonArguments,
    link: DaemonLink,
    watch: Option<SceneWatch>,
    /// Follower of a source in lockstep.
    follower: FrameFollower,
    /// Running or last task.
    task: Option<TaskRun>,
    /// Number of the request that started the task.
    started_by: Option<MutationId>,
    /// Time of the next question about a task that was left; `None` once that is known.
    restore_at: Option<Instant>,
}

impl Executor {
    /// Executor in the domain of a process.
    ///
    /// # Errors
    /// When a topic has no room for it, or shared memory fails.
    pub(crate) fn new(
        context: Context,
        live: LiveConfig<Config>,
        common: CommonArguments,
    ) -> Result<Self, Failure> {
        let own = Follower::Process(ProcessKind::EXECUTIVE);
        let before = [ProcessKind::PERCEPTION, ProcessKind::MEMORY];
        Ok(Self {
            follower: FrameFollower::polled(&context.domain, own, &before)?,
            link: DaemonLink::new(
                context.domain.name().clone(),
                RunFolder::of_user(),
                CALL_DEADLINE,
            ),
            context,
            live,
            common,
            watch: None,
            task: None,
            started_by: None,
            restore_at: Some(Instant::now()),
        })
    }

    /// Runs until shutdown.
    ///
    /// # Errors
    /// When shared memory fails.
    pub(crate) fn run(mut self, requests: &Receiver<WaitingTaskRequest>) -> Result<(), Failure> {
        while !self.context.shutdown.is_requested() {
            self.context.health.record_progress();
            self.restore();
            if let Ok(request) = requests.recv_timeout(self.period()) {
                let answer = self.answer(request.command.clone());
                request.answer(answer);
            }
            match self.follower.next_frame()? {
                Some(frame) => {
                    self.work()?;
                    self.follower.report(frame)?;
                }
                None if self.follower.is_in_lockstep() => self.receive()?,
                None => self.work()?,
            }
        }
        self.stop();
        Ok(())
    }

    /// Time for which a request is awaited.
    fn period(&self) -> Duration {
        let is_running = self.task.as_ref().is_some_and(|task| !task.is_over());
        match is_running {
            _ if self.follower.is_in_lockstep() => LOCKSTEP_PERIOD,
            true => TASK_PERIOD,
            false => IDLE_PERIOD,
        }
    }

    /// Receives what has come, so that no topic overflows while a frame is in work.
    fn receive(&mut self) -> Result<(), Failure> {
        let watch = self.watch.as_mut();
        watch.map_or(Ok(()), SceneWatch::poll)
    }

    /// Advances the running task; without one the topics of the camera are left.
    fn work(&mut self) -> Result<(), Failure> {
        let Some(task) = self.task.as_mut().filter(|task| !task.is_over()) else {
            self.watch = None;
            return Ok(());
        };
        let mut robot = robot(&self.context, &mut self.watch, &mut self.link, &self.common)?;
        task.tick(&mut robot)
    }

    fn answer(&mut self, command: TaskCommand) -> Result<TaskReport, Refusal> {
        match command {
            TaskCommand::State => {
                let report = self.task.as_ref().map(TaskRun::report);
                Ok(report.unwrap_or_default())
            }
            TaskCommand::Preview(order) => self.preview(order),
            TaskCommand::Start { id, author, order } => self.start(id, author, order),
            TaskCommand::Pause { task_id } => {
                let (task, _) = self.running(task_id)?;
                task.pause();
                Ok(task.report())
            }
            TaskCommand::Resume { task_id } => {
                let (task, mut robot) = self.running(task_id)?;
                task.resume(&mut robot);
                Ok(task.report())
            }
            TaskCommand::Cancel { task_id } => {
                let (task, _) = self.running(task_id)?;
                task.cancel();
                Ok(task.report())
            }
        }
    }

    /// The running task, if it has a number.
    fn running(&mut self, number: u64) -> Result<(&mut TaskRun, Robot<'_>), Refusal> {
        let task = self.task.as_mut().filter(|task| !task.has_ended());
        let Some(task) = task.filter(|task| task.number() == number) else {
            let sentence = format!("task {number} does not run; see `tabula task list`");
            return Err(Refusal::new(RefusalKind::NotFound, sentence));
        };
        let robot = robot(&self.context, &mut self.watch, &mut self.link, &self.common);
        Ok((task, robot.map_err(|failure| unavailable(&failure))?))
    }

    fn preview(&mut self, order: TaskOrder) -> Result<TaskReport, Refusal> {
        let config = self.live.get();
        let robot = robot(&self.context, &mut self.watch, &mut self.link, &self.common)
            .map_err(|failure| unavailable(&failure))?;
        await_scene(robot.watch, &mut self.follower).map_err(|failure| unavailable(&failure))?;
        if !robot.watch.is_fresh() {
            let sentence = "no scene has come for 2 s, so that nothing is known of the table; see \
                            `tabula status`";
            return Err(Refusal::new(RefusalKind::Unavailable, sentence));
        }
        TaskRun::preview(order, config, &robot)
    }

    /// Starts a task, which the memory records first.
    fn start(
        &mut self,
        id: MutationId,
        author: String,
        order: TaskOrder,
    ) -> Result<TaskReport, Refusal> {
        if let Some(task) = &self.task {
            if self.started_by == Some(id) {
                return Ok(task.report());
            }
            if !task.has_ended() {
                let number = task.number();
                let sentence = format!(
                    "task {number} runs; wait for its end, or cancel it with: tabula task cancel"
                );
                return Err(Refusal::new(RefusalKind::Conflict, sentence));
            }
        }
        self.check_hand()?;
        let config = self.live.get();
        // An order that cannot be carried out leaves no record.
        TaskRun::new(0, (order.clone(), author.clone()), config.clone())?;
        let kind = order.kind.word().to_owned();
        let parameters = serde_json::to_string(&order).unwrap_or_default();
        let recorded = request::start_task(id, kind, parameters, author.clone());
        let recorded = self.link.ask(&recorded).map_err(refusal_of_memory)?;
        let task = TaskRun::new(recorded.task_id, (order, author), config)?;
        tracing::info!("task {}: {} begins", recorded.task_id, recorded.kind);
        let report = task.report();
        self.task = Some(task);
        self.started_by = Some(id);
        Ok(report)
    }

    /// Refuses to start with something in the hand.
    fn check_hand(&mut self) -> Result<(), Refusal> {
        let report = self.link.ask(&request::arm()).map_err(refusal_of_memory)?;
        if report.is_holding {
            let sentence = "the hand holds something; set it down first, as by: tabula arm open";
            return Err(Refusal::new(RefusalKind::Conflict, sentence));
        }
        Ok(())
    }

    /// Takes up a task that an earlier executive of this daemon has left.
    fn restore(&mut self) {
        if self.restore_at.is_none_or(|at| Instant::now() < at) || self.task.is_some() {
            return;
        }
        self.restore_at = Some(Instant::now() + RESTORE_PERIOD);
        let Ok(page) = self.link.ask(&request::tasks(None, 16)) else {
            return;
        };
        let mut tasks = page.tasks.iter();
        let left = tasks.find_map(|task| {
            let order = serde_json::from_str::<TaskOrder>(&task.parameters).ok()?;
            let is_own = task.state == "running" && task.kind == order.kind.word();
            is_own.then_some((task.task_id, order))
        });
        let Some((number, order)) = left else {
            self.restore_at = None;
            return;
        };
        let known = self.link.ask(&request::task(number));
        if let (Ok(document), Ok(is_holding)) = (known, self.is_holding()) {
            self.restore_at = None;
            self.take_up(&document, order, is_holding);
        }
    }

    fn is_holding(&mut self) -> Result<bool, Unanswered> {
        let mut driver = ArmDriver::default();
        driver.look(&mut self.link).map(|report| report.is_holding)
    }

    /// Goes on with a task of this daemon; one of an earlier daemon has ended with it.
    fn take_up(&mut self, document: &TaskDocument, order: TaskOrder, is_holding: bool) {
        let number = document.task_id;
        let ended = if self.is_of_this_daemon(document) {
            match TaskRun::restored(document, order, self.live.get(), is_holding) {
                Ok(task) => {
                    tracing::info!("task {number}: goes on from its record");
                    self.task = Some(task);
                    return;
                }
                Err(refusal) => refusal.sentence,
            }
        } else {
            "the daemon was stopped while the task ran".to_owned()
        };
        tracing::warn!("task {number} has failed: {ended}");
        let id = MutationId::random().unwrap_or(MutationId(1));
        let end = request::end_task(id, number, TaskOutcome::Failed, ended);
        if let Err(unanswered) = self.link.ask(&end) {
            tracing::warn!("task {number}: its end is not recorded: {unanswered}");
        }
    }

    /// True if a task was started in the life of this daemon, whose folder is as old as it.
    fn is_of_this_daemon(&self, document: &TaskDocument) -> bool {
        let folder = std::fs::metadata(self.context.domain.folder());
        let created = folder.and_then(|folder| folder.created());
        let since = created.map(|at: SystemTime| at.duration_since(UNIX_EPOCH));
        let since_ns = since.ok().and_then(Result::ok).map(|age| age.as_nanos());
        since_ns.is_some_and(|since_ns| u128::from(document.started_ns) >= since_ns)
    }

    /// Ends the running task when the process stops.
    fn stop(&mut self) {
        let Some(task) = self.task.as_mut().filter(|task| !task.has_ended()) else {
            return;
        };
        let Ok(mut robot) = robot(&self.context, &mut self.watch, &mut self.link, &self.common)
        else {
            return;
        };
        task.abandon(&mut robot);
        let begun = Instant::now();
        while !task.is_over() && begun.elapsed() < LAST_RECORD {
            if task.tick(&mut robot).is_err() {
                return;
            }
            std::thread::sleep(TASK_PERIOD);
        }
    }
}

/// The robot, with the topics of the camera joined.
fn robot<'a>(
    context: &Context,
    watch: &'a mut Option<SceneWatch>,
    link: &'a mut DaemonLink,
    common: &'a CommonArguments,
) -> Result<Robot<'a>, Failure> {
    let watch = match watch {
        Some(watch) => watch,
        None => watch.insert(SceneWatch::new(&context.domain)?),
    };
    Ok(Robot {
        link,
        watch,
        common,
    })
}

/// Waits until a scene shows the present, or no longer than a preview may take.
fn await_scene(watch: &mut SceneWatch, follower: &mut FrameFollower) -> Result<(), Failure> {
    let begun = Instant::now();
    while !watch.is_fresh() && begun.elapsed() < PREVIEW_PATIENCE {
        if let Some(frame) = follower.next_frame()? {
            follower.report(frame)?;
        }
        watch.poll()?;
        std::thread::sleep(LOCKSTEP_PERIOD);
    }
    Ok(())
}

fn unavailable(failure: &Failure) -> Refusal {
    Refusal::new(RefusalKind::Unavailable, failure.to_string())
}

/// Refusal of a task because another process refuses its part, or does not answer.
fn refusal_of_memory(unanswered: Unanswered) -> Refusal {
    match unanswered {
        Unanswered::Refused(refusal) => refusal,
        Unanswered::NoAnswer(sentence) => Refusal::new(RefusalKind::Unavailable, sentence),
    }
}
