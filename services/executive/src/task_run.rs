//! Running task: its state machine, driven by what the robot reports.

mod journal;
mod looking;
mod moving;
mod order;
mod planning;
mod task_report;
mod transport_record;
mod way_home;

use crate::config::Config;
use crate::robot::{ArmDriver, SceneWatch};
use control_protocol::{RecordedStep, Refusal, TaskOrder, TaskOutcome};
use daemon_client::DaemonLink;
use journal::Journal;
use scene_document::TaskDocument;
use service::{CommonArguments, Failure};
use std::sync::Arc;
use std::time::Duration;
use tasks::{
    CarryStep, MachineState, Selection, StepState, TableObject, TaskGoal, TaskPhase, TaskRules,
    TaskSignal, n_attempts, object_words, report,
};
use transport_record::TransportRecord;

/// Number of ways from where the arm is that are tried, before it tries something else. Chosen.
const N_WAYS_MAX: u32 = 2;

/// The robot as a task uses it.
pub(crate) struct Robot<'a> {
    pub(crate) link: &'a mut DaemonLink,
    pub(crate) watch: &'a mut SceneWatch,
    pub(crate) common: &'a CommonArguments,
}

/// Running or ended task.
pub(crate) struct TaskRun {
    number: u64,
    order: TaskOrder,
    author: String,
    goal: TaskGoal,
    config: Arc<Config>,
    rules: TaskRules,
    state: MachineState,
    steps: Vec<CarryStep>,
    /// Transport of the present step.
    record: Option<TransportRecord>,
    /// Transports that have failed, with the tracks of their objects: another attempt has another grasp.
    failed: Vec<(u64, TransportRecord)>,
    /// Object of the present step as it stood before it was grasped.
    stood: Option<TableObject>,
    driver: ArmDriver,
    journal: Journal,
    selection: Selection,
    is_paused: bool,
    /// Cause of a wait, in words; empty while the task goes on.
    waits_for: String,
    /// Reason of the newest failure, a sentence without its full stop.
    reason: String,
    /// Report of the ended task.
    outcome: String,
    /// Time of the watch at the last look.
    now: Duration,
    /// True if that is the time of a source in lockstep.
    is_lockstep: bool,
    /// Time at which the phase began; `None` before the first look.
    phase_began: Option<Duration>,
    /// End of the time that is charged for a planning in lockstep.
    planned_until: Duration,
    /// True if the motions of the phase were begun.
    is_begun: bool,
    /// Newest primitive of the present step.
    primitive: TaskPhase,
    /// Number of tries of the way home, or of a transport that goes on.
    n_tries: u32,
}

impl TaskRun {
    /// Task of an order, with the number that the memory has given it.
    ///
    /// # Errors
    /// A refusal about an order that cannot be carried out.
    pub(crate) fn new(
        number: u64,
        (order, author): (TaskOrder, String),
        config: Arc<Config>,
    ) -> Result<Self, Refusal> {
        Ok(Self {
            number,
            goal: order::goal(&order, &config)?,
            order,
            author,
            rules: config.rules.clone(),
            config,
            state: MachineState::START,
            steps: Vec::new(),
            record: None,
            failed: Vec::new(),
            stood: None,
            driver: ArmDriver::default(),
            journal: Journal::default(),
            selection: Selection::default(),
            is_paused: false,
            waits_for: String::new(),
            reason: String::new(),
            outcome: String::new(),
            now: Duration::ZERO,
            is_lockstep: false,
            phase_began: None,
            planned_until: Duration::ZERO,
            is_begun: false,
            primitive: TaskPhase::Plan,
            n_tries: 0,
        })
    }

    /// Task that an earlier executive began, from its record alone. `is_holding` tells whether the
    /// gripper holds something.
    ///
    /// # Errors
    /// A refusal about an order that cannot be carried out any more.
    pub(crate) fn restored(
        document: &TaskDocument,
        order: TaskOrder,
        config: Arc<Config>,
        is_holding: bool,
    ) -> Result<Self, Refusal> {
        let author = document.author.clone();
        let mut task = Self::new(document.task_id, (order, author), config)?;
        task.steps = document.steps.iter().map(step_of).collect();
        let open = document.steps.last();
        let open = open.filter(|_| task.steps.last().is_some_and(|step| step.state.is_open()));
        let record = open.and_then(|step| serde_json::from_str(&step.plan).ok());
        task.record = record.filter(|_| is_holding);
        task.state = MachineState::restored(task.record.is_some());
        let primitive = open.and_then(|step| TaskPhase::from_word(&step.primitive));
        task.primitive = primitive.unwrap_or(TaskPhase::Plan);
        if task.record.is_some() {
            task.change_step(StepState::Held);
        } else if open.is_some() {
            task.reason = "the executive was started anew during the attempt".into();
            task.change_step(StepState::Failed);
        }
        Ok(task)
    }

    /// Number of the task.
    pub(crate) fn number(&self) -> u64 {
        self.number
    }

    /// True if the task has ended and the memory knows it.
    pub(crate) fn is_over(&self) -> bool {
        self.has_ended() && self.journal.is_empty()
    }

    /// True if the task has ended.
    pub(crate) fn has_ended(&self) -> bool {
        self.state.phase.is_end()
    }

    /// Lets the arm rest and the task wait.
    pub(crate) fn pause(&mut self) {
        self.is_paused = true;
        self.waits_for = "the task is paused; `tabula task resume` lets it go on".into();
        tracing::info!("task {}: paused", self.number);
    }

    /// Lets the task go on after a pause or a stop.
    pub(crate) fn resume(&mut self, robot: &mut Robot<'_>) {
        tracing::info!("task {}: resumed", self.number);
        self.is_paused = false;
        self.waits_for.clear();
        if self.state.phase == TaskPhase::Halt {
            let report = self.driver.look(robot.link);
            let is_holding = report.is_ok_and(|report| report.is_holding);
            let has_object = is_holding && self.record.is_some();
            self.advance(if has_object {
                TaskSignal::ResumedWithObject
            } else {
                TaskSignal::ResumedEmpty
            });
        }
    }

    /// Cancels the task, which sets down what the hand holds.
    pub(crate) fn cancel(&mut self) {
        tracing::info!("task {}: cancelled", self.number);
        self.is_paused = false;
        self.reason = "the task was cancelled".into();
        self.advance(TaskSignal::Cancel);
    }

    /// Ends the task because the daemon stops; the arm rests.
    pub(crate) fn abandon(&mut self, robot: &mut Robot<'_>) {
        let holds = if self.driver.is_holding() {
            ", with an object in the hand"
        } else {
            ""
        };
        self.reason = format!("the daemon was stopped{holds}");
        self.state.phase = TaskPhase::Cancelled;
        self.end(robot);
    }

    /// Looks at the robot once, and advances the task.
    ///
    /// # Errors
    /// When shared memory fails.
    pub(crate) fn tick(&mut self, robot: &mut Robot<'_>) -> Result<(), Failure> {
        robot.watch.poll()?;
        self.tell_time(robot.watch);
        if let Err(unanswered) = self.journal.flush(self.number, robot.link) {
            tracing::warn!("task {}: not recorded yet: {unanswered}", self.number);
        }
        if self.has_ended() || self.is_waiting(robot) || self.is_charged(robot) {
            return Ok(());
        }
        if let Some(signal) = self.signal(robot)? {
            self.advance(signal);
            robot.watch.begin_look();
            if self.has_ended() {
                self.end(robot);
            } else if self.needs_no_arm() {
                self.driver.release(robot.link);
            }
        }
        Ok(())
    }

    /// True in the phases in which the arm is out of sight, and free for other commanders.
    fn needs_no_arm(&self) -> bool {
        matches!(
            self.state.phase,
            TaskPhase::Look | TaskPhase::Ask | TaskPhase::CheckPlace
        )
    }

    /// Signal of the present phase, if it has ended.
    fn signal(&mut self, robot: &mut Robot<'_>) -> Result<Option<TaskSignal>, Failure> {
        Ok(match self.state.phase {
            TaskPhase::Look => self.look(robot),
            TaskPhase::Choose => Some(self.choose(robot)),
            TaskPhase::Ask => self.ask(robot),
            TaskPhase::Plan => self.plan(robot)?,
            TaskPhase::Replan => self.replan(robot)?,
            TaskPhase::CheckLift => self.check_lift(robot),
            TaskPhase::CheckPlace => self.check_place(robot),
            TaskPhase::Leave | TaskPhase::Return => self.go_home(robot)?,
            TaskPhase::Reach
            | TaskPhase::Approach
            | TaskPhase::Close
            | TaskPhase::Lift
            | TaskPhase::Carry
            | TaskPhase::Lower
            | TaskPhase::Release
            | TaskPhase::Retreat
            | TaskPhase::SetBack
            | TaskPhase::LetGo => self.carry_out(robot),
            TaskPhase::Halt | TaskPhase::Succeeded | TaskPhase::Failed | TaskPhase::Cancelled => {
                None
            }
        })
    }

    /// Moves the machine by a signal, and records what that means for the present step.
    fn advance(&mut self, signal: TaskSignal) {
        let before = self.state;
        self.state = before.after(signal);
        if self.state == before {
            return;
        }
        self.primitive = before.phase;
        match (before.phase, signal) {
            (TaskPhase::Close, TaskSignal::Done) => self.change_step(StepState::Held),
            (TaskPhase::CheckPlace, TaskSignal::Done) => self.change_step(StepState::Succeeded),
            _ => {}
        }
        let is_over = self.has_ended() || self.state.phase == TaskPhase::Look;
        if is_over && self.steps.last().is_some_and(|step| step.state.is_open()) {
            self.change_step(StepState::Failed);
            let track = self.steps.last().map(|step| step.track);
            self.failed.extend(track.zip(self.record.take()));
        }
        self.phase_began = Some(self.now);
        self.is_begun = false;
        if self.state.phase != TaskPhase::Halt {
            self.waits_for.clear();
        }
        self.tell(before.phase, signal);
    }

    /// Logs a change of the phase.
    fn tell(&self, before: TaskPhase, signal: TaskSignal) {
        let (number, phase) = (self.number, self.state.phase.word());
        let of = self.present_step().map_or_else(String::new, |step| {
            let name = object_words(step.track, step.label.as_deref());
            format!(" of {name}")
        });
        match signal {
            TaskSignal::Failure
            | TaskSignal::Dropped
            | TaskSignal::Stopped
            | TaskSignal::GoalMissed => {
                let (failed, reason) = (before.word(), &self.reason);
                tracing::warn!("task {number}: {failed}{of} failed: {reason}; next: {phase}");
            }
            TaskSignal::Done
            | TaskSignal::NothingLeft
            | TaskSignal::NamesNeeded
            | TaskSignal::ResumedWithObject
            | TaskSignal::ResumedEmpty
            | TaskSignal::Cancel => tracing::info!("task {number}: {phase}{of}"),
        }
    }

    /// Step under way; `None` between two of them.
    fn present_step(&self) -> Option<&CarryStep> {
        self.steps.last().filter(|step| step.state.is_open())
    }

    /// Begins a step, which the memory records before the arm moves.
    fn begin_step(&mut self, step: CarryStep) {
        self.record = None;
        self.n_tries = 0;
        self.reason.clear();
        self.steps.push(step);
        self.primitive = TaskPhase::Plan;
        self.record_step();
    }

    fn change_step(&mut self, state: StepState) {
        let reason = self.reason.clone();
        if let Some(step) = self.steps.last_mut() {
            step.state = state;
            if state == StepState::Failed {
                step.reason = reason;
            }
        }
        self.record_step();
    }

    /// Sends the newest step to the memory.
    fn record_step(&mut self) {
        let Some(step) = self.steps.last() else {
            return;
        };
        let plan = self.record.as_ref().map(serde_json::to_string);
        self.journal.step(RecordedStep {
            number: self.steps.len() as u64,
            state: step.state.word().to_owned(),
            primitive: self.primitive.word().to_owned(),
            track_id: step.track,
            label: step.label.clone(),
            place: Some(step.place.clone()),
            attempt: n_attempts(&self.steps, step.track),
            reason: step.reason.clone(),
            plan: plan.and_then(Result::ok).unwrap_or_default(),
        });
    }

    /// Ends the task: the arm rests, and the memory gets the report.
    fn end(&mut self, robot: &mut Robot<'_>) {
        self.driver.release(robot.link);
        let report = report(&self.goal, &self.steps, &self.selection.left);
        let (outcome, sentence) = match self.state.phase {
            TaskPhase::Succeeded => (TaskOutcome::Succeeded, report),
            TaskPhase::Cancelled => {
                let sentence = format!("The task was cancelled: {}. {report}", self.reason);
                (TaskOutcome::Cancelled, sentence)
            }
            _ => {
                let sentence = format!("The task has failed: {}. {report}", self.reason);
                (TaskOutcome::Failed, sentence)
            }
        };
        tracing::info!("task {}: {sentence}", self.number);
        self.outcome.clone_from(&sentence);
        self.journal.end(outcome, sentence);
    }

    /// Takes the time of a look. It begins anew when the source turns out to be in lockstep.
    fn tell_time(&mut self, watch: &SceneWatch) {
        self.now = watch.now();
        if self.is_lockstep != watch.is_lockstep() {
            self.is_lockstep = watch.is_lockstep();
            self.phase_began = None;
        }
        self.phase_began.get_or_insert(self.now);
    }

    /// Time since the begin of the phase.
    fn elapsed(&self) -> Duration {
        let began = self.phase_began.unwrap_or(self.now);
        self.now.saturating_sub(began)
    }

    /// Failure of the phase with its reason, a sentence without its full stop.
    fn fail(&mut self, reason: impl Into<String>) -> TaskSignal {
        self.reason = reason.into();
        TaskSignal::Failure
    }
}

/// Step of a record.
fn step_of(recorded: &scene_document::TaskStepDocument) -> CarryStep {
    CarryStep {
        track: recorded.track_id,
        label: recorded.label.clone(),
        place: recorded.place.clone().unwrap_or_default(),
        state: StepState::from_word(&recorded.state).unwrap_or(StepState::Failed),
        reason: recorded.reason.clone(),
    }
}
