//! The tasks that run, and those that ended.

use std::collections::BTreeMap;

use super::event::Happening;
use super::expiry::Expiry;
use super::fact::{Claim, Property, Subject};
use super::keys::Entry;
use super::task::{NewTask, Task, TaskEnd, TaskRefusal, TaskState};
use super::touched::Touched;
use super::world_config::WorldConfig;
use super::world_model::WorldModel;

/// Most tasks that run at once: what is never ended would fill the memory.
const MAX_RUNNING: usize = 1000;

#[derive(Debug, Default)]
pub(super) struct TaskTable {
    tasks: BTreeMap<u64, Task>,
    by_start_id: BTreeMap<u128, u64>,
    over: Expiry,
    n_running: usize,
    /// Number of the newest task; zero before the first.
    pub(super) newest: u64,
}

/// Whether a request changed something, or was answered before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Done {
    Now(u64),
    Before(u64),
}

impl TaskTable {
    fn start(
        &mut self,
        new: &NewTask,
        now_ns: u64,
        touched: &mut Touched,
    ) -> Result<Done, TaskRefusal> {
        if let Some(&number) = self.by_start_id.get(&new.id.0) {
            return Ok(Done::Before(number));
        }
        new.check()?;
        if self.n_running >= MAX_RUNNING {
            return Err(TaskRefusal::TooMany {
                n_running: self.n_running,
            });
        }
        let number = self.newest + 1;
        self.insert(Task {
            number,
            kind: new.kind.clone(),
            parameters: new.parameters.clone(),
            author: new.author.clone(),
            started_ns: now_ns,
            state: TaskState::Running,
            start_id: new.id.0,
        });
        touched.add(Entry::Task(number));
        touched.add(Entry::Meta);
        Ok(Done::Now(number))
    }

    fn end(
        &mut self,
        end: &TaskEnd,
        now_ns: u64,
        touched: &mut Touched,
    ) -> Result<Done, TaskRefusal> {
        let task = end.task;
        let known = self.tasks.get_mut(&task);
        let known = known.ok_or(TaskRefusal::Unknown { task })?;
        match known.state {
            TaskState::Ended { end_id, .. } if end_id == end.id.0 => Ok(Done::Before(task)),
            TaskState::Ended { .. } => Err(TaskRefusal::HasEnded { task }),
            TaskState::Running => {
                end.check()?;
                let ended_ns = now_ns.max(known.started_ns);
                known.state = TaskState::Ended {
                    outcome: end.outcome,
                    reason: end.reason.clone(),
                    ended_ns,
                    end_id: end.id.0,
                };
                self.over.insert(ended_ns, task);
                self.n_running -= 1;
                touched.add(Entry::Task(task));
                Ok(Done::Now(task))
            }
        }
    }

    pub(super) fn insert(&mut self, task: Task) {
        self.newest = self.newest.max(task.number);
        self.by_start_id.insert(task.start_id, task.number);
        match task.state {
            TaskState::Running => self.n_running += 1,
            TaskState::Ended { ended_ns, .. } => self.over.insert(ended_ns, task.number),
        }
        self.tasks.insert(task.number, task);
    }

    pub(super) fn get(&self, number: u64) -> Option<&Task> {
        self.tasks.get(&number)
    }

    pub(super) fn all(&self) -> impl Iterator<Item = &Task> {
        self.tasks.values()
    }

    /// The tasks before a number, newest first.
    pub(super) fn before(&self, number: u64) -> impl Iterator<Item = &Task> {
        self.tasks.range(..number).rev().map(|(_, task)| task)
    }

    /// Forgets one task that is to be forgotten; false when there is none.
    pub(super) fn expire(
        &mut self,
        now_ns: u64,
        config: &WorldConfig,
        touched: &mut Touched,
    ) -> bool {
        let due = self.over.take(now_ns, config.keep_ns, config.n_kept_most);
        let Some(task) = due.and_then(|number| self.tasks.remove(&number)) else {
            return false;
        };
        self.by_start_id.remove(&task.start_id);
        touched.add(Entry::Task(task.number));
        true
    }
}

impl WorldModel {
    /// Begins a task; the same request again gets the same task.
    ///
    /// # Errors
    ///
    /// When a text is too long or too many tasks run; nothing changed.
    pub fn start_task(&mut self, new: &NewTask, now_ns: u64) -> Result<&Task, TaskRefusal> {
        let done = self.tasks.start(new, now_ns, &mut self.touched)?;
        if let Done::Now(task) = done {
            let (config, touched) = (&self.config, &mut self.touched);
            let subject = Subject::Task(task);
            let running = Claim::State("running");
            self.facts.claim(subject, running, now_ns, config, touched);
            let kind = new.kind.clone();
            self.events
                .add(Happening::TaskStarted { task, kind }, now_ns, touched);
        }
        self.task_of(done)
    }

    /// Ends a task; the same request again gets the same answer.
    ///
    /// # Errors
    ///
    /// When there is no such task, or another request has ended it; nothing changed.
    pub fn end_task(&mut self, end: &TaskEnd, now_ns: u64) -> Result<&Task, TaskRefusal> {
        let done = self.tasks.end(end, now_ns, &mut self.touched)?;
        if let Done::Now(task) = done {
            let touched = &mut self.touched;
            self.facts
                .cease(Subject::Task(task), Property::State, now_ns, touched);
            let kind = self.tasks.get(task).map(|task| task.kind.clone());
            let ended = Happening::TaskEnded {
                task,
                kind: kind.unwrap_or_default(),
                outcome: end.outcome,
                reason: end.reason.clone(),
            };
            self.events.add(ended, now_ns, touched);
        }
        self.task_of(done)
    }

    fn task_of(&self, done: Done) -> Result<&Task, TaskRefusal> {
        let (Done::Now(task) | Done::Before(task)) = done;
        self.tasks.get(task).ok_or(TaskRefusal::Unknown { task })
    }
}
