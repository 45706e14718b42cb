//! Task update: start, steps and end of tasks, with their facts and events.

use crate::event::{EventKind, StepChange};
use crate::fact::{Property, Subject, ValueRef};
use crate::task::{NewTask, Task, TaskEnd, TaskRefusal};
use crate::task_step::StepContent;
use crate::task_table::RequestEffect;
use crate::world_model::WorldModel;

impl WorldModel {
    /// Starts a task. A repeated request returns the same task.
    ///
    /// # Errors
    ///
    /// When a text is too long or too many tasks run; nothing changed.
    pub fn start_task(&mut self, new: &NewTask, now_ns: u64) -> Result<&Task, TaskRefusal> {
        let done = self.tasks.start(new, now_ns, &mut self.dirty)?;
        if let RequestEffect::Now(task) = done {
            let (config, dirty) = (&self.config, &mut self.dirty);
            let subject = Subject::Task(task);
            let running = ValueRef::State("running");
            self.facts
                .assert_fact(subject, running, now_ns, config, dirty);
            let kind = new.kind.clone();
            self.events
                .add(EventKind::TaskStarted { task, kind }, now_ns, dirty);
        }
        self.task_of(done)
    }

    /// Records a step of a running task: the next one, or another content of the newest one. The
    /// same content again changes nothing.
    ///
    /// # Errors
    ///
    /// When the task does not run, the step has another number or has ended with another content,
    /// the step before it has not ended, or a limit is exceeded; nothing changed, but for ended tasks
    /// that were forgotten to make room.
    pub fn record_step(
        &mut self,
        task: u64,
        content: StepContent,
        now_ns: u64,
    ) -> Result<&Task, TaskRefusal> {
        let (number, state) = (content.number, content.state);
        let known = self.tasks.get(task).and_then(|task| task.step(number));
        let is_other_state = known.is_none_or(|known| known.content.state != state);
        let done = self.tasks.record(task, content, now_ns, &mut self.dirty)?;
        if is_other_state {
            self.add_step_event(task, number, now_ns);
        }
        self.task_of(done)
    }

    /// Ends a task, and without success a step that is open. A repeated request gets the same
    /// answer.
    ///
    /// # Errors
    ///
    /// When there is no such task, or another request has ended it; nothing changed.
    pub fn end_task(&mut self, end: &TaskEnd, now_ns: u64) -> Result<&Task, TaskRefusal> {
        let open = self.tasks.get(end.task).and_then(Task::open_step);
        let open = open.map(|step| step.content.number);
        let done = self.tasks.end(end, now_ns, &mut self.dirty)?;
        if let RequestEffect::Now(task) = done {
            if let Some(open) = open {
                self.add_step_event(task, open, now_ns);
            }
            let dirty = &mut self.dirty;
            self.facts
                .retract(Subject::Task(task), Property::State, now_ns, dirty);
            let kind = self.tasks.get(task).map(|task| task.kind.clone());
            let ended = EventKind::TaskEnded {
                task,
                kind: kind.unwrap_or_default(),
                outcome: end.outcome,
                reason: end.reason.clone(),
            };
            self.events.add(ended, now_ns, dirty);
        }
        self.task_of(done)
    }

    /// Adds the event of a step that is in another state.
    fn add_step_event(&mut self, task: u64, number: u64, now_ns: u64) {
        let known = self.tasks.get(task);
        let Some((kind, step)) = known.and_then(|task| Some((&task.kind, task.step(number)?)))
        else {
            return;
        };
        let content = &step.content;
        let change = StepChange {
            task,
            kind: kind.clone(),
            step: number,
            track_id: content.track_id,
            state: content.state,
            primitive: content.primitive.clone(),
            reason: content.reason.clone(),
        };
        let event = EventKind::TaskStep(change);
        self.events.add(event, now_ns, &mut self.dirty);
    }

    fn task_of(&self, done: RequestEffect) -> Result<&Task, TaskRefusal> {
        let (RequestEffect::Now(task) | RequestEffect::Before(task)) = done;
        self.tasks.get(task).ok_or(TaskRefusal::Unknown { task })
    }
}
