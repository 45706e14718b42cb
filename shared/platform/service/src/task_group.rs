//! Task group: the named long-running tasks of one process (structured concurrency).
//!
//! Each task should run until shutdown. When one ends before, by returning, by an
//! error or by a panic, the group stops the others and returns a [`Failure`] that
//! names the task and the reason: the process ends with a non-zero exit code, and
//! the service manager starts it again. On shutdown the tasks are stopped one after
//! another, the last one spawned first, within a time limit.

use crate::shutdown::ShutdownTrigger;
use crate::{Failure, Shutdown, exit_code};
use std::any::Any;
use std::future::Future;
use std::time::Duration;
use tokio::task::{AbortHandle, Id, JoinError, JoinSet};
use tokio::time::{Instant, timeout_at};

/// Named tasks that run until shutdown. Dropping the group aborts them.
#[derive(Debug)]
pub struct TaskGroup {
    running: JoinSet<Result<(), Failure>>,
    /// In the order of spawning.
    tasks: Vec<NamedTask>,
    stop_timeout: Duration,
}

#[derive(Debug)]
struct NamedTask {
    id: Id,
    name: &'static str,
    /// The request to stop; `None` for a task that is stopped by dropping its future.
    stop: Option<ShutdownTrigger>,
    abort: AbortHandle,
}

/// Output of a task's future: `()`, or a result whose error becomes a [`Failure`].
pub trait TaskOutcome {
    /// The output as a result.
    ///
    /// # Errors
    /// The task's own failure.
    fn into_result(self) -> Result<(), Failure>;
}

impl TaskOutcome for () {
    fn into_result(self) -> Result<(), Failure> {
        Ok(())
    }
}

impl<E: Into<Failure>> TaskOutcome for Result<(), E> {
    fn into_result(self) -> Result<(), Failure> {
        self.map_err(Into::into)
    }
}

type Joined = Result<(Id, Result<(), Failure>), JoinError>;

impl TaskGroup {
    /// Creates an empty group whose tasks get `stop_timeout` together to stop.
    pub fn new(stop_timeout: Duration) -> Self {
        Self {
            running: JoinSet::new(),
            tasks: Vec::new(),
            stop_timeout,
        }
    }

    /// Spawns a task that is stopped by dropping its future; within a tokio runtime.
    pub fn spawn<F>(&mut self, name: &'static str, task: F)
    where
        F: Future + Send + 'static,
        F::Output: TaskOutcome,
    {
        self.add(name, None, async { task.await.into_result() });
    }

    /// Spawns a task that ends by itself when its [`Shutdown`] is requested; within a
    /// tokio runtime. After the time limit its future is dropped.
    pub fn spawn_stoppable<F>(&mut self, name: &'static str, task: impl FnOnce(Shutdown) -> F)
    where
        F: Future + Send + 'static,
        F::Output: TaskOutcome,
    {
        let (trigger, stop) = Shutdown::new();
        let task = task(stop);
        self.add(name, Some(trigger), async { task.await.into_result() });
    }

    fn add(
        &mut self,
        name: &'static str,
        stop: Option<ShutdownTrigger>,
        task: impl Future<Output = Result<(), Failure>> + Send + 'static,
    ) {
        let abort = self.running.spawn(task);
        self.tasks.push(NamedTask {
            id: abort.id(),
            name,
            stop,
            abort,
        });
    }

    /// Runs until shutdown is requested or a task ends, then stops all tasks.
    ///
    /// # Errors
    /// The [`Failure`] of the first task that ended before shutdown or failed while
    /// stopping.
    pub async fn run_until(self, shutdown: &Shutdown) -> Result<(), Failure> {
        let requested = async {
            shutdown.requested().await;
            Ok(())
        };
        self.run(requested).await
    }

    /// Runs until the main future is ready or a task ends, then stops all tasks. The
    /// main future, which runs on the calling task, is dropped before that.
    ///
    /// # Errors
    /// The failure of the main future, or the [`Failure`] of the first task that ended
    /// before it or failed while stopping.
    pub async fn run<T>(
        mut self,
        main: impl Future<Output = Result<T, Failure>>,
    ) -> Result<T, Failure> {
        let outcome = {
            tokio::pin!(main);
            tokio::select! {
                biased;
                outcome = &mut main => outcome,
                Some(joined) = self.running.join_next_with_id() => {
                    Err(self.remove(joined).before_shutdown())
                }
            }
        };
        let stopped = self.stop().await;
        outcome.and_then(|value| stopped.map(|()| value))
    }

    /// Stops all tasks, the last one spawned first; returns the first failure.
    async fn stop(&mut self) -> Result<(), Failure> {
        let deadline = Instant::now() + self.stop_timeout;
        let mut outcome = Ok(());
        while let Some(task) = self.tasks.last() {
            let (id, name, abort) = (task.id, task.name, task.abort.clone());
            match &task.stop {
                Some(stop) => stop.request(),
                None => abort.abort(),
            }
            let ended = timeout_at(deadline, self.wait_for(id, &mut outcome)).await;
            if ended.is_err() {
                tracing::warn!("the task {name:?} did not stop in time and is abandoned");
                abort.abort();
                self.tasks.pop();
            }
        }
        outcome
    }

    /// Waits for the end of one task; keeps the first failure of all that end meanwhile.
    async fn wait_for(&mut self, id: Id, outcome: &mut Result<(), Failure>) {
        while self.tasks.iter().any(|task| task.id == id) {
            let Some(joined) = self.running.join_next_with_id().await else {
                self.tasks.clear();
                return;
            };
            if let (Some(failure), Ok(())) = (self.remove(joined).while_stopping(), &*outcome) {
                *outcome = Err(failure);
            }
        }
    }

    fn remove(&mut self, joined: Joined) -> EndedTask {
        let (id, outcome) = match joined {
            Ok((id, outcome)) => (id, Ok(outcome)),
            Err(error) => (error.id(), Err(error)),
        };
        let index = self.tasks.iter().position(|task| task.id == id);
        let name = index.map_or("abandoned", |index| self.tasks.remove(index).name);
        EndedTask { name, outcome }
    }
}

/// A task that has ended, with its output or its panic.
struct EndedTask {
    name: &'static str,
    outcome: Result<Result<(), Failure>, JoinError>,
}

impl EndedTask {
    /// The failure of a task that should still be running.
    fn before_shutdown(self) -> Failure {
        let name = self.name;
        self.while_stopping().unwrap_or_else(|| {
            let sentence = format!("the task {name:?} has ended before shutdown");
            Failure::new(exit_code::FAILURE, sentence)
        })
    }

    /// The failure of a task that may end; `None` when it has ended in good order or
    /// its future was dropped.
    fn while_stopping(self) -> Option<Failure> {
        let name = self.name;
        match self.outcome {
            Ok(Ok(())) => None,
            Ok(Err(failure)) => Some(Failure::new(
                failure.code.max(exit_code::FAILURE),
                format!("the task {name:?} has failed: {failure}"),
            )),
            Err(error) => {
                let panic = error.try_into_panic().ok()?;
                let sentence = format!("the task {name:?} has panicked: {}", message_of(&*panic));
                Some(Failure::new(exit_code::FAILURE, sentence))
            }
        }
    }
}

fn message_of(panic: &(dyn Any + Send)) -> &str {
    panic
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| panic.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("a panic without a text")
}

#[cfg(test)]
mod tests;
