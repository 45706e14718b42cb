//! Task group: the named long-running tasks of one process (structured concurrency).
//!
//! Each task should run until shutdown. When one ends before, by returning or by a
//! panic, the group stops the others and returns a [`Failure`] that names the task:
//! the process ends with a non-zero exit code, and the service manager starts it again.

use crate::Failure;
use std::any::Any;
use std::collections::HashMap;
use std::future::Future;
use std::time::Duration;
use tokio::task::{Id, JoinError, JoinSet};
use tokio::time::timeout;

/// Time limit for all tasks together to stop.
const STOP_TIMEOUT: Duration = Duration::from_secs(1);

/// Named tasks that run until shutdown. Dropping the group aborts them.
#[derive(Debug, Default)]
pub struct TaskGroup {
    running: JoinSet<()>,
    names: HashMap<Id, &'static str>,
}

impl TaskGroup {
    /// Spawns a task that is stopped by dropping its future; within a tokio runtime. The
    /// name begins the sentence of its failure: "the control server".
    pub fn spawn(&mut self, name: &'static str, task: impl Future<Output = ()> + Send + 'static) {
        let id = self.running.spawn(task).id();
        self.names.insert(id, name);
    }

    /// Runs until the main future is ready or a task ends, then stops all tasks. The
    /// main future runs on the calling task. It comes first: what ends it may end other
    /// tasks in the same instant.
    ///
    /// # Errors
    /// The failure of the main future, or the [`Failure`] of the first task that ended
    /// before it.
    pub async fn run(
        mut self,
        main: impl Future<Output = Result<(), Failure>>,
    ) -> Result<(), Failure> {
        let outcome = tokio::select! {
            biased;
            outcome = main => outcome,
            Some(ended) = self.running.join_next_with_id() => Err(self.failure_of(ended)),
        };
        if timeout(STOP_TIMEOUT, self.running.shutdown())
            .await
            .is_err()
        {
            tracing::warn!("a task did not stop in time and is abandoned");
        }
        outcome
    }

    fn failure_of(&self, ended: Result<(Id, ()), JoinError>) -> Failure {
        let (id, manner) = match ended {
            Ok((id, ())) => (id, "has ended unexpectedly".to_owned()),
            Err(error) => (error.id(), manner_of(error)),
        };
        let name = self.names.get(&id).copied().unwrap_or("a task");
        Failure::general(format!("{name} {manner}"))
    }
}

fn manner_of(error: JoinError) -> String {
    match error.try_into_panic() {
        Ok(panic) => format!("has panicked: {}", message_of(&*panic)),
        Err(_) => "was aborted".to_owned(),
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
mod tests {
    use super::*;
    use crate::exit_code;
    use std::future::{pending, ready};
    use std::sync::Arc;

    /// Watchdog of a test, far beyond any healthy run.
    const WATCHDOG: Duration = Duration::from_secs(20);

    /// Future that panics with an owned message or with a literal.
    async fn panicking(is_formatted: bool) {
        let n = ready(7).await;
        assert!(!is_formatted, "frame {n}");
        panic!("frame 7");
    }

    async fn outcome_of(
        tasks: TaskGroup,
        main: impl Future<Output = Result<(), Failure>>,
    ) -> Result<(), Failure> {
        let outcome = timeout(WATCHDOG, tasks.run(main)).await;
        outcome.expect("the group hangs")
    }

    #[tokio::test]
    async fn task_that_ends_is_a_failure_that_names_it() {
        let mut tasks = TaskGroup::default();
        tasks.spawn("the server", pending());
        tasks.spawn("the publisher", ready(()));
        let failure = outcome_of(tasks, pending()).await.unwrap_err();
        assert_eq!(failure.code, exit_code::FAILURE);
        assert_eq!(failure.sentence, "the publisher has ended unexpectedly");
    }

    #[tokio::test]
    async fn task_that_panics_is_a_failure_with_its_message() {
        for is_formatted in [false, true] {
            let mut tasks = TaskGroup::default();
            tasks.spawn("the server", panicking(is_formatted));
            let failure = outcome_of(tasks, pending()).await.unwrap_err();
            assert_eq!(failure.code, exit_code::FAILURE);
            assert_eq!(failure.sentence, "the server has panicked: frame 7");
        }
    }

    #[tokio::test]
    async fn end_of_the_main_future_is_the_outcome_and_comes_first() {
        let refused = Failure::new(exit_code::REFUSED, "too many restarts");
        for expected in [Ok(()), Err(refused)] {
            let mut tasks = TaskGroup::default();
            tasks.spawn("the server", ready(()));
            tokio::task::yield_now().await;
            assert_eq!(outcome_of(tasks, ready(expected.clone())).await, expected);
        }
    }

    #[tokio::test]
    async fn other_tasks_are_dropped_before_the_group_returns() {
        for main_ends in [true, false] {
            let held = Arc::new(());
            let mut tasks = TaskGroup::default();
            let of_task = held.clone();
            tasks.spawn("the server", async move {
                pending::<()>().await;
                drop(of_task);
            });
            if main_ends {
                outcome_of(tasks, ready(Ok(()))).await.unwrap();
            } else {
                tasks.spawn("the publisher", ready(()));
                outcome_of(tasks, pending()).await.unwrap_err();
            }
            assert_eq!(Arc::strong_count(&held), 1);
        }
    }
}
