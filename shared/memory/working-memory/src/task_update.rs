//! Task update: start and end of tasks, with their facts and events.

use crate::event::EventKind;
use crate::fact::{Property, Subject, ValueRef};
use crate::task::{NewTask, Task, TaskEnd, TaskRefusal};
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

    /// Ends a task. A repeated request gets the same answer.
    ///
    /// # Errors
    ///
    /// When there is no such task, or another request has ended it; nothing changed.
    pub fn end_task(&mut self, end: &TaskEnd, now_ns: u64) -> Result<&Task, TaskRefusal> {
        let done = self.tasks.end(end, now_ns, &mut self.dirty)?;
        if let RequestEffect::Now(task) = done {
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

    fn task_of(&self, done: RequestEffect) -> Result<&Task, TaskRefusal> {
        let (RequestEffect::Now(task) | RequestEffect::Before(task)) = done;
        self.tasks.get(task).ok_or(TaskRefusal::Unknown { task })
    }
}
