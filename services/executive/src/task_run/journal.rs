//! Journal of a task: its steps and its end on their way to the working memory.

use control_protocol::{
    MAX_STEP_REASON_BYTES, MutationId, RecordedStep, RefusalKind, TaskOutcome, request,
};
use daemon_client::{DaemonLink, Unanswered};
use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// Time between two attempts to reach the memory. Chosen.
const RETRY_PERIOD: Duration = Duration::from_millis(500);

/// Greatest length of the report with which a task ends, bytes: the memory refuses a longer one.
const MAX_END_REASON_BYTES: usize = 2048;

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
    pub(super) fn step(&mut self, mut step: RecordedStep) {
        shorten(&mut step.reason, MAX_STEP_REASON_BYTES);
        self.waiting
            .retain(|entry| !matches!(entry, Entry::Step(old) if old.number == step.number));
        self.waiting.push_back(Entry::Step(step));
    }

    /// Records the end of the task.
    pub(super) fn end(&mut self, outcome: TaskOutcome, mut reason: String) {
        shorten(&mut reason, MAX_END_REASON_BYTES);
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

/// Cuts a text to so many bytes at most.
fn shorten(text: &mut String, n_bytes_max: usize) {
    let mut ends = (0..=n_bytes_max.min(text.len())).rev();
    let end = ends.find(|end| text.is_char_boundary(*end));
    text.truncate(end.unwrap_or_default());
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

    #[test]
    fn texts_are_as_long_as_the_memory_takes_them() {
        let mut journal = Journal::default();
        let mut long = step(1, "failed");
        long.reason = "é".repeat(300);
        journal.step(long);
        journal.end(TaskOutcome::Failed, "x".repeat(3000));
        let lengths = journal.waiting.iter().map(|entry| match entry {
            Entry::Step(step) => step.reason.len(),
            Entry::End { reason, .. } => reason.len(),
        });
        assert_eq!(lengths.collect::<Vec<_>>(), [512, 2048]);
    }
}
