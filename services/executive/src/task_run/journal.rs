//! Journal of a task: its steps and its end on their way to the working memory.

use crate::robot::{DaemonLink, Unanswered};
use control_protocol::{MutationId, RecordedStep, RefusalKind, TaskOutcome, request};
use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// Time between two attempts to reach the memory. Chosen.
const RETRY_PERIOD: Duration = Duration::from_millis(500);

/// Change that the memory has not acknowledged.
#[derive(Debug, Clone, PartialEq)]
enum Entry {
    Step(RecordedStep),
    End {
        id: MutationId,
        outcome: TaskOutcome,
        reason: String,
    },
}

/// Changes of a task that the memory has not acknowledged, oldest first.
#[derive(Debug, Default)]
pub(super) struct Journal {
    waiting: VecDeque<Entry>,
    tried: Option<Instant>,
}

impl Journal {
    /// Records a step. A change of the same step that still waits is replaced.
    pub(super) fn step(&mut self, step: RecordedStep) {
        self.waiting
            .retain(|entry| !matches!(entry, Entry::Step(old) if old.number == step.number));
        self.waiting.push_back(Entry::Step(step));
    }

    /// Records the end of the task.
    pub(super) fn end(&mut self, outcome: TaskOutcome, reason: String) {
        // Without random numbers the system is beyond help; a repeated number is refused.
        let id = MutationId::random().unwrap_or(MutationId(1));
        self.waiting.push_back(Entry::End {
            id,
            outcome,
            reason,
        });
    }

    /// True if the memory has acknowledged everything.
    pub(super) fn is_empty(&self) -> bool {
        self.waiting.is_empty()
    }

    /// Sends what waits; after a failure, which is returned, not before a while.
    ///
    /// # Errors
    /// The sentence of the memory, or that it does not answer.
    pub(super) fn flush(&mut self, task_id: u64, link: &mut DaemonLink) -> Result<(), Unanswered> {
        if self.tried.is_some_and(|at| at.elapsed() < RETRY_PERIOD) {
            return Ok(());
        }
        self.tried = None;
        while let Some(entry) = self.waiting.front() {
            let answer = match entry.clone() {
                Entry::Step(step) => link.ask(&request::record_step(task_id, step)),
                Entry::End {
                    id,
                    outcome,
                    reason,
                } => link.ask(&request::end_task(id, task_id, outcome, reason)),
            };
            match answer {
                Ok(_) => {
                    self.waiting.pop_front();
                }
                // The same content is refused again: it is told once and dropped.
                Err(Unanswered::Refused(refusal)) if is_final(refusal.kind) => {
                    self.waiting.pop_front();
                    return Err(Unanswered::Refused(refusal));
                }
                Err(unanswered) => {
                    self.tried = Some(Instant::now());
                    return Err(unanswered);
                }
            }
        }
        Ok(())
    }
}

/// True for a refusal that a repetition does not change.
fn is_final(kind: RefusalKind) -> bool {
    matches!(
        kind,
        RefusalKind::NotFound
            | RefusalKind::Invalid
            | RefusalKind::Conflict
            | RefusalKind::Forbidden
            | RefusalKind::Version
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(number: u64, state: &str) -> RecordedStep {
        RecordedStep {
            number,
            state: state.to_owned(),
            primitive: "reach".to_owned(),
            track_id: 4,
            label: None,
            place: None,
            attempt: 1,
            reason: String::new(),
            plan: String::new(),
        }
    }

    #[test]
    fn newest_change_of_a_step_replaces_the_one_that_waits() {
        let mut journal = Journal::default();
        journal.step(step(1, "running"));
        journal.step(step(1, "held"));
        journal.step(step(2, "running"));
        let expected = [step(1, "held"), step(2, "running")].map(Entry::Step);
        assert!(journal.waiting.iter().eq(&expected));
        assert!(!journal.is_empty());
    }
}
