//! Task table: running and ended tasks.

use std::collections::BTreeMap;

use crate::dirty_set::DirtySet;
use crate::expiry_queue::ExpiryQueue;
use crate::record_key::RecordKey;
use crate::task::{NewTask, Task, TaskEnd, TaskRefusal, TaskState};
use crate::task_step::{StepContent, StepRefusal};
use crate::world_config::WorldConfig;

/// Maximum number of running tasks, which bounds the memory if clients never end them. Chosen.
const MAX_RUNNING: usize = 1000;
/// Maximum size of the steps of all tasks, bytes, above which ended tasks are forgotten before
/// their time. Chosen.
const MAX_STEP_BYTES: usize = 64 << 20;

#[derive(Debug, Default)]
pub(crate) struct TaskTable {
    tasks: BTreeMap<u64, Task>,
    by_start_id: BTreeMap<u128, u64>,
    over: ExpiryQueue,
    n_running: usize,
    /// Size of the steps of all tasks, bytes.
    n_step_bytes: usize,
    /// Number of the newest task; zero before the first.
    pub(crate) newest: u64,
}

/// Effect of a request: applied now, or a repetition of an earlier one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum RequestEffect {
    Now(u64),
    Before(u64),
}

impl TaskTable {
    pub(crate) fn start(
        &mut self,
        new: &NewTask,
        now_ns: u64,
        dirty: &mut DirtySet,
    ) -> Result<RequestEffect, TaskRefusal> {
        if let Some(&number) = self.by_start_id.get(&new.id.0) {
            return Ok(RequestEffect::Before(number));
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
            steps: Vec::new(),
        });
        dirty.add(RecordKey::Task(number));
        dirty.add(RecordKey::Meta);
        Ok(RequestEffect::Now(number))
    }

    pub(crate) fn end(
        &mut self,
        end: &TaskEnd,
        now_ns: u64,
        dirty: &mut DirtySet,
    ) -> Result<RequestEffect, TaskRefusal> {
        let task = end.task;
        let known = self.tasks.get_mut(&task);
        let known = known.ok_or(TaskRefusal::Unknown { task })?;
        match known.state {
            TaskState::Ended { end_id, .. } if end_id == end.id.0 => {
                Ok(RequestEffect::Before(task))
            }
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
                self.n_step_bytes -= known.n_step_bytes();
                known.fail_open_step(end, ended_ns);
                self.n_step_bytes += known.n_step_bytes();
                self.over.insert(ended_ns, task);
                self.n_running -= 1;
                dirty.add(RecordKey::Task(task));
                Ok(RequestEffect::Now(task))
            }
        }
    }

    pub(crate) fn record(
        &mut self,
        task: u64,
        content: StepContent,
        now_ns: u64,
        dirty: &mut DirtySet,
    ) -> Result<RequestEffect, TaskRefusal> {
        let known = self.tasks.get(&task);
        let known = known.ok_or(TaskRefusal::Unknown { task })?;
        if known.has_step(&content) {
            return Ok(RequestEffect::Before(task));
        }
        if known.state != TaskState::Running {
            return Err(TaskRefusal::HasEnded { task });
        }
        known.check_step(&content)?;
        self.make_room(content.n_bytes(), dirty)?;
        if let Some(known) = self.tasks.get_mut(&task) {
            self.n_step_bytes -= known.n_step_bytes();
            known.put_step(content, now_ns);
            self.n_step_bytes += known.n_step_bytes();
            dirty.add(RecordKey::Task(task));
        }
        Ok(RequestEffect::Now(task))
    }

    /// Forgets the oldest ended tasks until another step has room.
    fn make_room(&mut self, n_bytes: usize, dirty: &mut DirtySet) -> Result<(), StepRefusal> {
        while self.n_step_bytes + n_bytes > MAX_STEP_BYTES {
            let oldest = self.over.take(u64::MAX, 0, 0);
            if !self.forget(oldest, dirty) {
                return Err(StepRefusal::Full {
                    n_bytes: self.n_step_bytes,
                });
            }
        }
        Ok(())
    }

    pub(crate) fn insert(&mut self, task: Task) {
        self.n_step_bytes += task.n_step_bytes();
        self.newest = self.newest.max(task.number);
        self.by_start_id.insert(task.start_id, task.number);
        match task.state {
            TaskState::Running => self.n_running += 1,
            TaskState::Ended { ended_ns, .. } => self.over.insert(ended_ns, task.number),
        }
        self.tasks.insert(task.number, task);
    }

    pub(crate) fn get(&self, number: u64) -> Option<&Task> {
        self.tasks.get(&number)
    }

    pub(crate) fn all(&self) -> impl Iterator<Item = &Task> {
        self.tasks.values()
    }

    /// Tasks with a smaller number, newest first.
    pub(crate) fn before(&self, number: u64) -> impl Iterator<Item = &Task> {
        self.tasks.range(..number).rev().map(|(_, task)| task)
    }

    /// Removes one expired task; `false` if there is none.
    pub(crate) fn expire(
        &mut self,
        now_ns: u64,
        config: &WorldConfig,
        dirty: &mut DirtySet,
    ) -> bool {
        let due = self.over.take(now_ns, config.keep_ns, config.n_kept_most);
        self.forget(due, dirty)
    }

    /// Removes a task; `false` if there is none.
    fn forget(&mut self, number: Option<u64>, dirty: &mut DirtySet) -> bool {
        let Some(task) = number.and_then(|number| self.tasks.remove(&number)) else {
            return false;
        };
        self.n_step_bytes -= task.n_step_bytes();
        self.by_start_id.remove(&task.start_id);
        dirty.add(RecordKey::Task(task.number));
        true
    }
}
